#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The support crosses of a pair: CV_8UC4 of the same size, from computeSupportArms.
struct SupportArms {
  cv::Mat reference;  ///< of the image that the costs are registered to
  cv::Mat other;
  int longest_px = 0;  ///< no arm of `reference` is longer
};

/// Cross-based cost aggregation (Žbontar & LeCun 2016, section 4.1): every cost is replaced by the
/// mean, rounded to the nearest integer (halves up), over the combined support region of its two
/// pixels. Holds the memory of the sums, which is kept from run to run, so one object serves one
/// volume at a time.
///
/// The combined arm of hypothesis (x, y, d) is, in each of the four directions, the shorter of the
/// arm at (x, y) in the reference image and the arm at (matchingColumn(view, x, d), y) in the other
/// one. The region is the union of the combined horizontal arms of all pixels on the combined
/// vertical arm. Hypotheses whose match lies outside of the other image are copied; a region never
/// reaches such a hypothesis.
///
/// `costs` and `aggregated` are different volumes; `aggregated` is resized. The reference image of
/// `arms` is the one that `view` names. No cost is above `max_cost`, which is at most 16383; the
/// lower it is and the shorter the arms, the faster the sums (16-bit ones up to arms of 5 pixels
/// and costs of 10922). Vectors by Highway, parallel by oneTBB; the result depends neither on the
/// instruction set nor on the number of threads nor on earlier runs.
class CostAggregator {
 public:
  CostAggregator();
  ~CostAggregator();
  CostAggregator(const CostAggregator&) = delete;
  CostAggregator& operator=(const CostAggregator&) = delete;

  /// One iteration.
  void aggregate(const OptimizedVolume& costs, int max_cost, const SupportArms& arms, View view,
                 const DisparityRange& range, OptimizedVolume& aggregated);

  /// The same on matching costs as they come.
  void aggregate(const MatchingVolume& costs, int max_cost, const SupportArms& arms, View view,
                 const DisparityRange& range, OptimizedVolume& aggregated);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
