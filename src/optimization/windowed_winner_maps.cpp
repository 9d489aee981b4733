#include "optimization/windowed_winner_maps.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <hwy/cache_control.h>
#include <tbb/parallel_for.h>

#ifndef CBMV_WINDOWED_WINNER_MAPS_ONCE
#define CBMV_WINDOWED_WINNER_MAPS_ONCE
namespace cbmv {
namespace {

/// Place in the list for pixels without a winner.
constexpr std::uint16_t kNone = 0xffff;
/// Set in the place of an entry if the previous and next disparity are adjacent to it in the list.
constexpr std::uint16_t kHasNeighbors = 0x8000;
constexpr std::uint16_t kPlaceMask = 0x7fff;
/// Number of tiles between prefetching the matching costs of a tile's winners and using them.
constexpr int kTilesAhead = 4;

/// A tile, its columns and their matches.
struct TileColumns {
  SearchSpace::Tile tile;
  DisparityRange range;
  int x;      ///< first column
  int count;  ///< columns inside of the image
  int width;  ///< image width

  /// The place of entry k, in the format of TileWinners.
  std::uint16_t placeOf(int k) const {
    const std::int16_t* index = tile.indices + k;
    const bool has_neighbors =
        k > 0 && k + 1 < tile.count && index[-1] + 1 == index[0] && index[0] + 1 == index[1];
    return static_cast<std::uint16_t>(has_neighbors ? k | kHasNeighbors : k);
  }

  /// Returns whether the disparity of entry k is one more than that of the previous entry.
  bool followsOn(int k) const { return k > 0 && tile.indices[k - 1] + 1 == tile.indices[k]; }

  /// Entries [start, end) for which the matches of all columns [begin, end) of the tile are inside.
  cv::Range wholeEntries(int begin, int end) const {
    const int lowest = x + end - width - range.min;
    const int highest = x + begin - range.min;
    cv::Range whole(0, tile.count);  // the most frequent case
    while (!whole.empty() && tile.indices[whole.start] < lowest) {
      ++whole.start;
    }
    while (!whole.empty() && tile.indices[whole.end - 1] > highest) {
      --whole.end;
    }
    return whole;
  }
  /// Columns [start, end) whose match is inside at the disparity of entry k, not limited to the
  /// tile.
  cv::Range insideAt(int k) const {
    const int first = range.min + tile.indices[k] - x;
    return {first, first + width};
  }
};

/// The winners of the columns of a tile.
struct TileWinners {
  alignas(64) std::uint16_t places[kTileColumns];  ///< in the tile's list; kNone: no winner
  alignas(64) std::uint16_t lowest[kTileColumns];  ///< costs
  alignas(64) std::uint16_t before[kTileColumns];  ///< costs of the entries adjacent to the winners
  alignas(64) std::uint16_t after[kTileColumns];
  alignas(64) std::uint16_t margins[kTileColumns];
  alignas(64) std::int32_t disparities[kTileColumns];
  alignas(64) std::int32_t matching_costs[kTileColumns];
};

/// One row of the output.
struct RowMaps {
  float* winners;
  float* disparity;
  float* confidence;
  std::uint16_t* margin;
};

/// Sets disparities and matching costs of the winners from their places. Columns beyond the image
/// have unspecified costs and places, so they are skipped.
inline void lookUp(const TileColumns& columns, const std::uint8_t* matching_costs,
                   TileWinners& winners) {
  for (int c = 0; c < columns.count; ++c) {
    const std::uint16_t place = winners.places[c];
    const int k = place & kPlaceMask;
    winners.disparities[c] = columns.range.min + (place == kNone ? -1 : columns.tile.indices[k]);
    winners.matching_costs[c] = place == kNone ? 255 : matching_costs[k * kTileColumns + c];
  }
}

/// Prefetches the matching costs of the winners, which can be anywhere in a long list.
inline void fetch(const TileColumns& columns, const std::uint8_t* matching_costs,
                  const TileWinners& winners) {
  for (int c = 0; c < columns.count; ++c) {
    const std::uint16_t place = winners.places[c];
    hwy::Prefetch(matching_costs + (place == kNone ? 0 : place & kPlaceMask) * kTileColumns);
  }
}

}  // namespace
}  // namespace cbmv
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/windowed_winner_maps.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/cost_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

using CostTag = hn::CappedTag<std::uint16_t, kTileColumns>;
using FloatTag = hn::CappedTag<float, kTileColumns>;
using IntTag = hn::RebindToSigned<FloatTag>;

/// Columns from `begin` on whose match is outside at the disparity of entry k.
HWY_INLINE hn::Mask<CostTag> areOutside(const TileColumns& columns, int k, int begin) {
  const CostTag tag;
  const cv::Range inside = columns.insideAt(k) - begin;
  return hn::Or(hn::FirstN(tag, std::max(inside.start, 0)),
                hn::Not(hn::FirstN(tag, std::max(inside.end, 0))));
}

/// Finds places, costs and margins of the winners for one vector of columns from `begin` on.
/// `costs` are the costs of the first entry.
HWY_INLINE void findWinners(const TileColumns& columns, const std::uint16_t* costs, int begin,
                            TileWinners& winners) {
  const CostTag tag;
  const int count = std::min(static_cast<int>(hn::Lanes(tag)), columns.count - begin);
  auto places = hn::Set(tag, kNone);
  auto lowest = hn::Set(tag, 0xffff);
  auto before = hn::Zero(tag);
  auto after = hn::Zero(tag);
  auto last = hn::Zero(tag);
  auto second = hn::Set(tag, kNoMargin);      // lowest cost more than 1 px away from the winner
  auto far_lowest = hn::Set(tag, kNoMargin);  // lowest cost more than 1 px below the current entry
  const auto all = hn::FirstN(tag, kTileColumns);
  auto stayed = all;  // columns whose winner is not the last entry
  const cv::Range whole = columns.wholeEntries(begin, begin + count);
  for (int k = 0; k < columns.tile.count; ++k) {
    const auto cost = hn::LoadU(tag, costs + static_cast<std::ptrdiff_t>(k) * kTileColumns + begin);
    const auto lower = hn::Min(lowest, cost);
    if (!columns.followsOn(k)) {  // the previous entry is more than 1 px away
      stayed = all;
      far_lowest = lowest;
    }
    after = hn::IfThenElse(stayed, after, cost);
    auto rest = hn::IfThenElse(stayed, hn::Min(second, cost), second);
    stayed = hn::Eq(lower, lowest);
    if (k <= whole.start || k >= whole.end) {
      const auto is_outside = areOutside(columns, k, begin);
      const auto has_winner = hn::Ne(places, hn::Set(tag, kNone));
      stayed = hn::Or(is_outside, hn::And(stayed, has_winner));
      rest = hn::IfThenElse(is_outside, second, rest);
    }
    second = hn::IfThenElse(stayed, rest, far_lowest);
    far_lowest = lowest;
    lowest = hn::IfThenElse(stayed, lowest, lower);
    places = hn::IfThenElse(stayed, places, hn::Set(tag, columns.placeOf(k)));
    before = hn::IfThenElse(stayed, before, last);
    last = cost;
  }
  hn::Store(places, tag, winners.places + begin);
  hn::Store(lowest, tag, winners.lowest + begin);
  hn::Store(before, tag, winners.before + begin);
  hn::Store(after, tag, winners.after + begin);
  const auto has_margin = hn::Ne(second, hn::Set(tag, kNoMargin));
  hn::Store(hn::IfThenElse(has_margin, hn::Sub(second, lowest), second), tag,
            winners.margins + begin);
}

/// Minimum of the parabola through the costs of the winners and their neighbors, relative to the
/// winners. 0 where they have no strict minimum at the winner.
HWY_INLINE hn::Vec<FloatTag> parabolaMinimum(const TileWinners& winners, int c) {
  const IntTag tag;
  const FloatTag float_tag;
  const auto before = loadWidened(tag, winners.before + c);
  const auto here = loadWidened(tag, winners.lowest + c);
  const auto after = loadWidened(tag, winners.after + c);
  const auto curvature = hn::Sub(hn::Add(before, after), hn::Add(here, here));
  const auto is_minimum = hn::And(hn::Eq(here, hn::Min(here, hn::Min(before, after))),
                                  hn::Ne(curvature, hn::Zero(tag)));
  const auto slope = hn::ConvertTo(float_tag, hn::Sub(before, after));
  const auto twice_curvature = hn::ConvertTo(float_tag, hn::Add(curvature, curvature));
  return hn::IfThenElseZero(hn::RebindMask(float_tag, is_minimum), hn::Div(slope, twice_curvature));
}

/// Lanes where d − 1 and d + 1 are in the list and their matches are inside.
HWY_INLINE hn::Mask<FloatTag> canBeRefined(const TileColumns& columns, const TileWinners& winners,
                                           int c) {
  const IntTag tag;
  const auto match = hn::Sub(countFrom(tag, columns.x + c), hn::Load(tag, winners.disparities + c));
  const auto are_inside =
      hn::And(hn::Gt(match, hn::Zero(tag)), hn::Lt(match, hn::Set(tag, columns.width - 1)));
  const auto places = loadWidened(tag, winners.places + c);
  const auto have_neighbors =
      hn::And(hn::Gt(places, hn::Set(tag, kHasNeighbors)), hn::Ne(places, hn::Set(tag, kNone)));
  return hn::RebindMask(FloatTag(), hn::And(are_inside, have_neighbors));
}

HWY_INLINE void storeTile(const TileColumns& columns, const TileWinners& winners, bool subpixel,
                          const RowMaps& out) {
  const FloatTag tag;
  for (int c = 0; c < columns.count; c += static_cast<int>(hn::Lanes(tag))) {
    const auto whole = hn::ConvertTo(tag, hn::Load(IntTag(), winners.disparities + c));
    const auto cost = hn::ConvertTo(tag, hn::Load(IntTag(), winners.matching_costs + c));
    const auto confidence = hn::Sub(hn::Set(tag, 1.0F), hn::Div(cost, hn::Set(tag, 255.0F)));
    auto refined = whole;
    if (subpixel) {
      const auto refinable = canBeRefined(columns, winners, c);
      refined = hn::Add(whole, hn::IfThenElseZero(refinable, parabolaMinimum(winners, c)));
    }
    const int count = columns.count - c;
    storeFirst(tag, whole, count, out.winners + columns.x + c);
    storeFirst(tag, refined, count, out.disparity + columns.x + c);
    storeFirst(tag, confidence, count, out.confidence + columns.x + c);
  }
  std::copy_n(winners.margins, columns.count, out.margin + columns.x);
}

void mapRow(const SearchSpace& space, const WindowedAggregatedVolume& costs,
            const WindowedMatchingVolume& matching_costs, bool subpixel, int y,
            const RowMaps& out) {
  std::array<TileWinners, kTilesAhead> winners;
  const auto columns_of = [&](int t) {
    const int x = t * kTileColumns;
    return TileColumns{space.tile(y, t), space.range(), x,
                       std::min(kTileColumns, space.width() - x), space.width()};
  };
  for (int t = 0; t < space.tiles() + kTilesAhead - 1; ++t) {
    if (t < space.tiles()) {
      const TileColumns columns = columns_of(t);
      const std::size_t first = columns.tile.first_entry;
      TileWinners& these = winners[t % kTilesAhead];
      for (int c = 0; c < kTileColumns; c += static_cast<int>(hn::Lanes(CostTag()))) {
        findWinners(columns, costs.entry(first), c, these);
      }
      fetch(columns, matching_costs.entry(first), these);
    }
    if (const int ready = t - kTilesAhead + 1; ready >= 0) {
      const TileColumns columns = columns_of(ready);
      TileWinners& these = winners[ready % kTilesAhead];
      lookUp(columns, matching_costs.entry(columns.tile.first_entry), these);
      storeTile(columns, these, subpixel, out);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(mapRow);

}  // namespace

void windowedWinnerMaps(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                        const WindowedMatchingVolume& matching_costs, bool subpixel,
                        const WinnerMaps& maps) {
  CV_Assert(costs.entries() == space.entries() && matching_costs.entries() == space.entries());
  for (cv::Mat* map : {&maps.winners, &maps.disparity, &maps.confidence}) {
    map->create(space.height(), space.width(), CV_32FC1);
  }
  maps.margin.create(space.height(), space.width(), CV_16UC1);
  tbb::parallel_for(0, space.height(), [&](int y) {
    const RowMaps out{maps.winners.ptr<float>(y), maps.disparity.ptr<float>(y),
                      maps.confidence.ptr<float>(y), maps.margin.ptr<std::uint16_t>(y)};
    HWY_DYNAMIC_DISPATCH(mapRow)(space, costs, matching_costs, subpixel, y, out);
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
