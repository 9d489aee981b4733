#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/search_space.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// Maps of surface_prior.h for both views; empty: unknown.
struct SurfaceMaps {
  cv::Mat left;
  cv::Mat right;
};

/// Everything after the matching volume, over a search space: optimization of both views, winner
/// takes all, refinement and confidence. Holds the buffers of a frame and of every stage, so one
/// object serves one frame at a time.
class WindowedEstimator {
 public:
  WindowedEstimator();
  ~WindowedEstimator();
  WindowedEstimator(const WindowedEstimator&) = delete;
  WindowedEstimator& operator=(const WindowedEstimator&) = delete;

  /// `left` and `right` are the aligned pair, CV_8UC1; `volume` is its matching volume over
  /// `space`. Sets all maps and the range of `result`, whose memory is reused where the size fits,
  /// and adds to its times, of all stages but the rectification. Options must be consistent
  /// (correctOptions); options.range is not looked at. Parallel by oneTBB; the result does not
  /// depend on earlier frames nor on the number of threads.
  void estimate(const cv::Mat& left, const cv::Mat& right, const SurfaceMaps& surfaces,
                const StereoOptions& options, const SearchSpace& space,
                const WindowedMatchingVolume& volume, StereoResult& result);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
