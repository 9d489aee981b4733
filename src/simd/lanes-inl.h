// Loop over the columns of a row for vector code. Included once per instruction set.
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
/// than a vector, d has one lane.
template <class D, class F>
HWY_INLINE void forLanes(D d, int begin, int end, const F& f) {
  namespace hn = hwy::HWY_NAMESPACE;
  const int lanes = static_cast<int>(hn::Lanes(d));
  if (end - begin >= lanes) {
    for (int next = begin; next < end; next += lanes) {
      const int x = std::min(next, end - lanes);
      f(d, x, next - x);
    }
  } else {
    for (int x = begin; x < end; ++x) {
      f(hn::CappedTag<hn::TFromD<D>, 1>(), x, 0);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif
