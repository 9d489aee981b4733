#include "evaluation/sigma_coverage.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr float kInvalid = -1.0F;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(SigmaCoverage, AgreesWithTheDefinition) {
  constexpr int kColumns = 500;
  cv::RNG rng(3);
  cv::Mat truth(1, kColumns, CV_32FC1);
  cv::Mat disparity(1, kColumns, CV_32FC1);
  cv::Mat sigma(1, kColumns, CV_32FC1);
  cv::Mat mask(1, kColumns, CV_8UC1, cv::Scalar(255));
  rng.fill(truth, cv::RNG::UNIFORM, 0, 3);
  rng.fill(disparity, cv::RNG::UNIFORM, 0, 3);
  rng.fill(sigma, cv::RNG::UNIFORM, 0.1, 1.5);
  for (int x = 0; x + 8 < kColumns; x += 8) {
    mask.at<uchar>(x) = 128;
    truth.at<float>(x + 1) = kNan;
    disparity.at<float>(x + 2) = x % 16 == 0 ? kInvalid : kNan;
    sigma.at<float>(x + 3) = x % 16 == 0 ? 0.0F : kNan;
    sigma.at<float>(x + 4) = x % 16 == 0 ? kInfinity : -1.0F;
  }
  for (const float inlier_px : {1.0F, 2.0F}) {
    double inliers = 0.0, one = 0.0, two = 0.0, squares = 0.0;
    for (int x = 0; x < kColumns; ++x) {
      const float error = std::abs(disparity.at<float>(x) - truth.at<float>(x));
      const float s = sigma.at<float>(x);
      if (mask.at<uchar>(x) == 255 && disparity.at<float>(x) != kInvalid && error <= inlier_px &&
          s > 0.0F && s < kInfinity) {
        inliers += 1.0;
        one += error <= s ? 1.0 : 0.0;
        two += error <= 2.0F * s ? 1.0 : 0.0;
        squares += std::pow(static_cast<double>(error) / s, 2);
      }
    }
    const SigmaCoverage coverage = coverSigma(disparity, sigma, truth, mask, kInvalid, inlier_px);
    EXPECT_EQ(coverage.inliers, inliers);
    EXPECT_NEAR(coverage.withinOne(), 100.0 * one / inliers, 1e-9);
    EXPECT_NEAR(coverage.withinTwo(), 100.0 * two / inliers, 1e-9);
    EXPECT_NEAR(coverage.rms(), std::sqrt(squares / inliers), 1e-9);
  }
}

TEST(SigmaCoverage, NormalErrorsOfTheRightSigmaAreCovered) {
  const cv::Mat truth = cv::Mat::zeros(200, 200, CV_32FC1);
  const cv::Mat sigma(200, 200, CV_32FC1, cv::Scalar(0.2));
  const cv::Mat mask(200, 200, CV_8UC1, cv::Scalar(255));
  cv::Mat disparity(200, 200, CV_32FC1);
  cv::RNG(7).fill(disparity, cv::RNG::NORMAL, 0, 0.2);
  const SigmaCoverage coverage = coverSigma(disparity, sigma, truth, mask, kInfinity, 1.0F);
  EXPECT_NEAR(coverage.withinOne(), 68.3, 1.0);
  EXPECT_NEAR(coverage.withinTwo(), 95.4, 0.5);
  EXPECT_NEAR(coverage.rms(), 1.0, 0.02);
  EXPECT_NEAR(coverage.ratioQuantile(kOneSigmaShare), 1.0, 0.03);
  EXPECT_NEAR(coverage.ratioQuantile(0.5), 0.674, 0.03);
}

TEST(SigmaCoverage, BinsIncludeTheirUpperEnds) {
  SigmaCoverage coverage;
  for (const double ratio : {0.0, 1.0, 1.0 + 1e-9, 2.0, 2.0 + 1e-9, 1e9}) {
    coverage.addInliers(1.0, ratio);
  }
  EXPECT_NEAR(coverage.withinOne(), 100.0 * 2 / 6, 1e-9);
  EXPECT_NEAR(coverage.withinTwo(), 100.0 * 4 / 6, 1e-9);
  EXPECT_NEAR(coverage.ratioQuantile(1.0), 16.0, 1e-9);  // the end of the last bin
  EXPECT_NEAR(coverage.ratioQuantile(0.0), 0.0, 1e-9);
}

TEST(SigmaCoverage, ScenesAreAddedByTheirWeights) {
  SigmaCoverage half_of_few;
  half_of_few.pixels = 10.0;
  half_of_few.addInliers(5.0, 0.5);
  SigmaCoverage all_of_many;
  all_of_many.pixels = 1000.0;
  all_of_many.addInliers(1000.0, 3.0);
  SigmaCoverage sum;
  addCoverage(half_of_few, 1.0, sum);
  addCoverage(all_of_many, 0.5, sum);
  EXPECT_NEAR(sum.withinOne(), 50.0, 1e-9);
  EXPECT_NEAR(sum.withinTwo(), 50.0, 1e-9);
  EXPECT_NEAR(sum.rms(), std::sqrt((0.25 + 9.0) / 2.0), 1e-9);
  addCoverage({}, 1.0, sum);  // of no known sigma
  EXPECT_NEAR(sum.withinOne(), 50.0, 1e-9);
}

TEST(SigmaCoverage, WithoutInliersNothingIsKnown) {
  const cv::Mat map = cv::Mat::zeros(2, 2, CV_32FC1);
  const cv::Mat mask(2, 2, CV_8UC1, cv::Scalar(255));
  const SigmaCoverage coverage = coverSigma(map, map, map, mask, kInvalid, 1.0F);
  EXPECT_EQ(coverage.pixels, 4.0);
  EXPECT_TRUE(std::isnan(coverage.withinOne()) && std::isnan(coverage.withinTwo()) &&
              std::isnan(coverage.rms()) && std::isnan(coverage.ratioQuantile(0.5)));
}

TEST(SigmaCoverage, RejectsOtherSizesAndTypes) {
  const cv::Mat map = cv::Mat::zeros(3, 3, CV_32FC1);
  const cv::Mat mask = cv::Mat::zeros(3, 3, CV_8UC1);
  EXPECT_THROW(coverSigma(map, map.rowRange(0, 2), map, mask, kInvalid, 1.0F), Error);
  EXPECT_THROW(coverSigma(map, mask, map, mask, kInvalid, 1.0F), Error);
}

}  // namespace
}  // namespace cbmv
