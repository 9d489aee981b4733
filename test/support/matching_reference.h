#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "matching/cost_row.h"
#include "matching/padded_image.h"
#include "matching/row_entries.h"
#include "support/random_images.h"
#include "support/simd_targets.h"

namespace cbmv::test {

/// Pixel of an image whose border is repeated.
inline double at(const cv::Mat& gray, int y, int x) {
  return gray.at<std::uint8_t>(std::clamp(y, 0, gray.rows - 1), std::clamp(x, 0, gray.cols - 1));
}

struct MatchingPair {
  cv::Mat left, right;
  cv::Mat padded_left, padded_right;
};

inline MatchingPair makePair(const Shape& shape, Content content) {
  MatchingPair pair{makeGray(shape.size(), content, 3), makeGray(shape.size(), content, 4), {}, {}};
  pair.left.rowRange(0, (shape.height + 1) / 2).setTo(77);  // an area without texture
  padImage(pair.left, pair.padded_left);
  padImage(pair.right, pair.padded_right);
  return pair;
}

using MatchingCase = std::tuple<Shape, Content>;
inline auto allMatchingCases() {
  return testing::Combine(testing::ValuesIn(awkwardShapes()),
                          testing::Values(Content::kNoise, Content::kPatches));
}

/// Calls visit(y, i, x, x_right) for all hypotheses whose match is inside.
template <typename Visit>
void forHypotheses(const Shape& shape, const Visit& visit) {
  for (int y = 0; y < shape.height; ++y) {
    for (int i = 0; i < shape.range.count; ++i) {
      for (int x = 0; x < shape.width; ++x) {
        const int x_right = x - shape.range.min - i;
        if (x_right >= 0 && x_right < shape.width) {
          visit(y, i, x, x_right);
        }
      }
    }
  }
}

/// All hypotheses of a row of the shape.
inline RowEntries allEntries(const Shape& shape) {
  SearchSpace row;
  row.buildExhaustive(1, shape.width, shape.range);
  RowEntries entries;
  entries.build(row, 0);
  return entries;
}

/// Index of column x at disparity range.min + i, whose match is inside, among all hypotheses of the
/// row, place by place.
inline std::size_t hypothesisOf(const RowEntries& entries, int i, int x) {
  const int first = entries.places(i).begin;
  return static_cast<std::size_t>(first * kTileColumns + x - entries.entries()[first].column);
}

/// Costs of the whole pair, computed by `Matcher`, in the order of forHypotheses.
template <typename Cost, typename Matcher, typename ComputeRow>
std::vector<Cost> computeCosts(const MatchingPair& pair, const Shape& shape,
                               const ComputeRow& compute_row) {
  Matcher matcher;
  matcher.prepare(pair.padded_left, pair.padded_right);
  std::vector<CostRow<Cost>> rows(shape.height);
  const RowEntries entries = allEntries(shape);
  for (int y = 0; y < shape.height; ++y) {
    compute_row(matcher, y, entries, rows[y]);
  }
  std::vector<Cost> costs;
  forHypotheses(shape, [&](int y, int i, int x, int) {
    costs.push_back(rows[y].entry(0)[hypothesisOf(entries, i, x)]);
  });
  return costs;
}

/// Compares the costs with expected(y, x, x_right) at all hypotheses whose match is inside. Costs
/// of all instruction sets must be bit-identical.
template <typename Cost, typename Matcher, typename ComputeRow, typename Expected>
void expectCosts(const MatchingPair& pair, const Shape& shape, double tolerance,
                 const ComputeRow& compute_row, const Expected& expected) {
  const std::vector<Cost> costs = computeCosts<Cost, Matcher>(pair, shape, compute_row);
  std::size_t next = 0;
  forHypotheses(shape, [&](int y, int i, int x, int x_right) {
    EXPECT_NEAR(costs[next++], expected(y, x, x_right), tolerance)
        << "y " << y << " x " << x << " i " << i << " in " << shape;
  });
  onEverySimdTarget(
      [&] { EXPECT_EQ((computeCosts<Cost, Matcher>(pair, shape, compute_row)), costs); });
}

}  // namespace cbmv::test
