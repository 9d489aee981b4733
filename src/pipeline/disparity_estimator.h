#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// Whether a pair of that size is matched at half the size first, to find its surfaces: if switched
/// on, where semi-global matching runs and the shorter side has 128 px at least.
bool findsSurfaces(const cv::Size& image_size, const StereoOptions& options);

/// Everything after the matching volume: optimization of both views, winner takes all, refinement
/// and confidence. Holds the buffers of a frame and of every stage, so one object serves one frame
/// at a time; from the second frame of one size and one set of options on, it allocates nothing.
class DisparityEstimator {
 public:
  DisparityEstimator();
  ~DisparityEstimator();
  DisparityEstimator(const DisparityEstimator&) = delete;
  DisparityEstimator& operator=(const DisparityEstimator&) = delete;

  /// `left` and `right` are the aligned pair, CV_8UC1; `volume` is its matching volume over
  /// options.range, as VolumeBuilder makes it. It is used up: it becomes the right view's, if that
  /// one is optimized for the left-right check, and keeps its memory. Sets all maps and the range
  /// of `result`, whose memory is reused where the size fits, and adds to its times, of all stages
  /// but the rectification. Options must be consistent (correctOptions). Parallel by oneTBB; the
  /// result does not depend on earlier frames nor on the number of threads.
  void estimate(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options,
                MatchingVolume&& volume, StereoResult& result);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
