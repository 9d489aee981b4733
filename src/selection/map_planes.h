#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <opencv2/core.hpp>

#include "selection/cell_grid.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The maps of a pair that the second forest uses. All have the same size (see StereoResult).
struct JudgedMaps {
  const cv::Mat& disparity;        ///< CV_32FC1, px, after refinement
  const cv::Mat& right_disparity;  ///< CV_32FC1, px; empty: unknown
  const cv::Mat& labels;           ///< CV_8UC1 of Label
  const cv::Mat& probability;      ///< CV_32FC1, of the winners, from the first forest
  const cv::Mat& margin;           ///< CV_16UC1
  DisparityRange range;
};

/// Window sizes in cells.
inline constexpr std::array<int, 3> kWindowCells = {3, 5, 9};

/// Disparities in planes are in units of 1/8 px.
inline constexpr int kPlaneUnitsPerPx = 8;
/// Value for an unknown left-right difference.
inline constexpr int kUnknownDifference = 255;
/// Larger margins are clamped to this value.
inline constexpr int kHighestMargin = 2160;

/// Unchanged up to 128, plus 1/16 of the part beyond 128, at most 255. Without branches, for vector
/// code. `value` must not be negative.
constexpr int compressed(int value) {
  return std::min(value, 128) + std::min(std::max(value - 128, 0) >> 4, 127);
}

/// The maps as small integers, and their means over windows of cells. Integers make sums exact and
/// results identical on every machine. The object keeps its memory from pair to pair.
class MapPlanes {
 public:
  void prepare(const JudgedMaps& maps);

  cv::Mat unmatched;    ///< CV_8UC1: 250 where the left-right consistency check failed, otherwise 0
  cv::Mat probability;  ///< CV_8UC1, in 1/255
  cv::Mat margin;       ///< CV_16UC1, at most kHighestMargin
  cv::Mat roughness;  ///< CV_8UC1: differences to the next pixels in x and y, in 1/64 px, up to 248
  cv::Mat disparity;  ///< CV_16SC1, in units of 1/8 px, up to 4094 px
  int no_disparity = 0;  ///< value of `disparity` where there is none
  cv::Mat left_right;    ///< CV_8UC1: left-right difference in 1/8 px, up to 254; 255: unknown

  /// Means over windows of kWindowCells, CV_32SC1, one value per cell.
  struct Windows {
    cv::Mat unmatched;
    cv::Mat probability;
    cv::Mat margin;
    cv::Mat roughness;
    cv::Mat disparity;
  };
  std::array<Windows, kWindowCells.size()> windows;

 private:
  void fillRow(const JudgedMaps& maps, int y);
  void sumWindows();

  CellGrid grid_;
};

}  // namespace cbmv
