#include "training/sampling.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <tbb/global_control.h>

#include "confidence/row_features.h"
#include "support/random_images.h"
#include "volume/coarse_volume.h"

namespace cbmv::test {
namespace {

constexpr int kTruth = 9;
const DisparityRange kRange{2, 20};

/// The left image is the right one shifted by kTruth, so the correct hypothesis has the best NCC.
TrainingPair shiftedPair() {
  TrainingPair pair;
  pair.right = makeGray({90, 40}, Content::kNoise, 1);
  pair.left = makeGray({90, 40}, Content::kNoise, 2);
  pair.right.colRange(0, 90 - kTruth).copyTo(pair.left.colRange(kTruth, 90));
  pair.truth = cv::Mat(40, 90, CV_32FC1, cv::Scalar(kTruth + 0.2));
  pair.truth.colRange(0, 30).setTo(std::numeric_limits<float>::infinity());
  pair.mask = cv::Mat(40, 90, CV_8UC1, cv::Scalar(255));
  pair.mask.rowRange(0, 10).setTo(128);
  pair.mask.col(89).setTo(128);  // the window differs outside the border
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
  const HeldOutBand band(40, 7);
  long rows = 0;
  for (int y = 10; y < 40; ++y) {
    rows += band.isMargin(y) ? 0 : 1;
  }
  EXPECT_EQ(all.count(), 3 * rows * 59);
  pair.mask.setTo(128);
  Samples none;
  appendSamples(pair, 100, 7, none);
  EXPECT_EQ(none.count(), 0);
}

TEST(Sampling, SkipsWrongDisparitiesThatDoNotExist) {
  TrainingPair pair = shiftedPair();
  pair.range = {kTruth, 2};  // nothing below truth − 1 or above truth + 1
  Samples samples;
  appendSamples(pair, 100, 7, samples);
  EXPECT_EQ(samples.count(), 100);
}

/// Two disparities in every list: the correct one and one above it, or only one of them.
SearchSpace listsOf(const TrainingPair& pair, const std::vector<int>& disparities) {
  SearchSpace space;
  space.build(pair.left.rows, pair.left.cols, pair.range, [&](int, SearchSpace::Row& row) {
    for (int t = 0; t < (pair.left.cols + kTileColumns - 1) / kTileColumns; ++t) {
      for (const int d : disparities) {
        row.push(d - pair.range.min);
      }
      row.endTile();
    }
  });
  return space;
}

TEST(SamplingOverWindows, DrawsWhatIsInTheLists) {
  const TrainingPair pair = shiftedPair();
  const auto draw = [&](const std::vector<int>& disparities) {
    Samples samples;
    appendSamples(pair, listsOf(pair, disparities), HeldOutBand(40, 7), 100, 7, samples);
    return samples;
  };
  const Samples both = draw({kTruth, kTruth + 5});
  EXPECT_EQ(both.count(), 200);
  EXPECT_EQ(std::count(both.labels.begin(), both.labels.end(), 1), 100);
  const Samples wrong = draw({kTruth + 5});
  EXPECT_EQ(wrong.count(), 100);
  EXPECT_EQ(std::count(wrong.labels.begin(), wrong.labels.end(), 1), 0);
  EXPECT_EQ(draw({kTruth + 1}).count(), 0) << "neither correct nor wrong";
}

/// The features equal those of the whole range if the lists contain it, otherwise they differ.
TEST(SamplingOverWindows, CompetitorsAreThoseOfTheLists) {
  const TrainingPair pair = shiftedPair();
  Samples expected;
  appendSamples(pair, 100, 7, expected);
  SearchSpace whole;
  whole.buildExhaustive(pair.left.rows, pair.left.cols, pair.range);
  Samples found;
  appendSamples(pair, whole, HeldOutBand(40, 7), 100, 7, found);
  EXPECT_EQ(found.features, expected.features);
  EXPECT_EQ(found.labels, expected.labels);

  Samples alone;
  appendSamples(pair, listsOf(pair, {kTruth}), HeldOutBand(40, 7), 100, 7, alone);
  ASSERT_EQ(alone.count(), 100);
  const std::vector<float>& likelihood = alone.features[featureIndex(kCensus, kLikelihoodLow)];
  EXPECT_EQ(std::count(likelihood.begin(), likelihood.end(), likelihood[0]), 100)
      << "without competitors, every likelihood is the same";
}

TEST(HalvePair, TakesTheTruthWhereFourPixelsAgree) {
  TrainingPair pair = shiftedPair();
  pair.truth.at<float>(12, 41) = kTruth + 3;  // a depth edge
  pair.mask.at<std::uint8_t>(15, 44) = 128;
  const TrainingPair half = halvePair(pair);
  ASSERT_EQ(half.left.size(), cv::Size(45, 20));
  EXPECT_EQ(half.range, halveRange(pair.range));
  EXPECT_FLOAT_EQ(half.truth.at<float>(10, 30), (kTruth + 0.2F) / 2);
  EXPECT_EQ(half.mask.at<std::uint8_t>(10, 30), 255);
  EXPECT_EQ(half.mask.at<std::uint8_t>(6, 20), 0) << "edge";
  EXPECT_EQ(half.mask.at<std::uint8_t>(7, 22), 0) << "masked";
  EXPECT_EQ(half.mask.at<std::uint8_t>(10, 10), 0) << "unknown";
}

TEST(Sampling, HoldsOutTheRowsOfABand) {
  EXPECT_EQ(HeldOutBand(9, 7).end, HeldOutBand(9, 7).begin);
  EXPECT_FALSE(HeldOutBand(9, 7).isMargin(HeldOutBand(9, 7).begin));
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const HeldOutBand band(40, seed);
    EXPECT_EQ(band.end - band.begin, 4);
    EXPECT_GE(band.begin, 0);
    EXPECT_LE(band.end, 40);
    EXPECT_FALSE(band.isMargin(band.begin) || band.isMargin(band.end - 1));
    EXPECT_TRUE(band.isMargin(band.begin - 10) && band.isMargin(band.end + 9));
    EXPECT_FALSE(band.isMargin(band.begin - 11) || band.isMargin(band.end + 10));
    TrainingPair pair = shiftedPair();
    pair.mask.setTo(255);
    Samples samples;
    appendSamples(pair, 1000000, seed, samples);
    EXPECT_EQ(std::count(samples.held_out.begin(), samples.held_out.end(), 1), 4 * 3 * 60);
  }
}

/// The training samples do not depend on the rows of the held-out band.
TEST(Sampling, TrainsOnNothingThatTheHeldOutSamplesSee) {
  TrainingPair pair = shiftedPair();
  const std::uint64_t seed = 3;
  const HeldOutBand band(40, seed);
  const auto trained = [&] {
    Samples all;
    appendSamples(pair, 1000000, seed, all);
    std::vector<float> values;
    for (const std::vector<float>& column : all.features) {
      for (long n = 0; n < all.count(); ++n) {
        if (all.held_out[n] == 0 && all.labels[n] == 1) {
          values.push_back(column[n]);
        }
      }
    }
    return values;
  };
  const std::vector<float> before = trained();
  EXPECT_FALSE(before.empty());
  const int reach = 5;  // half size of the largest window
  const int first = std::max(0, band.begin - reach);
  const int last = std::min(40, band.end + reach);
  makeGray({90, last - first}, Content::kNoise, 9).copyTo(pair.left.rowRange(first, last));
  EXPECT_EQ(trained(), before);
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
