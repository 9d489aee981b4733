#include "evaluation/disparity_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr float kInvalid = -1.0F;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// The smallest error that is not exceeded by `percent` of the pixels, found by counting.
double naiveQuantile(const std::vector<double>& errors, int percent) {
  double best = std::numeric_limits<double>::infinity();
  for (const double candidate : errors) {
    const auto within = std::count_if(errors.begin(), errors.end(),
                                      [&](double error) { return error <= candidate; });
    if (100 * within >= percent * static_cast<long>(errors.size())) {
      best = std::min(best, candidate);
    }
  }
  return best;
}

/// Direct implementation of the definitions, in double precision.
DisparityError reference(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask) {
  DisparityError e;
  std::vector<double> errors;
  for (int i = 0; i < static_cast<int>(truth.total()); ++i) {
    const int y = i / truth.cols;
    const int x = i % truth.cols;
    const double t = truth.at<float>(y, x);
    const double d = disparity.at<float>(y, x);
    if (mask.at<uchar>(y, x) != 255 || !std::isfinite(t)) {
      continue;
    }
    const bool has = std::isfinite(d) && d != kInvalid;
    const double error = has ? std::abs(d - t) : 1e9;
    e.pixels += 1;
    e.bad_05 += error > 0.5 ? 100 : 0;
    e.bad_1 += error > 1 ? 100 : 0;
    e.bad_2 += error > 2 ? 100 : 0;
    e.bad_3 += error > 3 ? 100 : 0;
    e.bad_4 += error > 4 ? 100 : 0;
    e.d1 += error > 3 && error > 0.05 * std::abs(t) ? 100 : 0;
    e.density += has ? 100 : 0;
    for (std::size_t k = 0; k < kErrorBins; ++k) {
      const double end = 0.25 * static_cast<double>(k + 1);
      e.histogram[k] += error <= end && (error > end - 0.25 || k == 0) ? 100 : 0;
    }
    e.histogram[kErrorBins] += error > 4 ? 100 : 0;
    e.average_px += has ? error : 0;
    e.rms_px += has ? error * error : 0;
    if (has) {
      errors.push_back(error);
    }
  }
  for (double* value : {&e.bad_05, &e.bad_1, &e.bad_2, &e.bad_3, &e.bad_4, &e.d1, &e.density}) {
    *value /= static_cast<double>(e.pixels);
  }
  for (double& value : e.histogram) {
    value /= static_cast<double>(e.pixels);
  }
  e.average_px /= static_cast<double>(errors.size());
  e.rms_px = std::sqrt(e.rms_px / static_cast<double>(errors.size()));
  e.a50_px = naiveQuantile(errors, 50);
  e.a90_px = naiveQuantile(errors, 90);
  e.a99_px = naiveQuantile(errors, 99);
  return e;
}

void expectEqual(const DisparityError& a, const DisparityError& b) {
  EXPECT_EQ(a.pixels, b.pixels);
  EXPECT_NEAR(a.bad_05, b.bad_05, 1e-9);
  EXPECT_NEAR(a.bad_1, b.bad_1, 1e-9);
  EXPECT_NEAR(a.bad_2, b.bad_2, 1e-9);
  EXPECT_NEAR(a.bad_3, b.bad_3, 1e-9);
  EXPECT_NEAR(a.bad_4, b.bad_4, 1e-9);
  EXPECT_NEAR(a.d1, b.d1, 1e-9);
  EXPECT_NEAR(a.density, b.density, 1e-9);
  for (std::size_t k = 0; k <= kErrorBins; ++k) {
    EXPECT_NEAR(a.histogram[k], b.histogram[k], 1e-9) << k;
  }
  EXPECT_NEAR(a.average_px, b.average_px, 1e-5);  // differences are computed in single precision
  EXPECT_NEAR(a.rms_px, b.rms_px, 1e-5);
  EXPECT_NEAR(a.a50_px, b.a50_px, 1e-5);
  EXPECT_NEAR(a.a90_px, b.a90_px, 1e-5);
  EXPECT_NEAR(a.a99_px, b.a99_px, 1e-5);
}

TEST(EvaluateDisparity, AgreesWithTheDefinitions) {
  cv::RNG rng(3);
  for (const cv::Size size : {cv::Size(53, 31), cv::Size(1, 47), cv::Size(47, 1)}) {
    cv::Mat disparity(size, CV_32FC1);
    cv::Mat truth(size, CV_32FC1);
    cv::Mat mask(size, CV_8UC1);
    rng.fill(disparity, cv::RNG::UNIFORM, -20, 100);
    rng.fill(truth, cv::RNG::UNIFORM, -6, 6);  // errors of up to 6 px,
    truth += disparity;                        // some of them below 5 % of the truth
    for (int i = 0; i < static_cast<int>(truth.total()); ++i) {
      mask.at<uchar>(i / size.width, i % size.width) = i % 4 == 0 ? 128 : 255;
      truth.at<float>(i / size.width, i % size.width) *= i % 7 == 0 ? kUnknown : 1.0F;
      if (i % 5 == 0) {
        disparity.at<float>(i / size.width, i % size.width) = i % 2 == 0 ? kInvalid : kUnknown;
      }
    }
    expectEqual(evaluateDisparity(disparity, truth, mask, kInvalid),
                reference(disparity, truth, mask));
  }
}

TEST(EvaluateDisparity, AnErrorOfTheThresholdIsNotBad) {
  const cv::Mat truth = cv::Mat::zeros(1, 4, CV_32FC1);
  const cv::Mat disparity = (cv::Mat_<float>(1, 4) << 0.5F, 1.0F, 2.0F, 4.0F);
  const cv::Mat mask(1, 4, CV_8UC1, cv::Scalar(255));
  const DisparityError error = evaluateDisparity(disparity, truth, mask, kInvalid);
  EXPECT_EQ(error.bad_05, 75.0);
  EXPECT_EQ(error.bad_1, 50.0);
  EXPECT_EQ(error.bad_2, 25.0);
  EXPECT_EQ(error.bad_4, 0.0);
  for (const std::size_t bin : {1, 3, 7, 15}) {
    EXPECT_EQ(error.histogram[bin], 25.0) << bin;
  }
}

TEST(EvaluateDisparity, D1NeedsThreePixelsAndFivePercent) {
  const cv::Mat truth = (cv::Mat_<float>(1, 6) << 10, 10, 100, 100, -100, 100);
  const cv::Mat disparity = (cv::Mat_<float>(1, 6) << 13, 13.5F, 104, 106, -106, kInvalid);
  const cv::Mat mask(1, 6, CV_8UC1, cv::Scalar(255));
  EXPECT_NEAR(evaluateDisparity(disparity, truth, mask, kInvalid).d1, 400.0 / 6.0, 1e-12);
}

TEST(EvaluateDisparity, QuantilesAreErrorsThatOccur) {
  for (const int count : {1, 10, 100, 101}) {
    cv::Mat disparity(1, count, CV_32FC1);
    for (int x = 0; x < count; ++x) {
      disparity.at<float>(0, x) = static_cast<float>(count - x);  // errors 1 … count
    }
    const cv::Mat mask(1, count, CV_8UC1, cv::Scalar(255));
    const DisparityError error =
        evaluateDisparity(disparity, cv::Mat::zeros(1, count, CV_32FC1), mask, kInvalid);
    EXPECT_EQ(error.a50_px, (count + 1) / 2);
    EXPECT_EQ(error.a90_px, (9 * count + 9) / 10);
    EXPECT_EQ(error.a99_px, (99 * count + 99) / 100);
  }
}

TEST(EvaluateDisparity, NothingCountedIsAllZero) {
  const cv::Mat map = cv::Mat::zeros(3, 3, CV_32FC1);
  const DisparityError error = evaluateDisparity(map, map, cv::Mat::zeros(3, 3, CV_8UC1), kInvalid);
  EXPECT_EQ(error.pixels, 0);
  EXPECT_EQ(error.bad_1, 0.0);
  EXPECT_EQ(error.density, 0.0);
  EXPECT_EQ(error.rms_px, 0.0);
  EXPECT_EQ(error.a99_px, 0.0);
}

TEST(EvaluateDisparity, RejectsOtherSizesAndTypes) {
  const cv::Mat map = cv::Mat::zeros(3, 3, CV_32FC1);
  const cv::Mat mask = cv::Mat::zeros(3, 3, CV_8UC1);
  EXPECT_THROW(evaluateDisparity(map, map.rowRange(0, 2), mask, kInvalid), Error);
  EXPECT_THROW(evaluateDisparity(map, map, mask.colRange(0, 2), kInvalid), Error);
  EXPECT_THROW(evaluateDisparity(map, mask, mask, kInvalid), Error);
  EXPECT_THROW(evaluateDisparity(map, map, map, kInvalid), Error);
  EXPECT_THROW(evaluateDisparity(mask, map, mask, kInvalid), Error);
}

}  // namespace
}  // namespace cbmv
