#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// Returns whether a pair of this size is first matched at half the size to find its surfaces: if
/// the surface prior is enabled, SGM runs, and the shorter side has at least 128 px.
bool findsSurfaces(const cv::Size& image_size, const StereoOptions& options);

/// All stages after the matching cost volume: cost aggregation and SGM of both views, WTA,
/// refinement and confidence. The object has the buffers of a frame and of every stage, so it
/// processes one frame at a time. From the second frame with the same size and options on, it does
/// not allocate.
class DisparityEstimator {
 public:
  DisparityEstimator();
  ~DisparityEstimator();
  DisparityEstimator(const DisparityEstimator&) = delete;
  DisparityEstimator& operator=(const DisparityEstimator&) = delete;

  /// `left` and `right` are the rectified pair after the rectification correction, CV_8UC1.
  /// `volume` is its matching cost volume over options.range, from VolumeBuilder. It is overwritten
  /// with the volume of the right view if that view runs through SGM for the left-right consistency
  /// check; its memory is kept.
  ///
  /// Sets all maps and the range of `result`; their memory is reused where the size fits. Adds to
  /// the times of all stages except the rectification. Options must be consistent (correctOptions).
  /// Parallel by oneTBB. The result does not depend on earlier frames or the number of threads.
  void estimate(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options,
                MatchingVolume&& volume, StereoResult& result);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
