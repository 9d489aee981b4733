#include "refinement/left_right_check.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

bool naiveAgreement(const cv::Mat& right, const DisparityRange& range, double max_difference, int y,
                    int x, double d) {
  const auto column = static_cast<int>(std::lround(x - d));
  if (!isInside(right, y, column) || right.at<float>(y, column) == range.invalid()) {
    return false;
  }
  return std::abs(d - right.at<float>(y, column)) <= max_difference;
}

int naiveLabel(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
               double max_difference, int y, int x) {
  const double d = left.at<float>(y, x);
  if (d != range.invalid() && naiveAgreement(right, range, max_difference, y, x, d)) {
    return kMatch;
  }
  for (int other = range.min; other <= range.max(); ++other) {
    if (other != d && naiveAgreement(right, range, max_difference, y, x, other)) {
      return kMismatch;
    }
  }
  return kOcclusion;
}

/// Quarters of a pixel: exact in float, including half columns.
cv::Mat withFractions(cv::Mat disparity, float invalid) {
  std::mt19937 random(1);
  for (float& d : cv::Mat_<float>(disparity)) {
    d += d == invalid ? 0.0F : 0.25F * static_cast<float>(random() % 4);
  }
  return disparity;
}

class LeftRightCheck : public testing::TestWithParam<Case> {};

TEST_P(LeftRightCheck, EqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  const DisparityRange range = shape.range;
  for (const bool fractions : {false, true}) {
    cv::Mat left = makeDisparity(shape, content, 9, 12);
    cv::Mat right = makeDisparity(shape, content, view == View::kLeft ? 5 : 1, 12);
    if (fractions) {
      left = withFractions(left, range.invalid());
      right = withFractions(right, range.invalid());
    }
    for (const float max_difference : {0.0F, 1.0F, 2.5F}) {
      cv::Mat expected(shape.size(), CV_8UC1);
      for (int y = 0; y < shape.height; ++y) {
        for (int x = 0; x < shape.width; ++x) {
          expected.at<std::uint8_t>(y, x) =
              static_cast<std::uint8_t>(naiveLabel(left, right, range, max_difference, y, x));
        }
      }
      onEverySimdTarget([&, all = shape, limit = max_difference] {
        cv::Mat labels;
        leftRightCheck(left, right, all.range, limit, labels);
        expectMap<std::uint8_t>(labels, all.size(),
                                [&](int y, int x) { return expected.at<std::uint8_t>(y, x); });
      });
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, LeftRightCheck, allCases());

/// Expects the labels found by trying all disparities in float, for a left image without
/// disparities.
void expectTriedLabels(const cv::Mat& right, const DisparityRange& range, float max_difference) {
  const cv::Mat left(right.size(), CV_32FC1, range.invalid());
  onEverySimdTarget([&] {
    cv::Mat labels;
    leftRightCheck(left, right, range, max_difference, labels);
    expectMap<std::uint8_t>(labels, right.size(), [&](int y, int x) {
      for (int d = range.min; d <= range.max(); ++d) {
        if (isInside(right, y, x - d) && right.at<float>(y, x - d) != range.invalid() &&
            std::abs(static_cast<float>(d) - right.at<float>(y, x - d)) <= max_difference) {
          return kMismatch;
        }
      }
      return kOcclusion;
    });
  });
}

TEST(LeftRightCheck, TriesDisparitiesBeyondTheRangeAndBesideTheLimit) {
  const DisparityRange range{-7, 60};
  cv::Mat right(20, 300, CV_32FC1);
  std::mt19937 random(3);
  const auto pick = [&](int lowest, int highest) {
    return static_cast<float>(std::uniform_int_distribution<int>(lowest, highest)(random));
  };
  for (const float max_difference : {0.0F, 1e-7F, 0.3F, 1.0F, 1.1F, 2.7F, 33.3F, 1e9F}) {
    for (float& d : cv::Mat_<float>(right)) {
      d = pick(-70, 110) + std::fmod(max_difference, 1.0F) * pick(-1, 1);
      d = pick(0, 2) == 0 ? std::nextafter(d, pick(-99, 99)) : d;
      d = pick(0, 3) == 0 ? range.invalid() : d;
    }
    expectTriedLabels(right, range, max_difference);
  }
}

/// The difference between a subpixel and an integer disparity is rounded, here to the limit,
/// although the exact value may be above it.
TEST(LeftRightCheck, RoundsLikeTryingAllDisparities) {
  const DisparityRange range{-20, 60};
  cv::Mat right(1, 100, CV_32FC1, range.invalid());
  std::mt19937 random(3);
  for (int repetition = 0; repetition < 100; ++repetition) {
    const float fine = std::uniform_real_distribution<float>(-0.5F, 0.5F)(random);
    right.at<float>(0, 50) = fine;
    for (const float whole : {-16.0F, -1.0F, 1.0F, 32.0F}) {
      expectTriedLabels(right, range, std::abs(whole - fine));
    }
  }
}

/// Marks of matches extend into the blocks of pixels that are labeled together.
TEST(LeftRightCheck, LabelsWideRows) {
  const DisparityRange range{0, 20};
  cv::Mat right(4, 1300, CV_32FC1);
  std::mt19937 random(4);
  for (float& d : cv::Mat_<float>(right)) {
    d = random() % 2 == 0 ? range.invalid() : static_cast<float>(random() % 20);
  }
  expectTriedLabels(right, range, 1.0F);
}

TEST(LeftRightCheck, TellsOcclusionFromMismatch) {
  const DisparityRange range{0, 4};
  const float invalid = range.invalid();
  cv::Mat left = (cv::Mat_<float>(1, 6) << 0, 0, 2, 1, 2, invalid);
  const cv::Mat right = (cv::Mat_<float>(1, 6) << 2, invalid, 2, invalid, invalid, invalid);
  cv::Mat labels;
  leftRightCheck(left, right, range, 0.0F, labels);
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(1, 6) << kOcclusion, kOcclusion, kMatch,
                            kOcclusion, kMatch, kOcclusion);
  EXPECT_EQ(cv::norm(labels, expected, cv::NORM_INF), 0) << labels;
  left.at<float>(0, 4) = 1;
  leftRightCheck(left, right, range, 0.0F, labels);
  EXPECT_EQ(labels.at<std::uint8_t>(0, 4), kMismatch);
}

}  // namespace
}  // namespace cbmv::test
