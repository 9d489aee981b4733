#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/forest/confidence_evaluator.h"
#include "cbmv_stereo/selection/cell_grid.h"
#include "cbmv_stereo/selection/confident_neighbors.h"
#include "cbmv_stereo/selection/map_planes.h"
#include "cbmv_stereo/selection/window_rows.h"

namespace cbmv {

/// Features of the selection forest, one byte each, in the order of their names. They describe a
/// disparity that is proposed for a pixel:
///   change        to the disparity of the map, px, 128: none
///   left_right, border   as confidenceFeatureNames, of the proposal
///   distance      of the pixel that it is taken from, px; 0: the pixel's own
///   source        60 per Source
///   support_5     part of the 5 × 5 px around whose disparity is within 1 px of it, in 1/250
///   weighted_support_5   the same, each pixel weighted with its confidence
///   support_17, weighted_support_17   the same for 25 pixels 4 px apart
///   confidence, confidence_5, _12, _20   of the map: of the pixel and mean over windows
///   unmatched, unmatched_5, probability_5   as confidenceFeatureNames
///   own_support_5, own_weighted_support_17   those of the map's disparity
const std::vector<std::string>& selectionFeatureNames();

/// What the confidence forest said, and what is made of it once per pair.
class ConfidencePlanes {
 public:
  /// `confidence` is CV_8UC1, in 1/255, and must stay as it is, as well as `planes`.
  void prepare(const MapPlanes& planes, const cv::Mat& confidence);

  static constexpr int kBorderPx = 8;  ///< of the padded maps

  cv::Mat confidence;
  cv::Mat padded_confidence;          ///< CV_16SC1, border repeated
  cv::Mat padded_disparity;           ///< CV_16SC1, border repeated
  std::array<cv::Mat, 2> cell_means;  ///< of windows of 3 and 5 cells, CV_32SC1
  ConfidentNeighbors neighbors;

 private:
  CellGrid grid_;
  cv::Mat wide_confidence_;  ///< CV_16SC1
};

/// Computes the features of all proposals of some pixels of a row. Holds memory for one row.
class SelectionFeatures {
 public:
  static constexpr int kBlock = 48;  ///< most pixels that are coded at once
  static_assert(kBlock * kSources <= ConfidenceCodes::kQueries && kBlock % CellGrid::kCellPx == 0);

  /// Proposals of the pixels of a block, in planes' units, [source][pixel].
  using Proposals = std::array<std::array<std::int16_t, kBlock>, kSources>;

  void resize(int width);
  void startRow(const MapPlanes& planes, const ConfidencePlanes& confidence,
                const float* right_disparity, float right_invalid, int y);
  /// Codes of the `count` pixels from `x` on, a multiple of CellGrid::kCellPx: proposal p of pixel
  /// i is query p · kBlock + i. Gives proposals, too; kNoNeighbor where there is none.
  void code(int x, int count, Proposals& proposals, ConfidenceCodes& codes);

 private:
  void propose(int x, int count, Proposals& proposals) const;

  const MapPlanes* planes_ = nullptr;
  const ConfidencePlanes* confidence_ = nullptr;
  const float* right_disparity_ = nullptr;
  float right_invalid_ = 0;
  int y_ = 0;
  WindowRow unmatched_;
  WindowRow probability_;
  WindowRow confidence_window_;
  const std::int32_t* unmatched_sums_ = nullptr;
  const std::int32_t* probability_sums_ = nullptr;
  const std::int32_t* confidence_sums_ = nullptr;
  ConfidentNeighbors::RowMemory neighbors_;
};

}  // namespace cbmv
