#include "evaluation/sparsification.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/disparity_error.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr float kInvalid = -1.0F;
constexpr float kBadPx = 1.0F;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

bool hasNone(float disparity) { return disparity == kInvalid || !std::isfinite(disparity); }

bool isBad(float disparity, float truth, float bad_px) {
  return hasNone(disparity) || std::abs(disparity - truth) > bad_px;
}

/// Percent of bad pixels among the best `kept` counted pixels. Each pixel counts with the fraction
/// left after all better pixels, shared among pixels of equal confidence.
double naiveBad(const cv::Mat& disparity, const cv::Mat& score, const cv::Mat& truth,
                const cv::Mat& mask, double kept, float bad_px) {
  double bad = 0.0;
  for (int i = 0; i < static_cast<int>(truth.total()); ++i) {
    if (mask.at<uchar>(i) != 255 || !std::isfinite(truth.at<float>(i)) ||
        !isBad(disparity.at<float>(i), truth.at<float>(i), bad_px)) {
      continue;
    }
    double better = 0.0;
    double equal = 0.0;
    for (int j = 0; j < static_cast<int>(truth.total()); ++j) {
      if (mask.at<uchar>(j) == 255 && std::isfinite(truth.at<float>(j))) {
        better += score.at<float>(j) > score.at<float>(i) ? 1.0 : 0.0;
        equal += score.at<float>(j) == score.at<float>(i) ? 1.0 : 0.0;
      }
    }
    bad += std::min(1.0, std::max(0.0, (kept - better) / equal));
  }
  return 100.0 * bad / kept;
}

void expectNaive(const cv::Mat& disparity, const cv::Mat& confidence, const cv::Mat& truth,
                 const cv::Mat& mask, float bad_px) {
  const Sparsification result = sparsify(disparity, confidence, truth, mask, kInvalid, bad_px);
  const auto pixels =
      static_cast<double>(evaluateDisparity(disparity, truth, mask, kInvalid).pixels);
  cv::Mat oracle(truth.size(), CV_32FC1);
  cv::Mat score = confidence.clone();
  for (int i = 0; i < static_cast<int>(truth.total()); ++i) {
    oracle.at<float>(i) = isBad(disparity.at<float>(i), truth.at<float>(i), bad_px) ? 0.0F : 1.0F;
    score.at<float>(i) = std::isnan(confidence.at<float>(i)) || hasNone(disparity.at<float>(i))
                             ? -99.0F
                             : confidence.at<float>(i);
  }
  double auc = 0.0;
  double auc_optimal = 0.0;
  ASSERT_EQ(result.bad.size(), 100U);
  for (int k = 0; k < 100; ++k) {
    const double kept = pixels * (k + 1) / 100.0;
    const double expected = naiveBad(disparity, score, truth, mask, kept, bad_px);
    ASSERT_NEAR(result.bad[static_cast<std::size_t>(k)], expected, 1e-9) << k;
    auc += expected / 100.0;
    const double optimal = naiveBad(disparity, oracle, truth, mask, kept, bad_px);
    ASSERT_NEAR(result.bad_optimal[static_cast<std::size_t>(k)], optimal, 1e-9) << k;
    auc_optimal += optimal / 100.0;
  }
  EXPECT_NEAR(result.auc, auc, 1e-9);
  EXPECT_NEAR(result.auc_optimal, auc_optimal, 1e-9);
  EXPECT_LE(result.auc_optimal, result.auc + 1e-9);
}

TEST(Sparsification, AgreesWithTheDefinition) {
  cv::RNG rng(5);
  for (const int columns : {1, 7, 100, 231}) {
    for (const int levels :
         {1, 3, 1000}) {  // number of confidence levels: from all equal to hardly any equal
      cv::Mat disparity(1, columns, CV_32FC1);
      cv::Mat truth(1, columns, CV_32FC1);
      cv::Mat confidence(1, columns, CV_32FC1);
      cv::Mat mask(1, columns, CV_8UC1, cv::Scalar(255));
      rng.fill(truth, cv::RNG::UNIFORM, 0, 4);
      rng.fill(disparity, cv::RNG::UNIFORM, 0, 4);
      for (int x = 0; x < columns; ++x) {
        confidence.at<float>(x) = static_cast<float>(rng.uniform(0, levels));
        if (x % 5 == 4) {
          mask.at<uchar>(x) = 128;
          disparity.at<float>(x - 1) = x % 2 == 0 ? kInvalid : kNan;
          truth.at<float>(x - 2) = kNan;
          confidence.at<float>(x - 3) = levels > 1 ? kNan : 0.0F;
        }
      }
      expectNaive(disparity, confidence, truth, mask, 1.0F);
      expectNaive(disparity, confidence, truth, mask, 3.0F);
    }
  }
}

TEST(Sparsification, MatchesAHandComputedCase) {
  // Four pixels; the second best is bad. No pixel is bad among the best quarter; then the bad pixel
  // is added gradually: half of the pixels are bad at 50 %, a third at 75 %, a quarter at 100 %.
  const cv::Mat truth = cv::Mat::zeros(2, 2, CV_32FC1);
  const cv::Mat disparity = (cv::Mat_<float>(2, 2) << 0, 5, 1, 0.5F);
  const cv::Mat confidence = (cv::Mat_<float>(2, 2) << 0.9F, 0.8F, 0.7F, 0.6F);
  const cv::Mat mask(2, 2, CV_8UC1, cv::Scalar(255));
  const Sparsification result = sparsify(disparity, confidence, truth, mask, kInvalid, kBadPx);
  EXPECT_NEAR(result.bad[24], 0.0, 1e-12);
  EXPECT_NEAR(result.bad[49], 50.0, 1e-12);
  EXPECT_NEAR(result.bad[74], 100.0 / 3.0, 1e-12);
  EXPECT_NEAR(result.bad[99], 25.0, 1e-12);
  // The optimum for a fraction e = 1/4 of bad pixels has the area e + (1 − e) ln(1 − e), here in
  // 100 steps.
  EXPECT_NEAR(result.auc_optimal, 100.0 * (0.25 + 0.75 * std::log(0.75)), 0.2);
}

TEST(Sparsification, AConfidenceThatKnowsNothingHasTheErrorOfAllPixels) {
  const cv::Mat truth = cv::Mat::zeros(4, 5, CV_32FC1);
  cv::Mat disparity = truth.clone();
  disparity.rowRange(0, 1) = 7.0F;
  const cv::Mat mask(4, 5, CV_8UC1, cv::Scalar(255));
  const Sparsification result =
      sparsify(disparity, cv::Mat::ones(4, 5, CV_32FC1), truth, mask, kInvalid, kBadPx);
  EXPECT_NEAR(result.auc, 25.0, 1e-9);
  EXPECT_NEAR(result.bad.front(), 25.0, 1e-9);
}

TEST(Sparsification, NothingCountedIsAllZero) {
  const cv::Mat map = cv::Mat::zeros(3, 3, CV_32FC1);
  const Sparsification result =
      sparsify(map, map, map, cv::Mat::zeros(3, 3, CV_8UC1), kInvalid, kBadPx);
  EXPECT_EQ(result.auc, 0.0);
  EXPECT_EQ(result.auc_optimal, 0.0);
  EXPECT_EQ(result.bad, std::vector<double>(100, 0.0));
}

TEST(Sparsification, RejectsOtherSizesAndTypes) {
  const cv::Mat map = cv::Mat::zeros(3, 3, CV_32FC1);
  const cv::Mat mask = cv::Mat::zeros(3, 3, CV_8UC1);
  EXPECT_THROW(sparsify(map, map.rowRange(0, 2), map, mask, kInvalid, kBadPx), Error);
  EXPECT_THROW(sparsify(map, mask, map, mask, kInvalid, kBadPx), Error);
  EXPECT_THROW(sparsify(map, map, map, mask.colRange(0, 2), kInvalid, kBadPx), Error);
  EXPECT_THROW(sparsify(map, map, map.colRange(0, 2), mask, kInvalid, kBadPx), Error);
}

}  // namespace
}  // namespace cbmv
