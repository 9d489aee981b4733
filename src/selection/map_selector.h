#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "forest/forest.h"
#include "selection/map_confidence.h"
#include "selection/selection_features.h"

namespace cbmv {

/// The maps that the second forest changes (see StereoResult).
struct SelectedMaps {
  cv::Mat& disparity;        ///< CV_32FC1
  cv::Mat& confidence;       ///< CV_32FC1
  cv::Mat& disparity_sigma;  ///< CV_32FC1; becomes empty where the forest has no model of it
};

/// What MapSelector may change, and how it publishes what the second forest says.
struct SelectionOptions {
  bool replace = true;            ///< replace improbable disparities
  bool fill = true;               ///< also give a disparity to pixels without one
  float confidence_scale = 1.0F;  ///< see RefinementOptions
  float confidence_shift = 0.0F;
  float sigma_scale = 1.0F;
};

/// Last stage: replaces disparities that are probably wrong by those of confident neighbors, and
/// sets the confidence of every pixel. After Schönberger, Sinha and Pollefeys 2018 (SGM-Forest),
/// with pixels in place of scan lines as sources of proposals.
///
/// The confidence forest judges each pixel. Where it gives (before recalibration) less than
/// ConfidentNeighbors::kConfident, the nearest confident pixels on the left, on the right, above
/// and below propose their disparities. Where one is more than 1 px from the pixel's own, the
/// selection forest judges them all. The most probable one is taken, the pixel's own on ties, and
/// its probability becomes the confidence. A pixel of a thin object (isThin) that
/// passed the left-right consistency check never takes a farther disparity. Afterwards a median of
/// 3 × 3 px removes isolated disparities.
///
/// Holds its memory from pair to pair, so one object serves one pair at a time.
class MapSelector {
 public:
  /// Memory in bytes for an image with this number of pixels and this width in px: of the
  /// confidence forest and, if `replaces`, of the selection forest.
  static double memoryBytes(double pixels, double width, double threads, bool replaces);

  /// `forest` must have a confidence forest. Without a selection forest, no disparity is replaced.
  /// Throws Error if features differ (requireFeatures).
  explicit MapSelector(std::shared_ptr<const Forest> forest);

  /// `maps` are those in `judged` and share their memory. The confidence of pixels without a
  /// disparity is 0. Parallel over rows by oneTBB; the result depends
  /// neither on the instruction set nor on the number of threads nor on earlier pairs.
  void select(const JudgedMaps& judged, const SelectionOptions& options, const SelectedMaps& maps);

 private:
  /// Memory for a row: some blocks of pixels that are judged at once.
  struct Row {
    SelectionFeatures features;
    std::array<SelectionFeatures::Proposals, SelectionFeatures::kSlots> proposals{};
    std::array<int, SelectionFeatures::kSlots> first_pixels{};
    int blocks = 0;
    ConfidenceCodes codes;
    alignas(64) std::array<std::uint16_t, ConfidenceCodes::kQueries> scores{};
  };

  void tabulate(const SelectionOptions& options);
  float sigmaPx(int y, int x, std::uint8_t probability) const;
  void fillRow(int y, float invalid, const SelectedMaps& maps) const;
  void selectRow(const JudgedMaps& judged, int y, bool fill, const SelectedMaps& maps, Row& row);
  bool canChange(int y, int x, const SelectionFeatures::Proposals& proposals, bool fill,
                 int i) const;
  void chooseInBlocks(int y, bool fill, const SelectedMaps& maps, Row& row) const;
  int mostProbable(const Row& row, int block, int i, int least) const;
  void choose(int y, const Row& row, int block, int i, const SelectedMaps& maps) const;
  bool isImprobable(int y, int x, bool fill) const;
  bool isThinObject(int y, int x) const;
  bool isAnyImprobable(int y, int x, int count, bool fill) const;
  /// `units` are of the disparity plane.
  bool hasDisparity(int units) const { return units != confidence_.planes().no_disparity; }

  std::shared_ptr<const Forest> forest_;
  MapConfidence confidence_;
  std::optional<ConfidenceEvaluator> evaluator_;  ///< of the selection forest
  ConfidencePlanes planes_;
  cv::Mat median_padded_;
  cv::Mat filtered_;
  std::array<float, 256> published_{};  ///< confidence of each probability in 1/255
  float sigma_scale_ = 1.0F;
  PerThread<Row> rows_;
};

}  // namespace cbmv
