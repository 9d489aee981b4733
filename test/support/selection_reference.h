#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>

#include <opencv2/core.hpp>

#include "selection/confidence_features.h"
#include "selection/confident_neighbors.h"
#include "selection/map_planes.h"

// Features of the second forest, computed pixel by pixel from the planes.
namespace cbmv::test {

/// Value of an integer map; outside, the value of the nearest border pixel.
inline int valueAt(const cv::Mat& map, int y, int x) {
  y = std::clamp(y, 0, map.rows - 1);
  x = std::clamp(x, 0, map.cols - 1);
  switch (map.type()) {
    case CV_8UC1:
      return map.at<std::uint8_t>(y, x);
    case CV_16UC1:
      return map.at<std::uint16_t>(y, x);
    case CV_16SC1:
      return map.at<std::int16_t>(y, x);
    default:
      return map.at<std::int32_t>(y, x);
  }
}

inline int roundDown(double value) { return static_cast<int>(std::floor(value)); }

/// Sum over 5 × 5 pixels.
inline int naiveSum25(const cv::Mat& map, int y, int x) {
  int sum = 0;
  for (int row = y - 2; row <= y + 2; ++row) {
    for (int column = x - 2; column <= x + 2; ++column) {
      sum += valueAt(map, row, column);
    }
  }
  return sum;
}

/// Mean of 25 pixels from their sum. For large sums, one less than a multiple of 25 counts as that
/// multiple.
inline int naiveMean25(int sum) { return (sum + (sum > 43690 ? 1 : 0)) / 25; }

/// Sum over a cell of 4 × 4 pixels.
inline int naiveCellSum(const cv::Mat& map, int cell_y, int cell_x) {
  int sum = 0;
  for (int i = 0; i < 16; ++i) {
    sum += valueAt(map, 4 * cell_y + i / 4, 4 * cell_x + i % 4);
  }
  return sum;
}

/// Mean over the window of `cells` × `cells` cells around the cell of a pixel.
inline int naiveCellMean(const cv::Mat& map, int cells, int y, int x) {
  const int last_row = (map.rows + 3) / 4 - 1;
  const int last_column = (map.cols + 3) / 4 - 1;
  double sum = 0;
  for (int row = y / 4 - cells / 2; row <= y / 4 + cells / 2; ++row) {
    for (int column = x / 4 - cells / 2; column <= x / 4 + cells / 2; ++column) {
      sum += naiveCellSum(map, std::clamp(row, 0, last_row), std::clamp(column, 0, last_column));
    }
  }
  return roundDown(sum / (16 * cells * cells));
}

/// Distance of the match from the left border of the right image.
inline int naiveBorder(int x, int disparity) {
  return 3 * std::clamp(x - roundDown(disparity / 8.0) + 5, 0, 84);
}

/// Difference between both views in units of the plane.
inline int naiveLeftRight(double disparity_px, int match, const cv::Mat& right, float invalid,
                          int y) {
  if (right.empty() || match < 0 || match >= right.cols || right.at<float>(y, match) == invalid) {
    return 255;
  }
  return static_cast<int>(std::fmin(254, std::fabs(disparity_px - right.at<float>(y, match)) * 8));
}

using NamedValues = std::map<std::string, int>;

/// Values of confidenceFeatureNames.
inline NamedValues naiveConfidenceFeatures(const MapPlanes& planes, int y, int x) {
  const int disparity = valueAt(planes.disparity, y, x);
  const auto mean25 = [&](const cv::Mat& map) { return naiveMean25(naiveSum25(map, y, x)); };
  const auto cells = [&](const cv::Mat& map, int count) { return naiveCellMean(map, count, y, x); };
  const auto deviation = [&](int count) {
    return compressed(std::abs(disparity - cells(planes.disparity, count)));
  };
  const int deviation25 = std::abs(25 * disparity - naiveSum25(planes.disparity, y, x));
  return {{"probability", valueAt(planes.probability, y, x)},
          {"margin", compressed(valueAt(planes.margin, y, x))},
          {"left_right", valueAt(planes.left_right, y, x)},
          {"unmatched", valueAt(planes.unmatched, y, x)},
          {"border", naiveBorder(x, disparity)},
          {"unmatched_5", mean25(planes.unmatched)},
          {"probability_5", mean25(planes.probability)},
          {"margin_5", compressed(mean25(planes.margin))},
          {"roughness_5", mean25(planes.roughness)},
          {"deviation_5", compressed(naiveMean25(deviation25))},
          {"unmatched_12", cells(planes.unmatched, 3)},
          {"probability_12", cells(planes.probability, 3)},
          {"margin_12", compressed(cells(planes.margin, 3))},
          {"deviation_12", deviation(3)},
          {"roughness_20", cells(planes.roughness, 5)},
          {"deviation_20", deviation(5)},
          {"unmatched_36", cells(planes.unmatched, 9)},
          {"probability_36", cells(planes.probability, 9)},
          {"margin_36", compressed(cells(planes.margin, 9))},
          {"roughness_36", cells(planes.roughness, 9)},
          {"deviation_36", deviation(9)}};
}

struct NaiveNeighbor {
  int disparity = ConfidentNeighbors::kNoNeighbor;
  int distance = 255;
};

/// The nearest confident pixel in direction (dy, dx).
inline NaiveNeighbor naiveNeighbor(const cv::Mat& disparity, const cv::Mat& confidence, int y,
                                   int x, int dy, int dx) {
  for (int steps = 0; y >= 0 && y < disparity.rows && x >= 0 && x < disparity.cols;
       ++steps, y += dy, x += dx) {
    if (valueAt(confidence, y, x) >= ConfidentNeighbors::kConfident) {
      return {valueAt(disparity, y, x), std::min(steps, 255)};
    }
  }
  return {};
}

/// The pixel's own disparity and those of its neighbors.
inline std::array<NaiveNeighbor, kSources> naiveProposals(const cv::Mat& disparity,
                                                          const cv::Mat& confidence, int y, int x) {
  const auto neighbor = [&](int dy, int dx) {
    return naiveNeighbor(disparity, confidence, y, x, dy, dx);
  };
  return {{{valueAt(disparity, y, x), 0},
           neighbor(0, -1),
           neighbor(0, 1),
           neighbor(-1, 0),
           neighbor(1, 0)}};
}

/// Number of pixels with a similar disparity among 5 × 5 pixels that are `step` px apart,
/// unweighted and weighted.
struct NaiveSupport {
  int plain = 0;
  int weighted = 0;
};

inline NaiveSupport naiveSupport(const cv::Mat& disparity, const cv::Mat& confidence, int y, int x,
                                 int step, int proposal) {
  int count = 0;
  int weight = 0;
  int total = 0;
  for (int i = 0; i < 25; ++i) {
    const int row = y + (i / 5 - 2) * step;
    const int column = x + (i % 5 - 2) * step;
    const bool is_near = std::abs(valueAt(disparity, row, column) - proposal) <= 8;
    count += is_near ? 1 : 0;
    weight += is_near ? valueAt(confidence, row, column) : 0;
    total += valueAt(confidence, row, column);
  }
  return {10 * count, total == 0 ? 0 : 250 * weight / total};
}

/// Values of selectionFeatureNames for proposal `source` of a pixel; `right` is empty if unknown.
inline NamedValues naiveSelectionFeatures(const MapPlanes& planes, const cv::Mat& confidence,
                                          const cv::Mat& right, float invalid, int y, int x,
                                          int source) {
  const auto proposals = naiveProposals(planes.disparity, confidence, y, x);
  const NaiveNeighbor& proposal = proposals[source];
  const int match = x - roundDown((proposal.disparity + 4) / 8.0);
  const auto support = [&](int step, int disparity) {
    return naiveSupport(planes.disparity, confidence, y, x, step, disparity);
  };
  const auto mean25 = [&](const cv::Mat& map) { return naiveMean25(naiveSum25(map, y, x)); };
  const NaiveSupport near = support(1, proposal.disparity);
  const NaiveSupport far = support(4, proposal.disparity);
  const int own = proposals[0].disparity;
  return {{"change", std::clamp(128 + roundDown((proposal.disparity - own) / 2.0), 0, 255)},
          {"left_right", naiveLeftRight(proposal.disparity / 8.0, match, right, invalid, y)},
          {"border", naiveBorder(x, proposal.disparity)},
          {"distance", proposal.distance},
          {"source", 60 * source},
          {"support_5", near.plain},
          {"weighted_support_5", near.weighted},
          {"support_17", far.plain},
          {"weighted_support_17", far.weighted},
          {"confidence", valueAt(confidence, y, x)},
          {"confidence_5", mean25(confidence)},
          {"confidence_12", naiveCellMean(confidence, 3, y, x)},
          {"confidence_20", naiveCellMean(confidence, 5, y, x)},
          {"unmatched", valueAt(planes.unmatched, y, x)},
          {"unmatched_5", mean25(planes.unmatched)},
          {"probability_5", mean25(planes.probability)},
          {"own_support_5", support(1, own).plain},
          {"own_weighted_support_17", support(4, own).weighted}};
}

}  // namespace cbmv::test
