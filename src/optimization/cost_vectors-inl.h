// Loads and stores of costs. Compiled once per instruction set.
#if defined(CBMV_OPTIMIZATION_COST_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_OPTIMIZATION_COST_VECTORS_INL_H
#undef CBMV_OPTIMIZATION_COST_VECTORS_INL_H
#else
#define CBMV_OPTIMIZATION_COST_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// At most as many lanes as a cache line holds.
template <typename Value>
using LineTag = hn::CappedTag<Value, 64 / sizeof(Value)>;

/// Loads values from any address. Narrower values are widened.
template <class Tag, typename Value>
HWY_INLINE hn::Vec<Tag> loadWidened(Tag tag, const Value* values) {
  if constexpr (sizeof(Value) == sizeof(hn::TFromD<Tag>)) {
    return hn::LoadU(tag, values);
  } else {
    return hn::PromoteTo(tag, hn::LoadU(hn::Rebind<Value, Tag>(), values));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
