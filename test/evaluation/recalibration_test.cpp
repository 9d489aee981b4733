#include "evaluation/recalibration.h"

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

/// One pixel in each bin, at its middle; `correct` gives the share of correct pixels.
template <typename Correct>
ConfidenceProfile makeProfile(const Correct& correct) {
  ConfidenceProfile profile;
  for (std::size_t b = 0; b < kConfidenceBins; ++b) {
    const double confidence = (static_cast<double>(b) + 0.5) / kConfidenceBins;
    const double wrong = 1.0 - correct(confidence);
    profile.bins.push_back({1.0, confidence, wrong, wrong, wrong / 2});
    profile.pixels += 1.0;
    profile.squared_error +=
        wrong * confidence * confidence + (1.0 - wrong) * (1.0 - confidence) * (1.0 - confidence);
  }
  return profile;
}

double mapped(double confidence, double scale, double shift) {
  return 1.0 / (1.0 + std::exp(-(scale * std::log(confidence / (1.0 - confidence)) + shift)));
}

TEST(Recalibration, FindsTheMapThatTheErrorsFollow) {
  for (const auto& [scale, shift] :
       {std::pair(1.0, 0.0), std::pair(1.3, 2.5), std::pair(0.4, -1.0)}) {
    const ConfidenceProfile profile =
        makeProfile([scale = scale, shift = shift](double confidence) {
          return mapped(confidence, scale, shift);
        });
    const Recalibration map = fitRecalibration(profile);
    EXPECT_NEAR(map.scale, scale, 1e-6);
    EXPECT_NEAR(map.shift, shift, 1e-6);
    EXPECT_LT(calibrationError(recalibrate(profile, map)), 1e-6);
  }
}

TEST(Recalibration, CalibratesErrorsThatFollowNoSuchMap) {
  const ConfidenceProfile profile =
      makeProfile([](double confidence) { return 0.8 + 0.2 * confidence; });
  const ConfidenceProfile after = recalibrate(profile, fitRecalibration(profile));
  EXPECT_GT(calibrationError(profile), 0.3);
  EXPECT_LT(calibrationError(after), 0.02);
  EXPECT_LT(brierScore(after), brierScore(profile));
  EXPECT_NEAR(operatingPoint(after, 0.0).bad_3, operatingPoint(profile, 0.0).bad_3, 1e-9);
}

TEST(Recalibration, LeavesWhatCannotBeFitted) {
  ConfidenceProfile one_confidence = makeProfile([](double) { return 0.5; });
  for (std::size_t b = 1; b < kConfidenceBins; ++b) {
    one_confidence.bins[b] = {};
  }
  for (const ConfidenceProfile& profile :
       {ConfidenceProfile(), one_confidence, makeProfile([](double) { return 1.0; })}) {
    const Recalibration map = fitRecalibration(profile);
    EXPECT_EQ(map.scale, 1.0);
    EXPECT_EQ(map.shift, 0.0);
  }
}

TEST(Recalibration, SigmaScaleCoversTheShareOfNormalErrorsInTheRangeOfTheParameter) {
  const auto fitted = [](double ratio) {
    SigmaCoverage coverage;
    coverage.addInliers(6900.0, ratio);
    coverage.addInliers(3100.0, ratio + 3.0);
    return fitSigmaScale(coverage).value();
  };
  EXPECT_NEAR(fitted(1.5), 1.5, 1.0 / SigmaCoverage::kBinsPerSigma);
  EXPECT_NEAR(fitted(7.25), 7.25, 1.0 / SigmaCoverage::kBinsPerSigma);
  EXPECT_EQ(fitted(0.0), 0.1);
  EXPECT_EQ(fitted(12.0), 10.0);
  EXPECT_FALSE(fitSigmaScale(SigmaCoverage{}));
}

}  // namespace
}  // namespace cbmv
