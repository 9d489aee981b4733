#pragma once

#include <memory>

#include "base/search_space.h"
#include "optimization/cross_based_aggregation.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Cross-based cost aggregation (see CostAggregator) of the hypotheses of a search space.
///
/// A region holds no pixel whose tile does not have the disparity of the hypothesis in its list: a
/// combined horizontal arm ends in front of the first such pixel, and a row is left out whose pixel
/// on the combined vertical arm is one. In an exhaustive search the means are those of
/// CostAggregator.
///
/// `costs` and `aggregated` are volumes of `space` and not the same one; `aggregated` is resized.
/// The reference image of `arms` is the one that `view` names. No cost is above `max_cost`, which
/// is at most 16383. Arms of up to 7 pixels are fastest, as long as max_cost · (arm + 1) ≤ 65535.
/// Vectors by Highway, parallel by oneTBB; the result depends neither on the instruction set nor on
/// the number of threads nor on earlier runs. Holds the memory of the sums, which is kept from run
/// to run, so one object serves one volume at a time.
class WindowedAggregator {
 public:
  WindowedAggregator();
  ~WindowedAggregator();
  WindowedAggregator(const WindowedAggregator&) = delete;
  WindowedAggregator& operator=(const WindowedAggregator&) = delete;

  /// One iteration.
  void aggregate(const SearchSpace& space, const WindowedOptimizedVolume& costs, int max_cost,
                 const SupportArms& arms, View view, WindowedOptimizedVolume& aggregated);

  /// The same on matching costs as they come.
  void aggregate(const SearchSpace& space, const WindowedMatchingVolume& costs, int max_cost,
                 const SupportArms& arms, View view, WindowedOptimizedVolume& aggregated);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
