#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The support crosses of a pair, from computeSupportArms: two CV_8UC4 maps of the same size.
struct SupportArms {
  cv::Mat reference;  ///< for the image that the costs are registered to
  cv::Mat other;
  int longest_px = 0;  ///< length of the longest arm of `reference`, or more
};

/// Cross-based cost aggregation (Žbontar & LeCun 2016, section 4.1). Every cost is replaced by the
/// mean over the combined support region of its two pixels, rounded to the nearest integer (halves
/// up).
///
/// The combined arm of hypothesis (x, y, d) in each of the four directions is the shorter of two
/// arms: the arm at (x, y) in the reference image, and the arm at (matchingColumn(view, x, d), y)
/// in the other image. The region is the union of the combined horizontal arms of all pixels on the
/// combined vertical arm. Hypotheses whose match is outside of the other image are copied. A region
/// never contains such a hypothesis.
///
/// `costs` and `aggregated` are different volumes; `aggregated` is resized. The reference image of
/// `arms` is the image of `view`. No cost may exceed `max_cost`, which is at most 16383. Sums are
/// faster for lower `max_cost` and shorter arms; sums of 16 bits are possible for arms of up to 5
/// pixels and costs of up to 10922.
///
/// Vectors by Highway, parallel by oneTBB. The result does not depend on the instruction set, the
/// number of threads or earlier runs. The object keeps the memory of the sums from run to run, so
/// it processes one volume at a time.
class CostAggregator {
 public:
  /// Memory for images of `width` columns: the arms, sorted by the match.
  static double bytesPerPixel(double width, double disparities) {
    return 4 + 4 * disparities / width;
  }
  /// Memory of a thread: at most two lines for each column of a tile and each row that arms span.
  static double bytesPerThread(double width, double disparities, int longest_arm_px);

  CostAggregator();
  ~CostAggregator();
  CostAggregator(const CostAggregator&) = delete;
  CostAggregator& operator=(const CostAggregator&) = delete;

  /// Runs one iteration.
  void aggregate(const AggregatedVolume& costs, int max_cost, const SupportArms& arms, View view,
                 const DisparityRange& range, AggregatedVolume& aggregated);

  /// Runs one iteration on matching costs.
  void aggregate(const MatchingVolume& costs, int max_cost, const SupportArms& arms, View view,
                 const DisparityRange& range, AggregatedVolume& aggregated);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
