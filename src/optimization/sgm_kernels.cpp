#include "optimization/sgm_kernels.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/sgm_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/cost_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

using PathTag = LineTag<PathCost>;
using SumTag = LineTag<std::uint16_t>;
using PathVector = hn::Vec<PathTag>;

/// How path costs are combined with the sums.
enum class Accumulation { kSet, kAdd, kAddAndAverage };

/// Combines the first `count` lanes. Sums after them are not read.
template <Accumulation accumulation>
HWY_INLINE hn::Vec<SumTag> accumulate(PathVector costs, [[maybe_unused]] const std::uint16_t* sums,
                                      [[maybe_unused]] int count) {
  const SumTag tag;
  const auto unsigned_costs = hn::BitCast(tag, costs);
  if constexpr (accumulation == Accumulation::kSet) {
    return unsigned_costs;
  } else {
    const auto sum = hn::Add(loadFirst(tag, sums, count), unsigned_costs);
    return accumulation == Accumulation::kAdd ? sum
                                              : hn::ShiftRight<2>(hn::Add(sum, hn::Set(tag, 2)));
  }
}

/// The recurrence (semi_global_matching.h) for one vector of hypotheses of a pixel.
template <typename Cost>
HWY_INLINE PathVector pathCosts(const Cost* costs, const PathCost* previous,
                                PathVector lowest_previous, const PathCost* p1,
                                const PathCost* p2) {
  const PathTag tag;
  const auto neighbors = hn::Min(hn::LoadU(tag, previous - 1), hn::LoadU(tag, previous + 1));
  const auto step = hn::Add(neighbors, hn::LoadU(tag, p1));
  const auto jump = hn::Add(lowest_previous, hn::LoadU(tag, p2));
  const auto best = hn::Min(hn::Min(hn::LoadU(tag, previous), step), jump);
  const auto matching = hn::BitCast(tag, loadWidened(SumTag(), costs));
  return hn::Add(matching, hn::Sub(best, lowest_previous));
}

/// Adds the pixel in `column` to a path. Returns the lowest of the new path costs in all lanes.
template <Accumulation accumulation, typename Cost>
HWY_INLINE PathVector extendPath(const PathPixels<Cost>& pixels, const RowPenalties& penalties,
                                 int column, const PathCost* previous, PathVector lowest_previous,
                                 PathCost* current) {
  const PathTag tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  const int disparities = pixels.disparities;
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(column) * disparities;
  const Cost* costs = pixels.costs + first;
  previous -= penalties.rises[column];
  std::uint16_t* sums = pixels.sums + first;
  const int edge = penalties.edges[column] != 0 ? 1 : 0;
  const PathCost* p1 = penalties.p1[edge] + column * penalties.step;
  const PathCost* p2 = penalties.p2[edge] + column * penalties.step;
  auto lowest = hn::Set(tag, kGuard);
  int h = 0;
  for (; h + lanes <= disparities; h += lanes) {
    const auto cost = pathCosts(costs + h, previous + h, lowest_previous, p1 + h, p2 + h);
    lowest = hn::Min(lowest, cost);
    hn::Store(cost, tag, current + h);
    hn::StoreU(accumulate<accumulation>(cost, sums + h, lanes), SumTag(), sums + h);
  }
  if (h < disparities) {
    const auto some = pathCosts(costs + h, previous + h, lowest_previous, p1 + h, p2 + h);
    const auto cost = hn::IfThenElse(hn::FirstN(tag, disparities - h), some, hn::Set(tag, kGuard));
    lowest = hn::Min(lowest, cost);
    hn::Store(cost, tag, current + h);
    const int rest = disparities - h;
    // Another thread may write the sums after the last column.
    const int readable = column + 1 < pixels.columns ? lanes : rest;
    storeFirst(SumTag(), accumulate<accumulation>(cost, sums + h, readable), rest, sums + h);
  }
  return hn::MinOfLanes(tag, lowest);
}

/// Processes one step of vertical paths.
template <Accumulation accumulation, typename Cost>
HWY_INLINE void extendColumns(const PathPixels<Cost> pixels, const RowPenalties penalties,
                              const PathEnds ends) {
  const PathTag tag;
  for (int i = 0; i < pixels.columns; ++i) {
    const auto lowest =
        extendPath<accumulation>(pixels, penalties, i, ends.previous + i * ends.stride,
                                 hn::Set(tag, ends.lowest[i]), ends.current + i * ends.stride);
    ends.lowest[i] = hn::GetLane(lowest);
  }
}

void addColumnsOfBytes(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                       const PathEnds& ends) {
  extendColumns<Accumulation::kAdd>(pixels, penalties, ends);
}
void addColumnsOfWords(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                       const PathEnds& ends) {
  extendColumns<Accumulation::kAdd>(pixels, penalties, ends);
}
void averageColumnsOfBytes(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                           const PathEnds& ends) {
  extendColumns<Accumulation::kAddAndAverage>(pixels, penalties, ends);
}
void averageColumnsOfWords(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                           const PathEnds& ends) {
  extendColumns<Accumulation::kAddAndAverage>(pixels, penalties, ends);
}

/// Processes both paths along a row together, because each has to wait for its previous pixel. The
/// path that reaches a pixel first sets its sums, the other path adds to them. Path 0 is from the
/// left, path 1 is from the right.
template <typename Cost>
HWY_INLINE void extendBothWays(const PathPixels<Cost> pixels, const RowPenalties from_left,
                               const RowPenalties from_right, const PathEnds ends) {
  auto* previous = ends.previous;
  auto* current = ends.current;
  auto left = hn::Zero(PathTag());
  auto right = left;
  const int last = pixels.columns - 1;
  const auto extend = [&](auto set_left, auto set_right, int i) {
    left = extendPath<set_left()>(pixels, from_left, i, previous, left, current);
    right = extendPath<set_right()>(pixels, from_right, last - i, previous + ends.stride, right,
                                    current + ends.stride);
    std::swap(previous, current);
  };
  const std::integral_constant<Accumulation, Accumulation::kSet> set;
  const std::integral_constant<Accumulation, Accumulation::kAdd> add;
  int i = 0;
  for (; 2 * i < last; ++i) {
    extend(set, set, i);
  }
  if (2 * i == last) {
    extend(set, add, i++);
  }
  for (; i <= last; ++i) {
    extend(add, add, i);
  }
}

void setRowOfBytes(const PathPixels<std::uint8_t>& pixels, const RowPenalties& from_left,
                   const RowPenalties& from_right, const PathEnds& ends) {
  extendBothWays(pixels, from_left, from_right, ends);
}
void setRowOfWords(const PathPixels<std::uint16_t>& pixels, const RowPenalties& from_left,
                   const RowPenalties& from_right, const PathEnds& ends) {
  extendBothWays(pixels, from_left, from_right, ends);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(addColumnsOfBytes);
HWY_EXPORT(addColumnsOfWords);
HWY_EXPORT(averageColumnsOfBytes);
HWY_EXPORT(averageColumnsOfWords);
HWY_EXPORT(setRowOfBytes);
HWY_EXPORT(setRowOfWords);

}  // namespace

void addColumns(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(addColumnsOfBytes)(pixels, penalties, ends);
}
void addColumns(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(addColumnsOfWords)(pixels, penalties, ends);
}
void averageColumns(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                    const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(averageColumnsOfBytes)(pixels, penalties, ends);
}
void averageColumns(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                    const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(averageColumnsOfWords)(pixels, penalties, ends);
}
void setRow(const PathPixels<std::uint8_t>& pixels, const RowPenalties& from_left,
            const RowPenalties& from_right, const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(setRowOfBytes)(pixels, from_left, from_right, ends);
}
void setRow(const PathPixels<std::uint16_t>& pixels, const RowPenalties& from_left,
            const RowPenalties& from_right, const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(setRowOfWords)(pixels, from_left, from_right, ends);
}

}  // namespace cbmv
#endif  // HWY_ONCE
