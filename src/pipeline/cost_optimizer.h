#pragma once

#include <utility>

#include "base/stopwatch.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// Applies cost aggregation, SGM and cost aggregation again to the costs of one view, as often as
/// the options say. The first step reads the matching costs, so the second aggregated cost volume
/// is needed only from the second step on. The object has both volumes.
template <typename Matching, typename Aggregated>
class CostOptimizer {
 public:
  /// `aggregate` and `match` (SGM) are called with input costs of either type and the volume to
  /// fill. `widen` copies the matching costs if there is no step.
  template <typename Aggregate, typename Match, typename Widen>
  const Aggregated& optimize(const Matching& costs, const StereoOptions& options, StageTimes& times,
                             const Aggregate& aggregate, const Match& match, const Widen& widen) {
    matching_costs_ = &costs;
    repeat(options.aggregation.iterations_before, aggregate, times.aggregation_ms);
    repeat(options.sgm.iterations, match, times.sgm_ms);
    repeat(options.aggregation.iterations_after, aggregate, times.aggregation_ms);
    if (matching_costs_ != nullptr) {
      widen(costs, *aggregated_);
    }
    return *aggregated_;
  }

 private:
  template <typename Step>
  void repeat(int iterations, const Step& step, double& ms) {
    const Stopwatch watch(ms);
    for (int i = 0; i < iterations; ++i) {
      if (matching_costs_ != nullptr) {
        step(*matching_costs_, *aggregated_);
        matching_costs_ = nullptr;
      } else {
        step(*aggregated_, *spare_);
        std::swap(aggregated_, spare_);
      }
    }
  }

  Aggregated first_;
  Aggregated second_;
  Aggregated* aggregated_ = &first_;
  Aggregated* spare_ = &second_;
  const Matching* matching_costs_ = nullptr;  ///< input of the next step; null after the first step
};

}  // namespace cbmv
