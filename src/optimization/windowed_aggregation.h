#pragma once

#include <memory>

#include "base/search_space.h"
#include "optimization/cross_based_aggregation.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Cross-based cost aggregation (see CostAggregator) over the hypotheses of a search space.
///
/// A region only contains pixels whose tile has the disparity of the hypothesis in its list. A
/// combined horizontal arm ends before the first pixel without it. A row is skipped if its pixel on
/// the combined vertical arm does not have it. In an exhaustive search, the means are equal to
/// those of CostAggregator.
///
/// `costs` and `aggregated` are different volumes of `space`; `aggregated` is resized. The
/// reference image of `arms` is the image of `view`. No cost may exceed `max_cost`, which is at
/// most 16383. Arms of up to 7 pixels are fastest if max_cost · (arm + 1) ≤ 65535.
///
/// Vectors by Highway, parallel by oneTBB. The result does not depend on the instruction set, the
/// number of threads or earlier runs. The object keeps the memory of the sums from run to run, so
/// it processes one volume at a time.
class WindowedAggregator {
 public:
  WindowedAggregator();
  ~WindowedAggregator();
  WindowedAggregator(const WindowedAggregator&) = delete;
  WindowedAggregator& operator=(const WindowedAggregator&) = delete;

  /// Runs one iteration.
  void aggregate(const SearchSpace& space, const WindowedAggregatedVolume& costs, int max_cost,
                 const SupportArms& arms, View view, WindowedAggregatedVolume& aggregated);

  /// Runs one iteration on matching costs.
  void aggregate(const SearchSpace& space, const WindowedMatchingVolume& costs, int max_cost,
                 const SupportArms& arms, View view, WindowedAggregatedVolume& aggregated);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
