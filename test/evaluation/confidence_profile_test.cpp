#include "evaluation/confidence_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr float kInvalid = -1.0F;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A counted pixel.
struct Pixel {
  double confidence;
  double error;   ///< infinite: no disparity
  double weight;  ///< sum over all pixels of its scene: 1
};

/// Maps of one scene. Confidences are whole percents, so that no threshold splits a bin.
struct Scene {
  cv::Mat disparity, confidence, truth, mask;

  Scene(int columns, int seed)
      : disparity(1, columns, CV_32FC1),
        confidence(1, columns, CV_32FC1),
        truth(1, columns, CV_32FC1),
        mask(1, columns, CV_8UC1, cv::Scalar(255)) {
    cv::RNG rng(static_cast<std::uint64_t>(seed));
    rng.fill(truth, cv::RNG::UNIFORM, 0, 6);
    rng.fill(disparity, cv::RNG::UNIFORM, 0, 6);
    for (int x = 0; x < columns; ++x) {
      confidence.at<float>(x) = static_cast<float>(rng.uniform(0, 101)) / 100.0F;
      if (x % 7 == 6) {
        mask.at<uchar>(x) = 128;
        truth.at<float>(x - 1) = kNan;
        disparity.at<float>(x - 2) = x % 2 == 0 ? kInvalid : kNan;
        confidence.at<float>(x - 3) = kNan;
      }
    }
  }

  ConfidenceProfile profile(float correct_px) const {
    return profileConfidence(disparity, confidence, truth, mask, kInvalid, correct_px);
  }

  void addPixels(double weight, std::vector<Pixel>& pixels) const {
    std::vector<Pixel> own;
    for (int x = 0; x < truth.cols; ++x) {
      const float d = disparity.at<float>(x);
      const float c = confidence.at<float>(x);
      if (mask.at<uchar>(x) == 255 && std::isfinite(truth.at<float>(x))) {
        const bool none = d == kInvalid || std::isnan(d);
        own.push_back({none || std::isnan(c) ? 0.0 : c,
                       none ? INFINITY : std::abs(d - truth.at<float>(x)), 0.0});
      }
    }
    for (Pixel& pixel : own) {
      pixel.weight = weight / static_cast<double>(own.size());
      pixels.push_back(pixel);
    }
  }
};

double sumOf(const std::vector<Pixel>& pixels) {
  double sum = 0.0;
  for (const Pixel& pixel : pixels) {
    sum += pixel.weight;
  }
  return sum;
}

/// Rounds, because the float of a whole percent may be below it.
int percentOf(const Pixel& pixel) { return static_cast<int>(std::lround(100 * pixel.confidence)); }

double naiveCalibrationError(const std::vector<Pixel>& pixels, double correct_px) {
  double error = 0.0;
  for (int bin = 0; bin < 10; ++bin) {
    double weight = 0.0;
    double confidence = 0.0;
    double correct = 0.0;
    for (const Pixel& pixel : pixels) {
      if (std::min(percentOf(pixel) / 10, 9) == bin) {
        weight += pixel.weight;
        confidence += pixel.weight * pixel.confidence;
        correct += pixel.error <= correct_px ? pixel.weight : 0.0;
      }
    }
    if (weight > 0.0) {
      error += weight / sumOf(pixels) * std::abs(confidence / weight - correct / weight);
    }
  }
  return error;
}

double naiveBrier(const std::vector<Pixel>& pixels, double correct_px) {
  double sum = 0.0;
  for (const Pixel& pixel : pixels) {
    const double correct = pixel.error <= correct_px ? 1.0 : 0.0;
    sum += pixel.weight * (pixel.confidence - correct) * (pixel.confidence - correct);
  }
  return sum / sumOf(pixels);
}

OperatingPoint naivePoint(const std::vector<Pixel>& pixels, int percent) {
  double kept = 0.0;
  double bad_1 = 0.0;
  double bad_3 = 0.0;
  for (const Pixel& pixel : pixels) {
    if (std::isfinite(pixel.error) && percentOf(pixel) >= percent) {
      kept += pixel.weight;
      bad_1 += pixel.error > 1.0 ? pixel.weight : 0.0;
      bad_3 += pixel.error > 3.0 ? pixel.weight : 0.0;
    }
  }
  return {percent / 100.0, 100.0 * kept / sumOf(pixels), 100.0 * bad_1 / kept,
          100.0 * bad_3 / kept};
}

/// Fraction of pixels above 1 px among the most confident. Equal confidences share it; pixels
/// without disparity come last.
double naiveBadAtDensity(const std::vector<Pixel>& pixels, double percent) {
  const double kept = percent / 100.0 * sumOf(pixels);
  const auto rank = [](const Pixel& pixel) {
    return std::isfinite(pixel.error) ? percentOf(pixel) : -1;
  };
  double bad = 0.0;
  for (const Pixel& pixel : pixels) {
    double better = 0.0;
    double equal = 0.0;
    for (const Pixel& other : pixels) {
      better += rank(other) > rank(pixel) ? other.weight : 0.0;
      equal += rank(other) == rank(pixel) ? other.weight : 0.0;
    }
    bad += pixel.error > 1.0 ? pixel.weight * std::clamp((kept - better) / equal, 0.0, 1.0) : 0.0;
  }
  return 100.0 * bad / kept;
}

void expectNaive(const ConfidenceProfile& profile, const std::vector<Pixel>& pixels,
                 double correct_px) {
  EXPECT_NEAR(calibrationError(profile), naiveCalibrationError(pixels, correct_px), 1e-6);
  EXPECT_NEAR(brierScore(profile), naiveBrier(pixels, correct_px), 1e-6);
  for (const int percent : {0, 7, 30, 50, 70, 90, 99}) {
    const OperatingPoint point = operatingPoint(profile, percent / 100.0);
    const OperatingPoint expected = naivePoint(pixels, percent);
    EXPECT_EQ(point.min_confidence, percent / 100.0);
    EXPECT_NEAR(point.density, expected.density, 1e-9) << percent;
    if (point.density > 0.0) {
      EXPECT_NEAR(point.bad_1, expected.bad_1, 1e-9) << percent;
      EXPECT_NEAR(point.bad_3, expected.bad_3, 1e-9) << percent;
    }
  }
  for (const double percent : {0.5, 20.0, 50.0, 83.0, 91.6, 100.0}) {
    const OperatingPoint point = atDensity(profile, percent);
    EXPECT_NEAR(point.density, percent, 1e-9);
    EXPECT_NEAR(point.bad_1, naiveBadAtDensity(pixels, percent), 1e-6) << percent;
  }
}

TEST(ConfidenceProfile, AgreesWithTheDefinitions) {
  for (const int columns : {14, 231, 2000}) {
    for (const float correct_px : {1.0F, 3.0F}) {
      const Scene scene(columns, columns);
      std::vector<Pixel> pixels;
      scene.addPixels(1.0, pixels);
      expectNaive(scene.profile(correct_px), pixels, correct_px);
    }
  }
}

/// Two scenes of different sizes; the larger one has the smaller weight.
TEST(ConfidenceProfile, ScenesAreAddedByTheirWeights) {
  const Scene small(70, 1);
  const Scene large(700, 2);
  ConfidenceProfile sum;
  addProfile(small.profile(1.0F), 1.0, sum);
  addProfile(large.profile(1.0F), 0.5, sum);
  std::vector<Pixel> pixels;
  small.addPixels(1.0, pixels);
  large.addPixels(0.5, pixels);
  expectNaive(sum, pixels, 1.0);
  EXPECT_NEAR(sum.pixels, 1.5, 1e-12);
}

TEST(ConfidenceProfile, ReliabilityMatchesAHandComputedCase) {
  // 0.35 and 0.3 are in the same bin and one of them is correct; 1 is in the last bin; one pixel
  // has no disparity.
  const cv::Mat truth = cv::Mat::zeros(1, 4, CV_32FC1);
  const cv::Mat disparity = (cv::Mat_<float>(1, 4) << 0.5F, 2, 1, kInvalid);
  const cv::Mat confidence = (cv::Mat_<float>(1, 4) << 0.35F, 0.3F, 1, 0.9F);
  const cv::Mat mask(1, 4, CV_8UC1, cv::Scalar(255));
  const ConfidenceProfile profile =
      profileConfidence(disparity, confidence, truth, mask, kInvalid, 1.0F);
  const auto diagram = reliability(profile);
  EXPECT_NEAR(diagram[3].pixels, 50.0, 1e-12);
  EXPECT_NEAR(diagram[3].confidence, 0.325, 1e-6);
  EXPECT_NEAR(diagram[3].correct, 0.5, 1e-12);
  EXPECT_NEAR(diagram[9].pixels, 25.0, 1e-12);
  EXPECT_NEAR(diagram[9].correct, 1.0, 1e-12);
  EXPECT_EQ(diagram[0].pixels, 0.0);
  EXPECT_TRUE(std::isnan(diagram[0].confidence) && std::isnan(diagram[0].correct));
  EXPECT_NEAR(calibrationError(profile), 0.5 * 0.175, 1e-6);
  EXPECT_NEAR(operatingPoint(profile, 0.0).density, 75.0, 1e-12);
}

/// Confidences whose float is below the decimal threshold are kept, as in the node, which compares
/// floats.
TEST(ConfidenceProfile, KeepsWhatEqualsTheThreshold) {
  const cv::Mat zeros = cv::Mat::zeros(1, 1, CV_32FC1);
  const cv::Mat mask(1, 1, CV_8UC1, cv::Scalar(255));
  for (int percent = 0; percent < 100; ++percent) {
    const cv::Mat confidence(1, 1, CV_32FC1, cv::Scalar(static_cast<float>(percent) / 100.0F));
    const ConfidenceProfile profile =
        profileConfidence(zeros, confidence, zeros, mask, kInvalid, 1.0F);
    EXPECT_EQ(operatingPoint(profile, percent / 100.0).density, 100.0) << percent;
    EXPECT_EQ(operatingPoint(profile, (percent + 1) / 100.0).density, 0.0) << percent;
  }
}

TEST(ConfidenceProfile, IsNotKnownOfWhatIsNoProbability) {
  const cv::Mat zeros = cv::Mat::zeros(1, 2, CV_32FC1);
  const cv::Mat mask(1, 2, CV_8UC1, cv::Scalar(255));
  for (const float outside : {-0.1F, 1.1F}) {
    const cv::Mat confidence = (cv::Mat_<float>(1, 2) << 0.5F, outside);
    const ConfidenceProfile profile =
        profileConfidence(zeros, confidence, zeros, mask, kInvalid, 1.0F);
    EXPECT_TRUE(profile.bins.empty());
    EXPECT_TRUE(std::isnan(calibrationError(profile)) && std::isnan(brierScore(profile)));
    EXPECT_TRUE(std::isnan(operatingPoint(profile, 0.3).bad_1));
    EXPECT_TRUE(std::isnan(atDensity(profile, 50.0).bad_3));
    for (const bool first : {false, true}) {  // a sum with it is unknown
      const ConfidenceProfile other = profileConfidence(zeros, zeros, zeros, mask, kInvalid, 1.0F);
      ConfidenceProfile sum;
      addProfile(first ? profile : other, 1.0, sum);
      addProfile(first ? other : profile, 1.0, sum);
      EXPECT_TRUE(sum.bins.empty());
    }
  }
}

TEST(ConfidenceProfile, RejectsOtherSizesAndTypes) {
  const cv::Mat map = cv::Mat::zeros(3, 3, CV_32FC1);
  const cv::Mat mask = cv::Mat::zeros(3, 3, CV_8UC1);
  EXPECT_THROW(profileConfidence(map, map.rowRange(0, 2), map, mask, kInvalid, 1.0F), Error);
  EXPECT_THROW(profileConfidence(map, mask, map, mask, kInvalid, 1.0F), Error);
  EXPECT_THROW(profileConfidence(map, map, map.colRange(0, 2), mask, kInvalid, 1.0F), Error);
}

}  // namespace
}  // namespace cbmv
