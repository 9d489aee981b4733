// Loop over the columns of a row and the end of a row for vector code. Included once per
// instruction set.
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

/// Calls f(d, x, done) so that the vectors from x on cover the columns [begin, end) and nothing
/// else. The last vector begins early enough to end at `end`: its first `done` lanes were in a call
/// before, which makes no difference to an f that only writes what it computes. In spans narrower
/// than a vector, d has fewer lanes: the largest power of two that fits.
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

/// first, first + 1, …; where `first` is no constant, Iota goes lane by lane through memory.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> countFrom(D tag, hwy::HWY_NAMESPACE::TFromD<D> first) {
  namespace hn = hwy::HWY_NAMESPACE;
  return hn::Add(hn::Iota(tag, 0), hn::Set(tag, first));
}

/// The first `count` lanes, all if there are fewer; the others are 0. The memory behind is not
/// read: another thread may be writing it. Of vectors up to a cache line.
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

/// Stores the first `count` lanes, all if there are fewer, none if it is not positive, and leaves
/// the memory behind alone: it may belong to another thread. Of vectors up to a cache line.
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
