#include "cbmv_stereo/training/sampling.h"

#include <limits>

#include <tbb/global_control.h>

#include "support/random_images.h"

#include "cbmv_stereo/confidence/row_features.h"

namespace cbmv::test {
namespace {

constexpr int kTruth = 9;
const DisparityRange kRange{2, 20};

/// The left image is the right one shifted by kTruth, so the correct hypothesis has the best NCC.
TrainingPair shiftedPair() {
  TrainingPair pair;
  pair.right = makeGrey({90, 40}, Content::kNoise, 1);
  pair.left = makeGrey({90, 40}, Content::kNoise, 2);
  pair.right.colRange(0, 90 - kTruth).copyTo(pair.left.colRange(kTruth, 90));
  pair.truth = cv::Mat(40, 90, CV_32FC1, cv::Scalar(kTruth + 0.2));
  pair.truth.colRange(0, 30).setTo(std::numeric_limits<float>::infinity());
  pair.mask = cv::Mat(40, 90, CV_8UC1, cv::Scalar(255));
  pair.mask.rowRange(0, 10).setTo(128);
  pair.mask.col(89).setTo(128);  // its window differs beyond the border
  pair.range = kRange;
  return pair;
}

TEST(Sampling, DrawsOneCorrectAndTwoWrong) {
  Samples samples;
  appendSamples(shiftedPair(), 100, 7, samples);
  ASSERT_EQ(samples.count(), 300);
  const std::vector<float>& ncc = samples.features[featureIndex(kNcc, kRatioLow)];
  int correct = 0;
  for (long n = 0; n < samples.count(); ++n) {
    correct += samples.labels[n];
    EXPECT_EQ(samples.labels[n] == 1, ncc[n] == 0.0F) << n;
  }
  EXPECT_EQ(correct, 100);
}

TEST(Sampling, NeverDrawsMaskedOrUnknownPixels) {
  TrainingPair pair = shiftedPair();
  Samples all;
  appendSamples(pair, 1000000, 7, all);
  EXPECT_EQ(all.count(), 3L * 30 * 59);
  pair.mask.setTo(128);
  Samples none;
  appendSamples(pair, 100, 7, none);
  EXPECT_EQ(none.count(), 0);
}

TEST(Sampling, SkipsWrongDisparitiesThatDoNotExist) {
  TrainingPair pair = shiftedPair();
  pair.range = {kTruth, 2};  // nothing below truth − 1, nothing above truth + 1
  Samples samples;
  appendSamples(pair, 100, 7, samples);
  EXPECT_EQ(samples.count(), 100);
}

TEST(Sampling, DependsOnTheSeedOnly) {
  const auto draw = [](std::uint64_t seed, int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    Samples samples;
    appendSamples(shiftedPair(), 100, seed, samples);
    return samples;
  };
  EXPECT_EQ(draw(3, 1).features, draw(3, 4).features);
  EXPECT_NE(draw(3, 1).features, draw(4, 1).features);
}

}  // namespace
}  // namespace cbmv::test
