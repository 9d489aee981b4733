// Moves between the lanes of a vector of path costs, compiled once per instruction set.
#if defined(CBMV_OPTIMIZATION_WINDOWED_SGM_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_OPTIMIZATION_WINDOWED_SGM_LANES_INL_H
#undef CBMV_OPTIMIZATION_WINDOWED_SGM_LANES_INL_H
#else
#define CBMV_OPTIMIZATION_WINDOWED_SGM_LANES_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_HAVE_SCALABLE

template <class D, class V>
HWY_INLINE V lowestOfLanes(D tag, V values) {
  return hn::MinOfLanes(tag, values);
}

#else

/// 128-bit blocks moved to the next higher or lower place, all around.
template <class D, class V>
HWY_INLINE V blocksUp([[maybe_unused]] D tag, V values) {
  if constexpr (hn::MaxLanes(D()) == 32) {
    const hn::Repartition<std::uint64_t, D> tag64;
    alignas(64) constexpr std::int64_t kSources[8] = {6, 7, 0, 1, 2, 3, 4, 5};
    return hn::BitCast(tag, hn::TableLookupLanes(hn::BitCast(tag64, values),
                                                 hn::SetTableIndices(tag64, kSources)));
  } else if constexpr (hn::MaxLanes(D()) == 16) {
    return hn::ReverseBlocks(tag, values);
  } else {
    return values;
  }
}
template <class D, class V>
HWY_INLINE V blocksDown(D tag, V values) {
  if constexpr (hn::MaxLanes(D()) == 32) {
    const hn::Repartition<std::uint64_t, D> tag64;
    alignas(64) constexpr std::int64_t kSources[8] = {2, 3, 4, 5, 6, 7, 0, 1};
    return hn::BitCast(tag, hn::TableLookupLanes(hn::BitCast(tag64, values),
                                                 hn::SetTableIndices(tag64, kSources)));
  } else {
    return blocksUp(tag, values);
  }
}

/// Every lane to the next higher or lower place, all around.
template <class D, class V>
HWY_INLINE V rotateUp(D tag, V values) {
  return hn::CombineShiftRightBytes<14>(tag, values, blocksUp(tag, values));
}
template <class D, class V>
HWY_INLINE V rotateDown(D tag, V values) {
  return hn::CombineShiftRightBytes<2>(tag, blocksDown(tag, values), values);
}

/// In all lanes.
template <class D, class V>
HWY_INLINE V lowestOfLanes(D tag, V values) {
  const hn::Repartition<std::uint32_t, D> tag32;
  if constexpr (hn::MaxLanes(D()) == 32) {
    values = hn::Min(values, hn::ConcatLowerUpper(tag, values, values));
  }
  if constexpr (hn::MaxLanes(D()) >= 16) {
    values = hn::Min(values, hn::ReverseBlocks(tag, values));
  }
  values = hn::Min(values, hn::BitCast(tag, hn::Shuffle1032(hn::BitCast(tag32, values))));
  values = hn::Min(values, hn::BitCast(tag, hn::Shuffle2301(hn::BitCast(tag32, values))));
  return hn::Min(values, hn::Reverse2(tag, values));
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
