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

/// The matchers whose features a tree of the forest asks for: the others need not be computed.
MatcherSelection askedMatchers(const Forest& forest);

/// Builds the matching volume of a pair: streams the image row by row through the four matchers,
/// the bidirectional features and the forest. The 20 features of a row exist only while their row
/// is processed; each thread has its own buffers, kept from frame to frame.
class VolumeBuilder {
 public:
  VolumeBuilder();
  ~VolumeBuilder();
  VolumeBuilder(const VolumeBuilder&) = delete;
  VolumeBuilder& operator=(const VolumeBuilder&) = delete;

  /// `left` and `right` are CV_8UC1 of the same size. `volume` becomes the matching volume of the
  /// left view (Batsos et al. 2018, section 3.3); hypotheses whose match lies outside of the right
  /// image hold kOutsideCost. Parallel over rows by oneTBB.
  void build(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
             const Forest& forest, const ForestEvaluator& evaluator, MatchingVolume& volume);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Turns the left view's volume into the right view's in place: right(x, d) = left(x + d, d)
/// (Batsos et al. 2018, section 3.3); kOutsideCost where x + d lies outside of the left image.
/// `rows` is scratch. Parallel over rows by oneTBB.
void shiftToRightView(const DisparityRange& range, MatchingVolume& volume,
                      PerThread<std::vector<std::uint8_t>>& rows);

}  // namespace cbmv
