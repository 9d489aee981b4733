#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cbmv_stereo/forest/forest.h"

namespace cbmv {

/// Applies a forest to rows of feature codes. Built once from a Forest, then read by any number of
/// threads.
class ForestEvaluator {
 public:
  explicit ForestEvaluator(const Forest& forest);

  /// `codes[f]` points to `count` codes of feature f. `costs[i]` becomes the matching cost of
  /// hypothesis i: 1 − probability, times 255, rounded (Batsos et al. 2018, section 3.3).
  void evaluate(const std::array<const std::uint8_t*, kFeatureCount>& codes, int count,
                std::uint8_t* costs) const;

 private:
  std::vector<ObliviousTree> trees_;
  std::int32_t lowest_sum_ = 0;            ///< of all leaves
  std::vector<std::uint8_t> cost_of_sum_;  ///< indexed by sum − lowest_sum_
};

}  // namespace cbmv
