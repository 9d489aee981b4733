// Loads and stores of costs, compiled once per instruction set.
#if defined(CBMV_OPTIMIZATION_COST_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_OPTIMIZATION_COST_VECTORS_INL_H
#undef CBMV_OPTIMIZATION_COST_VECTORS_INL_H
#else
#define CBMV_OPTIMIZATION_COST_VECTORS_INL_H
#endif

#include <algorithm>
#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// As many lanes as a cache line holds, or fewer.
template <typename Value>
using LineTag = hn::CappedTag<Value, 64 / sizeof(Value)>;

/// Values, or narrower ones widened, from any address.
template <class Tag, typename Value>
HWY_INLINE hn::Vec<Tag> loadWidened(Tag tag, const Value* values) {
  if constexpr (sizeof(Value) == sizeof(hn::TFromD<Tag>)) {
    return hn::LoadU(tag, values);
  } else {
    return hn::PromoteTo(tag, hn::LoadU(hn::Rebind<Value, Tag>(), values));
  }
}

/// Stores the first `count` lanes, all if there are fewer, none if it is not positive, and leaves
/// the memory behind alone: it may belong to another thread.
template <class Tag>
HWY_INLINE void storeFirst(Tag tag, hn::Vec<Tag> values, int count, hn::TFromD<Tag>* out) {
  if (count >= static_cast<int>(hn::Lanes(tag))) {
    hn::StoreU(values, tag, out);
  } else {
    HWY_ALIGN hn::TFromD<Tag> lanes[64 / sizeof(hn::TFromD<Tag>)];
    hn::Store(values, tag, lanes);
    hn::SafeCopyN(std::max(count, 0), tag, lanes, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
