#include "refinement/interpolation.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "refinement/left_right_check.h"
#include "support/random_images.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

/// Random labels, one in `match_every` a match and the others of either kind; or patches of labels.
cv::Mat makeLabels(const cv::Size& size, Content content, int match_every, std::uint32_t seed) {
  std::mt19937 random(seed);
  cv::Mat labels(size, CV_8UC1);
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const int patch = patchValue(y, x, 20, seed, random) % 3;
      const bool match = random() % match_every == 0;
      const int wrong = 1 + static_cast<int>(random() % 2);
      labels.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>(content == Content::kPatches ? patch : (match ? 0 : wrong));
    }
  }
  return labels;
}

/// The disparity of the nearest match from x in steps of `step`; invalid if there is none.
float nearestMatch(const cv::Mat& labels, const cv::Mat& disparity, float invalid, int y, int x,
                   int step) {
  for (; isInside(labels, y, x); x += step) {
    if (labels.at<std::uint8_t>(y, x) == kMatch) {
      return disparity.at<float>(y, x);
    }
  }
  return invalid;
}

float naiveOcclusion(const cv::Mat& labels, const cv::Mat& disparity, float invalid, int y, int x) {
  const float background = nearestMatch(labels, disparity, invalid, y, x, -1);
  if (background != invalid || nearestMatch(labels, disparity, invalid, y, x, 1) == invalid) {
    return background;
  }
  std::vector<float> first;
  for (int row = y - 4; row <= y + 4; ++row) {
    const float match = nearestMatch(labels, disparity, invalid, row, 0, 1);
    if (match != invalid) {
      first.push_back(match);
    }
  }
  std::sort(first.begin(), first.end());
  return first[(first.size() - 1) / 2];
}

float naiveMismatch(const cv::Mat& labels, const cv::Mat& disparity, float invalid, int y, int x) {
  std::vector<float> nearest;
  for (int k = 0; k < 16; ++k) {
    const double angle = k * 22.5 * CV_PI / 180;
    const double longer = std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    for (int n = 1;; ++n) {
      const int row = y + static_cast<int>(std::lround(n * std::sin(angle) / longer));
      const int column = x + static_cast<int>(std::lround(n * std::cos(angle) / longer));
      if (!isInside(labels, row, column)) {
        break;
      }
      if (labels.at<std::uint8_t>(row, column) == kMatch) {
        nearest.push_back(disparity.at<float>(row, column));
        break;
      }
    }
  }
  std::sort(nearest.begin(), nearest.end());
  return nearest.empty() ? invalid : nearest[(nearest.size() - 1) / 2];
}

class Interpolation : public testing::TestWithParam<Case> {
 protected:
  /// Fills the pixels with this label using `fill`. Expects `naive` there and no changes elsewhere.
  template <typename Fill, typename Naive>
  void expectFilled(Label label, const Fill& fill, const Naive& naive) {
    const auto [shape, view, content] = GetParam();
    const DisparityRange range = shape.range;
    const std::uint32_t seed = view == View::kLeft ? 13 : 14;
    for (const int match_every : {1, 3, 40, 1000, 1000000}) {
      const cv::Mat labels = makeLabels(shape.size(), content, match_every, seed);
      const cv::Mat before = makeDisparity(shape, content, 1000000, seed);
      cv::Mat expected = before.clone();
      for (int y = 0; y < shape.height; ++y) {
        for (int x = 0; x < shape.width; ++x) {
          if (labels.at<std::uint8_t>(y, x) == label) {
            expected.at<float>(y, x) = naive(labels, before, range.invalid(), y, x);
          }
        }
      }
      onEverySimdTarget([&, all = shape] {
        cv::Mat after = before.clone();
        fill(labels, range, after);
        expectMap<float>(after, all.size(), [&](int y, int x) { return expected.at<float>(y, x); });
      });
    }
  }
};

TEST_P(Interpolation, OcclusionsEqualNaiveOnes) {
  expectFilled(kOcclusion, fillOcclusions, naiveOcclusion);
}

TEST_P(Interpolation, MismatchesEqualNaiveOnes) {
  const auto fill = [](const cv::Mat& labels, const DisparityRange& range, cv::Mat& map) {
    fillMismatches(labels, range, map.clone(), map);
  };
  expectFilled(kMismatch, fill, naiveMismatch);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Interpolation, allCases());
INSTANTIATE_TEST_SUITE_P(LongRays, Interpolation,
                         testing::Combine(testing::Values(Shape{61, 150, {0, 64}}),
                                          testing::Values(View::kLeft),
                                          testing::Values(Content::kNoise, Content::kPatches)));

}  // namespace
}  // namespace cbmv::test
