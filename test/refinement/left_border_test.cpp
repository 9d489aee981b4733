#include "refinement/left_border.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "refinement/disparity_refiner.h"
#include "refinement/left_right_check.h"
#include "support/random_images.h"

namespace cbmv::test {
namespace {

/// End of the strip, from the formula.
double naiveEnd(const cv::Mat& right, float invalid, int y) {
  std::vector<double> ends;
  for (int row = y - 4; row <= y + 4; ++row) {
    std::vector<double> columns;
    for (int x = 0; x < 5; ++x) {
      if (isInside(right, row, x) && right.at<float>(row, x) != invalid) {
        columns.push_back(x + right.at<float>(row, x));
      }
    }
    if (!columns.empty()) {
      ends.push_back(*std::max_element(columns.begin(), columns.end()));
    }
  }
  std::sort(ends.begin(), ends.end());
  return ends.empty() ? -1 : ends[(ends.size() - 1) / 2] - 4;
}

class LeftBorder : public testing::TestWithParam<Case> {};

TEST_P(LeftBorder, EqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  const float invalid = shape.range.invalid();
  for (const int invalid_every : {1, 2, 12}) {
    const cv::Mat left = makeDisparity(shape, content, 9, 12);
    const cv::Mat right = makeDisparity(shape, content, invalid_every, 5);
    cv::Mat labels;
    leftRightCheck(left, right, shape.range, 1, labels);
    cv::Mat expected = labels.clone();
    for (int y = 0; y < shape.height; ++y) {
      for (int x = 0; x < shape.width && x < naiveEnd(right, invalid, y); ++x) {
        auto& label = expected.at<std::uint8_t>(y, x);
        const bool is_far = x - left.at<float>(y, x) > shape.width / 16.0;
        label = label == kMatch && is_far ? kMatch : kOcclusion;
      }
    }
    occludeLeftBorder(left, right, shape.range, labels);
    expectMap<std::uint8_t>(labels, shape.size(),
                            [&](int y, int x) { return expected.at<std::uint8_t>(y, x); });
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, LeftBorder, allCases());

constexpr int kTrue = 20;
const DisparityRange kRange{0, 32};

/// A plane. The first columns cannot have its disparity; in some rows they match something else.
cv::Mat planeWithWrongBorder(cv::Size size) {
  cv::Mat disparity(size, CV_32FC1, cv::Scalar(kTrue));
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < kTrue; ++x) {
      disparity.at<float>(y, x) = static_cast<float>(y % 3 == 0 ? x : x / 2);
    }
  }
  return disparity;
}

/// The right view agrees with the wrong matches in every fifth row.
TEST(LeftBorder, IsFilledFromTheRightNotWithWrongMatches) {
  const cv::Size size(180, 40);
  const cv::Mat winners = planeWithWrongBorder(size);
  cv::Mat right(size, CV_32FC1, cv::Scalar(kTrue));
  for (int y = 0; y < size.height; y += 5) {
    for (int x = 3; x < kTrue; ++x) {
      right.at<float>(y, x - static_cast<int>(winners.at<float>(y, x))) = winners.at<float>(y, x);
    }
  }
  RefinementOptions options;
  options.median_size_px = 1;
  options.bilateral_sigma_px = 0;
  cv::Mat disparity = winners.clone();
  cv::Mat labels;
  cv::Mat confidence(size, CV_32FC1, cv::Scalar(1));
  DisparityRefiner().refine(winners, kRange, options, {disparity, right, labels, confidence});
  EXPECT_EQ(cv::countNonZero(disparity != kTrue), 0);
  EXPECT_EQ(cv::countNonZero(labels.colRange(0, kTrue) != kOcclusion), 0);
  EXPECT_EQ(cv::countNonZero(confidence.colRange(0, kTrue) != 0.5F), 0);
}

/// Five columns wide in both images, in front of a background that both cameras see beside the
/// object.
TEST(LeftBorder, KeepsTheBackgroundBesideAThinObject) {
  const cv::Size size(160, 40);
  constexpr int kWide = 5;
  constexpr int kBackground = 2;
  cv::Mat left(size, CV_32FC1, cv::Scalar(kBackground));
  cv::Mat right = left.clone();
  left.colRange(kTrue, kTrue + kWide) = kTrue;
  right.colRange(0, kWide) = kTrue;
  cv::Mat labels;
  leftRightCheck(left, right, kRange, 1, labels);
  occludeLeftBorder(left, right, kRange, labels);
  const int first_kept = size.width / 16 + kBackground + 1;
  EXPECT_EQ(cv::countNonZero(labels.colRange(first_kept, kTrue) != kMatch), 0);
  EXPECT_EQ(cv::countNonZero(labels.colRange(0, first_kept) != kOcclusion), 0);
}

}  // namespace
}  // namespace cbmv::test
