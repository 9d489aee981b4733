#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "forest/confidence_evaluator.h"
#include "selection/cell_grid.h"
#include "selection/confident_neighbors.h"
#include "selection/map_planes.h"
#include "selection/window_rows.h"

namespace cbmv {

/// Features of the selection forest in the order of their names, one byte each. They describe a
/// disparity that is proposed for a pixel:
///   change        difference from the disparity of the map, 4 per px, 128: none
///   left_right, border   of the proposal, as in confidenceFeatureNames
///   distance      distance of the pixel that proposes it, px; 0: the pixel itself
///   source        60 per Source
///   support_5     fraction of the 5 × 5 px around with a disparity within 1 px, in 1/250
///   weighted_support_5   the same, each pixel weighted with its confidence
///   support_17, weighted_support_17   the same for 25 pixels 4 px apart
///   confidence, confidence_5, _12, _20   of the map: of the pixel and means over windows
///   unmatched, unmatched_5, probability_5   as in confidenceFeatureNames
///   own_support_5, own_weighted_support_17   for the disparity of the map
const std::vector<std::string>& selectionFeatureNames();

/// The results of the confidence forest, and data computed from them once per pair.
class ConfidencePlanes {
 public:
  /// `confidence` is CV_8UC1 in 1/255. `confidence` and `planes` must not change afterwards.
  void prepare(const MapPlanes& planes, const cv::Mat& confidence);

  static constexpr int kBorderPx = 8;  ///< border of the padded maps

  cv::Mat confidence;
  cv::Mat padded_confidence;          ///< CV_16SC1, border repeated
  cv::Mat padded_disparity;           ///< CV_16SC1, border repeated
  std::array<cv::Mat, 2> cell_means;  ///< over windows of 3 and 5 cells, CV_32SC1
  ConfidentNeighbors neighbors;

 private:
  CellGrid grid_;
  cv::Mat wide_confidence_;  ///< CV_16SC1
};

/// Computes the features of all proposals for some pixels of a row. Has memory for one row.
class SelectionFeatures {
 public:
  /// Pixels per call of code(). Blocks begin at multiples of it.
  static constexpr int kBlock = 16;
  /// Number of blocks whose queries fit one set of codes.
  static constexpr int kSlots = 3;
  static_assert(kSlots * kBlock * kSources <= ConfidenceCodes::kQueries &&
                kBlock % CellGrid::kCellPx == 0);

  /// Index of the query for the proposal of a source, for pixel `i` of the block in a slot.
  static constexpr int query(int source, int slot, int i) {
    return (source * kSlots + slot) * kBlock + i;
  }

  /// Proposals for the pixels of a block in units of the disparity plane, [source][pixel].
  using Proposals = std::array<std::array<std::int16_t, kBlock>, kSources>;

  /// Returns whether the source has a proposal for pixel `i` that is more than 1 px away from the
  /// pixel's own disparity, if the pixel has one.
  static bool isNew(const Proposals& proposals, int source, int i, bool has_own) {
    const int proposal = proposals[source][i];
    return proposal != ConfidentNeighbors::kNoNeighbor &&
           (!has_own || std::abs(proposal - proposals[0][i]) > kPlaneUnitsPerPx);
  }

  void resize(int width);
  void startRow(const MapPlanes& planes, const ConfidencePlanes& confidence,
                const float* right_disparity, float right_invalid, int y);
  /// Sets the proposals for the `count` pixels from `x` on. kNoNeighbor where there is none.
  void propose(int x, int count, Proposals& proposals) const;
  /// Computes the codes of these proposals in the queries of `slot`.
  void code(int x, int count, const Proposals& proposals, int slot, ConfidenceCodes& codes) const;

 private:
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
