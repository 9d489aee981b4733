#pragma once

#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "support/random_images.h"

#include "cbmv_stereo/matching/cost_row.h"
#include "cbmv_stereo/matching/padded_image.h"

namespace cbmv::test {

/// Pixel of an image that repeats its border forever.
inline double at(const cv::Mat& grey, int y, int x) {
  return grey.at<std::uint8_t>(std::clamp(y, 0, grey.rows - 1), std::clamp(x, 0, grey.cols - 1));
}

struct MatchingPair {
  cv::Mat left, right;
  cv::Mat padded_left, padded_right;
};

inline MatchingPair makePair(const Shape& shape, Content content) {
  MatchingPair pair{makeGrey(shape.size(), content, 3), makeGrey(shape.size(), content, 4), {}, {}};
  pair.left.rowRange(0, (shape.height + 1) / 2).setTo(77);  // a textureless part
  padImage(pair.left, pair.padded_left);
  padImage(pair.right, pair.padded_right);
  return pair;
}

using MatchingCase = std::tuple<Shape, Content>;
inline auto allMatchingCases() {
  return testing::Combine(testing::ValuesIn(awkwardShapes()),
                          testing::Values(Content::kNoise, Content::kPatches));
}

/// Compares computeRow(y, costs) with expected(y, x, x_right) at all hypotheses that match inside.
template <typename ComputeRow, typename Expected>
void expectCosts(const Shape& shape, double tolerance, const ComputeRow& compute_row,
                 const Expected& expected) {
  CostRow costs;
  for (int y = 0; y < shape.height; ++y) {
    compute_row(y, costs);
    for (int i = 0; i < shape.range.count; ++i) {
      for (int x = 0; x < shape.width; ++x) {
        const int x_right = x - shape.range.min - i;
        if (x_right >= 0 && x_right < shape.width) {
          ASSERT_NEAR(costs.line(i)[x], expected(y, x, x_right), tolerance)
              << "y " << y << " x " << x << " i " << i << " in " << shape;
        }
      }
    }
  }
}

}  // namespace cbmv::test
