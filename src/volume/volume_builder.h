#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "base/per_thread.h"
#include "base/volume.h"
#include "forest/forest_evaluator.h"
#include "matching/matcher_set.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The matchers whose features the trees of the forest use. The others need not be computed.
MatcherSelection askedMatchers(const Forest& forest);

/// Builds the matching cost volume of a pair. Each image row passes through the four matchers, the
/// features in both directions and the forest. The 20 features exist only while their row is
/// processed. Buffers are per thread and kept from frame to frame.
class VolumeBuilder {
 public:
  /// Memory of a thread: entries, costs of all matchers, terms and codes of a row; with `shifts`, a
  /// row of shiftToRightView.
  static double bytesPerThread(double width, double disparities, bool shifts);

  VolumeBuilder();
  ~VolumeBuilder();
  VolumeBuilder(const VolumeBuilder&) = delete;
  VolumeBuilder& operator=(const VolumeBuilder&) = delete;

  /// Sets `volume` to the matching cost volume of the left view (Batsos et al. 2018, section 3.3).
  /// `left` and `right` are CV_8UC1 of the same size. Hypotheses whose match is outside of the
  /// right image have kOutsideCost. Parallel over rows by oneTBB.
  void build(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
             const Forest& forest, const ForestEvaluator& evaluator, MatchingVolume& volume);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Converts the volume of the left view to the right view in place: right(x, d) = left(x + d, d)
/// (Batsos et al. 2018, section 3.3), or kOutsideCost if x + d is outside of the left image. `rows`
/// is scratch memory. Parallel over rows by oneTBB.
void shiftToRightView(const DisparityRange& range, MatchingVolume& volume,
                      PerThread<std::vector<std::uint8_t>>& rows);

}  // namespace cbmv
