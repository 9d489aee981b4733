#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "forest/forest_evaluator.h"

namespace cbmv {

/// Builds the matching cost volume of a pair over a search space. It works like VolumeBuilder, but
/// only on the hypotheses of the space: only they have costs, and only they are competitors in both
/// matching directions. Buffers are per thread and kept from frame to frame.
class WindowedVolumeBuilder {
 public:
  WindowedVolumeBuilder();
  ~WindowedVolumeBuilder();
  WindowedVolumeBuilder(const WindowedVolumeBuilder&) = delete;
  WindowedVolumeBuilder& operator=(const WindowedVolumeBuilder&) = delete;

  /// `left` and `right` are CV_8UC1 of the size of the space. Hypotheses whose match is outside of
  /// the right image and columns beyond the image have kOutsideCost. With an exhaustive space, the
  /// costs are equal to those of VolumeBuilder. Parallel over rows by oneTBB.
  void build(const cv::Mat& left, const cv::Mat& right, const SearchSpace& space,
             const Forest& forest, const ForestEvaluator& evaluator,
             WindowedMatchingVolume& volume);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
