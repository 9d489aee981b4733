#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/search_space.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// Surface maps (surface_prior.h) for both views. Empty: unknown.
struct SurfaceMaps {
  cv::Mat left;
  cv::Mat right;
};

/// All stages after the matching cost volume, over a search space: cost aggregation and SGM of both
/// views, WTA, refinement and confidence. The object has the buffers of a frame and of every stage,
/// so it processes one frame at a time.
class WindowedEstimator {
 public:
  WindowedEstimator();
  ~WindowedEstimator();
  WindowedEstimator(const WindowedEstimator&) = delete;
  WindowedEstimator& operator=(const WindowedEstimator&) = delete;

  /// `left` and `right` are the rectified pair after the rectification correction, CV_8UC1.
  /// `volume` is its matching cost volume over `space`. Sets all maps and the range of `result`;
  /// their memory is reused where the size fits. Adds to the times of all stages except the
  /// rectification. Options must be consistent (correctOptions); options.range is ignored. Parallel
  /// by oneTBB. The result does not depend on earlier frames or the number of threads.
  void estimate(const cv::Mat& left, const cv::Mat& right, const SurfaceMaps& surfaces,
                const StereoOptions& options, const SearchSpace& space,
                const WindowedMatchingVolume& volume, StereoResult& result);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
