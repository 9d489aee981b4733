#include "optimization/sgm_penalties.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "cbmv_stereo/error.h"

namespace cbmv {

SgmPenalties makePenalties(const SgmOptions& options, double p1_divisor) {
  const std::array<double, 3> divisors = {1.0, options.q1,
                                          static_cast<double>(options.q1) * options.q2};
  SgmPenalties penalties{};
  for (std::size_t edges = 0; edges < divisors.size(); ++edges) {
    penalties.p1[edges] =
        static_cast<std::int16_t>(std::lround(255.0 * options.p1 / (divisors[edges] * p1_divisor)));
    penalties.p2[edges] =
        static_cast<std::int16_t>(std::lround(255.0 * options.p2 / divisors[edges]));
  }
  return penalties;
}

void checkSgmOptions(const SgmOptions& options) {
  if (!(options.p1 >= 0 && options.p1 <= options.p2)) {
    throw Error("The penalty p1 of semi-global matching is " + std::to_string(options.p1) +
                "; it must lie between 0 and p2, which is " + std::to_string(options.p2) + ".");
  }
  if (!(255.0 * options.p2 <= kMaxPathCost)) {
    throw Error("The penalty p2 of semi-global matching is " + std::to_string(options.p2) +
                "; it must be at most " + std::to_string(kMaxPathCost / 255.0) + ".");
  }
  if (!(options.q1 >= 1 && options.q2 >= 1 && options.alpha1 >= 1)) {
    throw Error("The divisors q1, q2 and alpha1 of semi-global matching are " +
                std::to_string(options.q1) + ", " + std::to_string(options.q2) + " and " +
                std::to_string(options.alpha1) + "; each must be at least 1.");
  }
}

int sgmCostBound(const SgmOptions& options) {
  const double bound = 255.0 + options.iterations * std::round(255.0 * options.p2);
  return static_cast<int>(std::min<double>(bound, std::numeric_limits<int>::max()));
}

}  // namespace cbmv
