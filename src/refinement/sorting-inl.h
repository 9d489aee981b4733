// Sorts vectors of disparities lane by lane. Compiled once per instruction set.
#if defined(CBMV_REFINEMENT_SORTING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_REFINEMENT_SORTING_INL_H
#undef CBMV_REFINEMENT_SORTING_INL_H
#else
#define CBMV_REFINEMENT_SORTING_INL_H
#endif

#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "refinement/padded_disparity.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kLongestVector>;

/// Swaps the lanes that are not in order.
template <class V>
HWY_INLINE void sortPair(V& low, V& high) {
  const V before = low;
  low = hn::Min(low, high);
  high = hn::Max(before, high);
}

/// Sorts eight aligned vectors that are adjacent in memory (Batcher's odd-even merge sort).
template <class D>
HWY_INLINE void sortEight(D tag, float* values) {
  const auto at = [=](int i) { return values + i * hn::Lanes(tag); };
  auto a = hn::Load(tag, at(0));
  auto b = hn::Load(tag, at(1));
  auto c = hn::Load(tag, at(2));
  auto d = hn::Load(tag, at(3));
  auto e = hn::Load(tag, at(4));
  auto f = hn::Load(tag, at(5));
  auto g = hn::Load(tag, at(6));
  auto h = hn::Load(tag, at(7));
  sortPair(a, b), sortPair(c, d), sortPair(e, f), sortPair(g, h);
  sortPair(a, c), sortPair(b, d), sortPair(e, g), sortPair(f, h);
  sortPair(b, c), sortPair(f, g);
  sortPair(a, e), sortPair(b, f), sortPair(c, g), sortPair(d, h);
  sortPair(c, e), sortPair(d, f);
  sortPair(b, c), sortPair(d, e), sortPair(f, g);
  hn::Store(a, tag, at(0));
  hn::Store(b, tag, at(1));
  hn::Store(c, tag, at(2));
  hn::Store(d, tag, at(3));
  hn::Store(e, tag, at(4));
  hn::Store(f, tag, at(5));
  hn::Store(g, tag, at(6));
  hn::Store(h, tag, at(7));
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
