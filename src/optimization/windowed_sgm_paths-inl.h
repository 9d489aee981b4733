// The SGM recurrence for a vector of hypotheses. Compiled once per instruction set.
#if defined(CBMV_OPTIMIZATION_WINDOWED_SGM_PATHS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_OPTIMIZATION_WINDOWED_SGM_PATHS_INL_H
#undef CBMV_OPTIMIZATION_WINDOWED_SGM_PATHS_INL_H
#else
#define CBMV_OPTIMIZATION_WINDOWED_SGM_PATHS_INL_H
#endif

#include <hwy/highway.h>

#include "optimization/cost_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

/// L(p, d) from C(p, d) and three costs of the predecessor q: `along` is L(q, e), `beside` is the
/// lower of L(q, e − 1) and L(q, e + 1), `lowest` is the lowest cost of q. Hypotheses that q does
/// not have are kNoPath.
template <class V>
HWY_INLINE V pathCosts(V matching, V along, V beside, V lowest, V p1, V p2) {
  const auto step = hn::SaturatedAdd(beside, p1);
  const auto jump = hn::Add(lowest, p2);
  const auto best = hn::Min(hn::Min(along, step), jump);
  return hn::SaturatedAdd(matching, hn::Sub(best, lowest));
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
