// Helpers for vector code: loops over the columns of a row, loads and stores at its end. Included
// once per instruction set.
#if defined(CBMV_SIMD_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_SIMD_LANES_INL_H
#undef CBMV_SIMD_LANES_INL_H
#else
#define CBMV_SIMD_LANES_INL_H
#endif

#include <algorithm>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

/// Calls f(d, x, done) for vectors at x that together cover the columns [begin, end) exactly. The
/// last vector ends at `end`, so its first `done` lanes overlap the vector before. f must give the
/// same result when it is called twice for a column. In spans narrower than a vector, d has fewer
/// lanes: the largest power of two that fits.
template <class D, class F>
HWY_INLINE void forLanes(D d, int begin, int end, const F& f) {
  namespace hn = hwy::HWY_NAMESPACE;
  const int lanes = static_cast<int>(hn::Lanes(d));
  if (end - begin >= lanes) {
    for (int next = begin; next < end; next += lanes) {
      const int x = std::min(next, end - lanes);
      f(d, x, next - x);
    }
  } else if constexpr (hn::MaxLanes(D()) > 1) {
    if (begin < end) {
      forLanes(hn::CappedTag<hn::TFromD<D>, hn::MaxLanes(D()) / 2>(), begin, end, f);
    }
  }
}

/// The lanes are first, first + 1, … If `first` is not a constant, Iota would go lane by lane
/// through memory.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> countFrom(D tag, hwy::HWY_NAMESPACE::TFromD<D> first) {
  namespace hn = hwy::HWY_NAMESPACE;
  return hn::Add(hn::Iota(tag, 0), hn::Set(tag, first));
}

/// Loads the first `count` lanes, at most all. The other lanes are 0. Memory beyond is not read,
/// because another thread may write it. For vectors of at most one cache line.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> loadFirst(D tag, const hwy::HWY_NAMESPACE::TFromD<D>* values,
                                                int count) {
  namespace hn = hwy::HWY_NAMESPACE;
  if (count >= static_cast<int>(hn::Lanes(tag))) {
    return hn::LoadU(tag, values);
  }
  HWY_ALIGN hn::TFromD<D> lanes[64 / sizeof(hn::TFromD<D>)] = {};
  hn::SafeCopyN(count, tag, values, lanes);
  return hn::Load(tag, lanes);
}

/// Stores the first `count` lanes, at most all, none if `count` ≤ 0. Memory beyond is not written,
/// because it may belong to another thread. For vectors of at most one cache line.
template <class D>
HWY_INLINE void storeFirst(D tag, hwy::HWY_NAMESPACE::Vec<D> values, int count,
                           hwy::HWY_NAMESPACE::TFromD<D>* out) {
  namespace hn = hwy::HWY_NAMESPACE;
  if (count >= static_cast<int>(hn::Lanes(tag))) {
    hn::StoreU(values, tag, out);
  } else {
    HWY_ALIGN hn::TFromD<D> lanes[64 / sizeof(hn::TFromD<D>)];
    hn::Store(values, tag, lanes);
    hn::SafeCopyN(std::max(count, 0), tag, lanes, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif
