#include "cbmv_stereo/optimization/windowed_aggregation.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include <tbb/parallel_for.h>

#include "optimization/windowed_aggregation_rows.h"

#include "cbmv_stereo/volume/per_thread.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/windowed_aggregation.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/cost_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

/// Bit of a Sum from which on it holds the number of pixels.
template <typename Sum>
constexpr int kPixelsShift = sizeof(Sum) == 4 ? 22 : 32;

/// As many lanes as a tile has columns, or fewer.
template <typename Value>
using TileTag = hn::CappedTag<Value, kTileColumns>;

void splitArms(const ArmRow& row, const std::array<std::uint8_t*, 2>& planes) {
  const int begin = std::clamp(-row.first_column, 0, row.columns);
  const int end = std::clamp(row.image_width - row.first_column, begin, row.columns);
  for (std::uint8_t* plane : planes) {
    std::fill_n(plane, begin, std::uint8_t{0});
    std::fill(plane + end, plane + row.columns, std::uint8_t{0});
  }
  forLanes(hn::ScalableTag<std::int32_t>(), begin, end, [&](auto tag, int x, int /*done*/) {
    const hn::Rebind<std::uint8_t, decltype(tag)> byte;
    const hn::Repartition<std::uint8_t, decltype(tag)> channels;
    const auto low = hn::Set(tag, 255);
    auto arms = hn::BitCast(tag, hn::LoadU(channels, row.arms + 4 * (row.first_column + x)));
    arms = row.vertical ? hn::ShiftRight<16>(arms) : arms;
    hn::StoreU(hn::DemoteTo(byte, hn::And(arms, low)), byte, planes[0] + x);
    hn::StoreU(hn::DemoteTo(byte, hn::And(hn::ShiftRight<8>(arms), low)), byte, planes[1] + x);
  });
}

/// Every arm of a plane with the one that lies `step` further.
void pairArms(const std::uint8_t* plane, int columns, int step, std::uint8_t* pairs) {
  forLanes(hn::ScalableTag<std::uint8_t>(), std::max(-step, 0), columns - std::max(step, 0),
           [&](auto tag, int x, int /*done*/) {
             hn::StoreInterleaved2(hn::LoadU(tag, plane + x), hn::LoadU(tag, plane + x + step), tag,
                                   pairs + 2 * x);
           });
}

/// Bytes to lanes of any width.
template <class Tag, class Bytes>
HWY_INLINE hn::Vec<Tag> widen(Tag tag, Bytes bytes) {
  if constexpr (sizeof(hn::TFromD<Tag>) == 8) {
    return hn::PromoteTo(tag, hn::PromoteTo(hn::Rebind<std::int32_t, Tag>(), bytes));
  } else {
    return hn::PromoteTo(tag, bytes);
  }
}

/// Lanes whose arm holds at least `length` pixels.
template <class Tag, class ArmVector>
HWY_INLINE hn::Mask<Tag> reaches(Tag /*tag*/, ArmVector arms, int length) {
  return hn::RebindMask(Tag(), hn::Gt(arms, hn::Set(hn::RebindToSigned<Tag>(), length - 1)));
}

/// Adds the values in the lanes of the mask.
template <class Tag>
HWY_INLINE hn::Vec<Tag> addWhere(Tag /*tag*/, hn::Mask<Tag> mask, hn::Vec<Tag> sums,
                                 hn::Vec<Tag> values) {
#if HWY_CAP_GE512
  return hn::IfThenElse(mask, hn::Add(sums, values), sums);  // one instruction
#else
  return hn::Add(sums, hn::IfThenElseZero(mask, values));
#endif
}

/// Largest of `count` bytes, 16 or 32.
HWY_INLINE int largest(const std::uint8_t* first, const std::uint8_t* second, int count) {
  const TileTag<std::uint8_t> tag;
  auto values = hn::Zero(tag);
  for (int i = 0; i < count; i += kTileColumns) {
    values = hn::Max(values, hn::Max(hn::LoadU(tag, first + i), hn::LoadU(tag, second + i)));
  }
  values = hn::Max(values, hn::ShiftRightBytes<8>(tag, values));
  values = hn::Max(values, hn::ShiftRightBytes<4>(tag, values));
  values = hn::Max(values, hn::ShiftRightBytes<2>(tag, values));
  values = hn::Max(values, hn::ShiftRightBytes<1>(tag, values));
  return hn::GetLane(values);
}

/// Calls f(length), with usual lengths of arms as constants, so that its loops are unrolled.
template <typename F>
HWY_INLINE void withConstant(int length, const F& f) {
  switch (length) {
    case 0:
      return f(std::integral_constant<int, 0>());
    case 1:
      return f(std::integral_constant<int, 1>());
    case 2:
      return f(std::integral_constant<int, 2>());
    case 3:
      return f(std::integral_constant<int, 3>());
    case 4:
      return f(std::integral_constant<int, 4>());
    case 5:
      return f(std::integral_constant<int, 5>());
    default:
      return f(length);
  }
}

/// Hypotheses of a tile at an even index and the next one, one of which may be missing.
struct Pair {
  int index;  ///< the even one
  bool has_even;
  bool has_odd;
  int first;  ///< in the list
  int last;
};

/// Calls f(pair) for every pair of a list.
template <typename F>
HWY_INLINE void forPairs(const SearchSpace::Tile& list, int first_index, const F& f) {
  for (int j = 0; j < list.count;) {
    const int index = list.indices[j] - first_index;
    const int next = list.indices[std::min(j + 1, list.count - 1)] - first_index;
    const bool odd = (index & 1) != 0;
    const int both = !odd & (next == index + 1) ? 1 : 0;
    f(Pair{index - (odd ? 1 : 0), !odd, odd || both, j, j + both});
    j += 1 + both;
  }
}

/// Lays the costs of the lists out in pairs, contiguous along the row. A missing cost of a pair may
/// be anything: no arm reaches it.
template <typename Cost, typename Lane, typename Sum>
HWY_INLINE void layCosts(const BlockRowToSum<Cost, Lane, Sum>& row) {
  const TileTag<Sum> tag;
  const hn::Rebind<Lane, decltype(tag)> narrow;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  const BlockShape& shape = row.shape;
  const int tiles = shape.tilesWithMargins();
  std::fill_n(row.present, 2 * tiles * shape.pairs(), std::uint8_t{0});
  for (int t = 0; t < tiles; ++t) {
    const Cost* costs = row.costs + row.lists[t].first_entry * kTileColumns;
    std::uint8_t* present = row.present + 2 * t * shape.pairs();
    Sum* line = row.line + t * kTileColumns;
    forPairs(row.lists[t], shape.first_index, [&](const Pair& pair) {
      present[pair.index] = pair.has_even ? 255 : 0;
      present[pair.index + 1] = pair.has_odd ? 255 : 0;
      Sum* out = line + pair.index / 2 * tiles * kTileColumns;
      for (int x = 0; x < kTileColumns; x += lanes) {
        const auto load = [&](int j) {
          return hn::PromoteTo(tag, loadWidened(narrow, costs + j * kTileColumns + x));
        };
        const auto odd = hn::ShiftLeft<8 * sizeof(Lane)>(load(pair.last));
        hn::Store(hn::Or(load(pair.first), odd), tag, out + x);
      }
    });
    if (t < shape.margin || t >= tiles - shape.margin) {  // sumTile fetches the others
      const Cost* next = row.costs + row.next_lists[t].first_entry * kTileColumns;
      for (int j = 0; j < row.lists[t].count; j += 2) {
        hwy::Prefetch(next + j * kTileColumns);
      }
    }
  }
}

/// Number of columns, at most 255, that have the hypothesis without a gap from the far end of each
/// tile to the left, or to the right.
template <typename Cost, typename Lane, typename Sum>
HWY_INLINE void measureReach(const BlockRowToSum<Cost, Lane, Sum>& row) {
  const int tiles = row.shape.tilesWithMargins();
  const int count = 2 * row.shape.pairs();
  const auto measure = [&](int t, int farther, std::uint8_t* reach) {
    const bool ends = farther < 0 || farther == tiles;
    for (int i = 0; i < count; ++i) {
      const int beyond = ends ? 0 : reach[farther * count + i];
      const int columns = row.present[t * count + i] != 0 ? beyond + kTileColumns : 0;
      reach[t * count + i] = static_cast<std::uint8_t>(std::min(columns, 255));
    }
  };
  for (int t = 0; t < tiles; ++t) {
    measure(t, t - 1, row.left_reach);
    measure(tiles - 1 - t, tiles - t, row.right_reach);
  }
}

/// The longest arms that the neighbouring tiles' `reach` allows: that far beyond the tile, from
/// its end `columns` away.
template <class Bytes>
HWY_INLINE hn::Vec<Bytes> limit(Bytes bytes, hn::Vec<Bytes> columns, const std::uint8_t* reach) {
  std::uint16_t pair;
  std::memcpy(&pair, reach, 2);
  const hn::Repartition<std::uint16_t, Bytes> pairs;
  return hn::SaturatedAdd(columns, hn::BitCast(bytes, hn::Set(pairs, pair)));
}

template <typename Cost, typename Lane, typename Sum, typename Length>
HWY_INLINE void sumTile(const BlockRowToSum<Cost, Lane, Sum>& row, int t, int first_lane,
                        Length longest) {
  const TileTag<Sum> tag;
  const hn::Repartition<Lane, decltype(tag)> lane;
  const hn::RebindToSigned<decltype(lane)> arm_tag;
  const hn::Rebind<std::uint8_t, decltype(lane)> byte;
  constexpr int kLaneBits = 8 * sizeof(Lane);
  const auto low = hn::Set(tag, static_cast<Lane>(-1));

  const BlockShape& shape = row.shape;
  const int x = t * kTileColumns + first_lane;
  const auto left_reference = hn::LoadU(byte, row.arms.reference[0] + 2 * x);
  const auto right_reference = hn::LoadU(byte, row.arms.reference[1] + 2 * x);
  const auto columns_left =
      hn::ShiftRight<1>(hn::Iota(byte, static_cast<std::uint8_t>(2 * first_lane)));
  const auto columns_right = hn::Sub(hn::Set(byte, kTileColumns - 1), columns_left);
  const int pitch = shape.tilesWithMargins() * kTileColumns;
  const int count = 2 * shape.pairs();
  const std::uint8_t* left_reach = row.left_reach + (t + shape.margin - 1) * count;
  const std::uint8_t* right_reach = row.right_reach + (t + shape.margin + 1) * count;
  const Sum* line = row.line + shape.margin * kTileColumns + x;
  Sum* sums = row.sums + t * shape.disparities * kTileColumns + first_lane;
  const SearchSpace::Tile& list = row.lists[t + shape.margin];
  const Cost* next = row.costs + row.next_lists[t + shape.margin].first_entry * kTileColumns;
  forPairs(list, shape.first_index, [&](const Pair& pair) {
    hwy::Prefetch(next + pair.first * kTileColumns);
    const int other = 2 * (x + pair.index * row.arms.other_step);
    const auto left =
        widen(arm_tag, hn::Min(hn::Min(left_reference, hn::LoadU(byte, row.arms.other[0] + other)),
                               limit(byte, columns_left, left_reach + pair.index)));
    const auto right =
        widen(arm_tag, hn::Min(hn::Min(right_reference, hn::LoadU(byte, row.arms.other[1] + other)),
                               limit(byte, columns_right, right_reach + pair.index)));
    const Sum* costs = line + pair.index / 2 * pitch;
    const auto load = [&](int k) { return hn::BitCast(lane, hn::LoadU(tag, costs + k)); };
    auto left_sum = load(0);
    auto right_sum = hn::Zero(lane);
    for (int k = 1; k <= longest; ++k) {
      left_sum = addWhere(lane, reaches(lane, left, k), left_sum, load(-k));
      right_sum = addWhere(lane, reaches(lane, right, k), right_sum, load(k));
    }
    const auto first = hn::BitCast(tag, left_sum);
    const auto second = hn::BitCast(tag, right_sum);
    const auto pixels = hn::BitCast(tag, hn::Add(hn::Add(left, right), hn::Set(arm_tag, 1)));
    // The number of the odd ones leaves the lane.
    const auto even = hn::Add(hn::Add(hn::And(first, low), hn::And(second, low)),
                              hn::ShiftLeft<kPixelsShift<Sum>>(pixels));
    const auto odd =
        hn::Add(hn::Add(hn::ShiftRight<kLaneBits>(first), hn::ShiftRight<kLaneBits>(second)),
                hn::ShiftLeft<kPixelsShift<Sum>>(hn::ShiftRight<kLaneBits>(pixels)));
    Sum* out = sums + pair.index * kTileColumns;
    hn::Store(even, tag, pair.has_even ? out : row.unused);
    hn::Store(odd, tag, pair.has_odd ? out + kTileColumns : row.unused);
  });
}

template <typename Sum>
HWY_INLINE void clearRow(const BlockRowToClear<Sum> row) {
  const TileTag<Sum> tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  for (int t = 0; t < row.shape.tiles; ++t) {
    if (row.replacing != nullptr &&
        row.replacing[t + row.shape.margin].count == row.shape.disparities) {
      continue;
    }
    const SearchSpace::Tile& list = row.lists[t + row.shape.margin];
    Sum* sums = row.sums + t * row.shape.disparities * kTileColumns;
    for (int j = 0; j < list.count; ++j) {
      Sum* out = sums + (list.indices[j] - row.shape.first_index) * kTileColumns;
      for (int x = 0; x < kTileColumns; x += lanes) {
        hn::Store(hn::Zero(tag), tag, out + x);
      }
    }
  }
}

void clearRow32(const BlockRowToClear<std::uint32_t>& row) { clearRow(row); }
void clearRow64(const BlockRowToClear<std::uint64_t>& row) { clearRow(row); }

template <typename Cost, typename Lane, typename Sum>
HWY_INLINE void sumRow(BlockRowToSum<Cost, Lane, Sum> row) {
  const auto lanes = static_cast<int>(hn::Lanes(TileTag<Sum>()));
  const auto sum_tile = [&](int t, auto longest) {
    for (int first_lane = 0; first_lane < kTileColumns; first_lane += lanes) {
      sumTile(row, t, first_lane, longest);
    }
  };
  layCosts(row);
  if constexpr (sizeof(Lane) == 2) {
    row.left_reach = row.right_reach = row.present;  // arms reach into the next tile at most
  } else {
    measureReach(row);
  }
  for (int t = 0; t < row.shape.tiles; ++t) {
    const int x = 2 * t * kTileColumns;
    const int longest =
        largest(row.arms.reference[0] + x, row.arms.reference[1] + x, 2 * kTileColumns);
    if constexpr (sizeof(Lane) == 2) {
      withConstant(longest, [&](auto constant) { sum_tile(t, constant); });
    } else {
      sum_tile(t, longest);
    }
  }
}

void sumRowOfBytes32(const BlockRowToSum<std::uint8_t, std::uint16_t, std::uint32_t>& row) {
  sumRow(row);
}
void sumRowOfBytes64(const BlockRowToSum<std::uint8_t, std::uint32_t, std::uint64_t>& row) {
  sumRow(row);
}
void sumRowOfWords32(const BlockRowToSum<std::uint16_t, std::uint16_t, std::uint32_t>& row) {
  sumRow(row);
}
void sumRowOfWords64(const BlockRowToSum<std::uint16_t, std::uint32_t, std::uint64_t>& row) {
  sumRow(row);
}

/// sum / pixels to the nearest integer, halves up, for means of at most 16383 over at most 225
/// pixels.
///
/// Exact: halves are exact in float, and the offset of an ulp takes them up; other quotients are at
/// least 1/450 away from a half, further than offset and rounding can lift them. Adding 2^23 rounds
/// to whole numbers and leaves them in the lower bits.
HWY_INLINE void storeMeans(TileTag<std::uint32_t> tag, hn::Vec<TileTag<std::uint32_t>> sums,
                           std::uint16_t* means) {
  constexpr int kShift = kPixelsShift<std::uint32_t>;
  const hn::RebindToSigned<decltype(tag)> integer;
  const hn::RebindToFloat<decltype(tag)> real;
  const hn::Rebind<std::uint16_t, decltype(tag)> narrow;
  const auto pixels = hn::BitCast(integer, hn::ShiftRight<kShift>(sums));
  const auto sum = hn::BitCast(integer, hn::And(sums, hn::Set(tag, (1U << kShift) - 1)));
  const auto quotient = hn::Div(hn::ConvertTo(real, sum), hn::ConvertTo(real, pixels));
  const auto above_half = hn::Add(quotient, hn::Set(real, 1.0F / 1024));
  const auto mean = hn::BitCast(tag, hn::Add(above_half, hn::Set(real, 8388608.0F)));
  hn::StoreU(hn::TruncateTo(narrow, mean), narrow, means);
}

/// In double, where the integers are exact up to 2^53.
HWY_INLINE void storeMeans(TileTag<std::uint64_t> tag, hn::Vec<TileTag<std::uint64_t>> sums,
                           std::uint16_t* means) {
  constexpr int kShift = kPixelsShift<std::uint64_t>;
  HWY_ALIGN std::uint64_t lanes[kTileColumns];
  hn::Store(sums, tag, lanes);
  for (int i = 0; i < static_cast<int>(hn::Lanes(tag)); ++i) {
    const auto pixels = static_cast<std::uint32_t>(lanes[i] >> kShift);
    const std::uint64_t sum = lanes[i] & ((std::uint64_t{1} << kShift) - 1);
    means[i] = static_cast<std::uint16_t>(static_cast<double>(sum + pixels / 2) / pixels);
  }
}

template <typename Sum, typename Length>
HWY_INLINE void averageTile(const BlockRowToAverage<Sum>& row, int t, int first_lane,
                            Length longest) {
  const TileTag<Sum> tag;
  const hn::RebindToSigned<decltype(tag)> arm_tag;
  const hn::Rebind<std::uint8_t, decltype(tag)> byte;
  const int x = t * kTileColumns + first_lane;
  const auto up_reference = hn::LoadU(byte, row.arms.reference[0] + x);
  const auto down_reference = hn::LoadU(byte, row.arms.reference[1] + x);
  const int first_sum = t * row.shape.disparities * kTileColumns + first_lane;
  const SearchSpace::Tile& list = row.lists[t + row.shape.margin];
  std::uint16_t* means = row.means + list.first_entry * kTileColumns + first_lane;
  for (int j = 0; j < list.count; ++j) {
    const int index = list.indices[j] - row.shape.first_index;
    const int other = x + index * row.arms.other_step;
    const auto up =
        widen(arm_tag, hn::Min(up_reference, hn::LoadU(byte, row.arms.other[0] + other)));
    const auto down =
        widen(arm_tag, hn::Min(down_reference, hn::LoadU(byte, row.arms.other[1] + other)));
    const int place = first_sum + index * kTileColumns;
    auto sums = hn::Load(tag, row.rows[0] + place);
    for (int k = 1; k <= longest; ++k) {
      sums = addWhere(tag, reaches(tag, up, k), sums, hn::Load(tag, row.rows[-k] + place));
      sums = addWhere(tag, reaches(tag, down, k), sums, hn::Load(tag, row.rows[k] + place));
    }
    storeMeans(tag, sums, means + j * kTileColumns);
  }
}

template <typename Sum>
HWY_INLINE void averageRow(const BlockRowToAverage<Sum> row) {
  const auto lanes = static_cast<int>(hn::Lanes(TileTag<Sum>()));
  const auto average_tile = [&](int t, auto longest) {
    for (int first_lane = 0; first_lane < kTileColumns; first_lane += lanes) {
      averageTile(row, t, first_lane, longest);
    }
  };
  for (int t = 0; t < row.shape.tiles; ++t) {
    const int x = t * kTileColumns;
    const int longest = largest(row.arms.reference[0] + x, row.arms.reference[1] + x, kTileColumns);
    if constexpr (sizeof(Sum) == 4) {
      withConstant(longest, [&](auto constant) { average_tile(t, constant); });
    } else {
      average_tile(t, longest);
    }
  }
}

void averageRow32(const BlockRowToAverage<std::uint32_t>& row) { averageRow(row); }
void averageRow64(const BlockRowToAverage<std::uint64_t>& row) { averageRow(row); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(splitArms);
HWY_EXPORT(pairArms);
HWY_EXPORT(sumRowOfBytes32);
HWY_EXPORT(sumRowOfBytes64);
HWY_EXPORT(sumRowOfWords32);
HWY_EXPORT(sumRowOfWords64);
HWY_EXPORT(clearRow32);
HWY_EXPORT(clearRow64);
HWY_EXPORT(averageRow32);
HWY_EXPORT(averageRow64);

void sumRow(const BlockRowToSum<std::uint8_t, std::uint16_t, std::uint32_t>& row) {
  HWY_DYNAMIC_DISPATCH(sumRowOfBytes32)(row);
}
void sumRow(const BlockRowToSum<std::uint8_t, std::uint32_t, std::uint64_t>& row) {
  HWY_DYNAMIC_DISPATCH(sumRowOfBytes64)(row);
}
void sumRow(const BlockRowToSum<std::uint16_t, std::uint16_t, std::uint32_t>& row) {
  HWY_DYNAMIC_DISPATCH(sumRowOfWords32)(row);
}
void sumRow(const BlockRowToSum<std::uint16_t, std::uint32_t, std::uint64_t>& row) {
  HWY_DYNAMIC_DISPATCH(sumRowOfWords64)(row);
}
void clearRow(const BlockRowToClear<std::uint32_t>& row) { HWY_DYNAMIC_DISPATCH(clearRow32)(row); }
void clearRow(const BlockRowToClear<std::uint64_t>& row) { HWY_DYNAMIC_DISPATCH(clearRow64)(row); }
void averageRow(const BlockRowToAverage<std::uint32_t>& row) {
  HWY_DYNAMIC_DISPATCH(averageRow32)(row);
}
void averageRow(const BlockRowToAverage<std::uint64_t>& row) {
  HWY_DYNAMIC_DISPATCH(averageRow64)(row);
}

/// Whether 16 bits suffice for the sum on an arm with its centre, and 22 bits for that of a region,
/// of at most 225 pixels.
bool fit16Bits(int longest_arm_px, int max_cost) {
  return longest_arm_px <= 7 && (longest_arm_px + 1) * max_cost <= 0xffff;
}

int roundUp(int value, int multiple) { return (value + multiple - 1) / multiple * multiple; }

/// So much may be read behind the arms of a row.
constexpr int kReadableArms = 64;

/// Arms of a row of an image in two opposite directions, one by one or in pairs. No arms outside of
/// the image: the region of a hypothesis whose match lies there is itself, a copy.
class ArmLines {
 public:
  void resize(int columns) {
    for (int direction = 0; direction < 2; ++direction) {
      single_[direction].resize(columns + kReadableArms);
      pairs_[direction].resize(2 * columns + kReadableArms);
    }
  }

  void split(const ArmRow& row) {
    HWY_DYNAMIC_DISPATCH(splitArms)(row, {single_[0].data(), single_[1].data()});
  }

  /// Beside every arm the one `step` further.
  void splitToPairs(const ArmRow& row, int step) {
    split(row);
    for (int direction = 0; direction < 2; ++direction) {
      HWY_DYNAMIC_DISPATCH(pairArms)
      (single_[direction].data(), row.columns, step, pairs_[direction].data());
    }
  }

  /// From column `x` of those that were asked for on.
  std::array<const std::uint8_t*, 2> single(int x) const {
    return {single_[0].data() + x, single_[1].data() + x};
  }
  std::array<const std::uint8_t*, 2> pairs(int x) const {
    return {pairs_[0].data() + 2 * x, pairs_[1].data() + 2 * x};
  }

 private:
  std::array<std::vector<std::uint8_t>, 2> single_;
  std::array<std::vector<std::uint8_t>, 2> pairs_;
};

template <typename Cost>
struct Inputs {
  const SearchSpace& space;
  const WindowedVolume<Cost>& costs;
  const SupportArms& arms;
  View view;
};

/// Memory of a block. Between blocks, the sums are 0.
template <typename Sum>
struct BlockMemory {
  /// Makes room for blocks up to a shape.
  void resize(const BlockShape& shape, int longest_arm_px) {
    const auto tiles = static_cast<std::size_t>(shape.tilesWithMargins());
    const int columns = shape.tiles * kTileColumns;
    rows = 2 * longest_arm_px + 1;
    // One line more keeps the rows, often multiples of a power of two, from competing for one part
    // of the cache.
    row_size = static_cast<std::size_t>(columns) * shape.disparities + 64 / sizeof(Sum);
    sums.resize(row_size * rows);
    around.resize(rows);
    lists.resize(tiles * (rows + 2));
    line.resize((tiles * kTileColumns) * shape.pairs());
    for (auto* table : {&present, &left_reach, &right_reach}) {
      table->resize(tiles * 2 * shape.pairs());
    }
    reference_arms.resize(columns);
    other_arms.resize(columns + 2 * shape.pairs());
  }

  int rows = 0;
  std::size_t row_size = 0;
  std::vector<Sum, CacheLineAllocator<Sum>> sums;  ///< of as many rows as arms can span
  std::vector<const Sum*> around;
  std::vector<SearchSpace::Tile> lists;
  std::vector<Sum, CacheLineAllocator<Sum>> line;
  std::vector<std::uint8_t> present;
  std::vector<std::uint8_t> left_reach;
  std::vector<std::uint8_t> right_reach;
  alignas(64) std::array<Sum, kTileColumns> unused;
  ArmLines reference_arms;
  ArmLines other_arms;
};

/// Aggregates a block from top to bottom, first along the rows, then along the columns.
template <typename Cost, typename Lane, typename Sum>
class BlockAggregator {
 public:
  BlockAggregator(const Inputs<Cost>& inputs, const BlockShape& shape, int first_tile,
                  BlockMemory<Sum>& memory)
      : inputs_(inputs), shape_(shape), first_tile_(first_tile), memory_(memory) {}

  void run(WindowedOptimizedVolume& aggregated) {
    const int height = inputs_.space.height();
    const int delay = inputs_.arms.longest_px;
    findLists(0);
    for (int y = 0; y < height + delay; ++y) {
      if (y < height) {
        appendRow(y);
      }
      if (y >= delay) {
        averageRow(y - delay, aggregated);
      }
    }
    for (int y = std::max(0, height - memory_.rows); y < height; ++y) {
      clearRow(y, nullptr);
    }
  }

 private:
  Sum* sums(int y) { return memory_.sums.data() + y % memory_.rows * memory_.row_size; }

  /// Of a row that has sums, or the next one.
  SearchSpace::Tile* lists(int y) {
    return memory_.lists.data() +
           static_cast<std::ptrdiff_t>(y % (memory_.rows + 2)) * shape_.tilesWithMargins();
  }

  void findLists(int y) {
    for (int t = 0; t < shape_.tilesWithMargins(); ++t) {
      lists(y)[t] = list(y, first_tile_ - shape_.margin + t);
    }
  }

  /// The part of a tile's list that lies in the block.
  SearchSpace::Tile list(int y, int t) const {
    if (t < 0 || t >= inputs_.space.tiles()) {
      return {nullptr, 0, 0};
    }
    SearchSpace::Tile list = inputs_.space.tile(y, t);
    if (shape_.disparities < inputs_.space.range().count) {
      const std::int16_t* end = list.indices + list.count;
      const auto* first = std::lower_bound(list.indices, end, shape_.first_index);
      const auto* last = std::lower_bound(first, end, shape_.first_index + shape_.disparities);
      list = {first, static_cast<int>(last - first),
              list.first_entry + static_cast<std::size_t>(first - list.indices)};
    }
    return list;
  }

  /// Splits arms of row y; in pairs if they are horizontal.
  BlockArms arms(int y, bool vertical) {
    const int x = first_tile_ * kTileColumns;
    const int columns = shape_.tiles * kTileColumns;
    const int width = inputs_.space.width();
    const ArmRow reference{inputs_.arms.reference.template ptr<std::uint8_t>(y), width, vertical, x,
                           columns};
    // Columns x … x + columns − 1 at all disparities, and one more to make them even.
    const int disparities = 2 * shape_.pairs();
    const int step = inputs_.view == View::kLeft ? -1 : 1;
    const int origin = step < 0 ? disparities - 1 : 0;
    const int match =
        matchingColumn(inputs_.view, x, inputs_.space.range().min + shape_.first_index);
    const ArmRow other{inputs_.arms.other.template ptr<std::uint8_t>(y), width, vertical,
                       match - origin, columns + disparities - 1};
    if (vertical) {
      memory_.reference_arms.split(reference);
      memory_.other_arms.split(other);
      return {memory_.reference_arms.single(0), memory_.other_arms.single(origin), step};
    }
    memory_.reference_arms.splitToPairs(reference, 0);
    memory_.other_arms.splitToPairs(other, step);
    return {memory_.reference_arms.pairs(0), memory_.other_arms.pairs(origin), step};
  }

  void clearRow(int y, const SearchSpace::Tile* replacing) {
    cbmv::clearRow(BlockRowToClear<Sum>{shape_, lists(y), replacing, sums(y)});
  }

  void appendRow(int y) {
    if (y >= memory_.rows) {
      clearRow(y - memory_.rows, lists(y));
    }
    const int next = std::min(y + 1, inputs_.space.height() - 1);
    findLists(next);
    cbmv::sumRow(BlockRowToSum<Cost, Lane, Sum>{
        shape_, lists(y), lists(next), inputs_.costs.entry(0), arms(y, false), sums(y),
        memory_.line.data(), memory_.present.data(), memory_.left_reach.data(),
        memory_.right_reach.data(), memory_.unused.data()});
  }

  void averageRow(int y, WindowedOptimizedVolume& aggregated) {
    const int reach = memory_.rows / 2;
    for (int k = 0; k < memory_.rows; ++k) {
      memory_.around[k] = sums(y + k + memory_.rows - reach);
    }
    cbmv::averageRow(BlockRowToAverage<Sum>{shape_, lists(y), memory_.around.data() + reach,
                                            arms(y, true), aggregated.entry(0)});
  }

  const Inputs<Cost>& inputs_;
  const BlockShape shape_;
  const int first_tile_;
  BlockMemory<Sum>& memory_;
};

/// The largest blocks of all: what memory is made for.
template <typename Sum>
BlockShape largestBlock(const SearchSpace& space, int longest_arm_px) {
  const int margin = std::max(1, (longest_arm_px + kTileColumns - 1) / kTileColumns);
  return {std::min(16, space.tiles()), margin, 0,
          std::min(sizeof(Sum) == 4 ? 256 : 32, space.range().count)};
}

/// Number of tiles across a block: so many that the sums should fit the second-level cache, and
/// that all threads have equally many blocks.
int tilesAcross(const SearchSpace& space, const BlockShape& largest, std::size_t bytes_of_entry) {
  constexpr double kCacheBytes = 512 * 1024;
  const double share = static_cast<double>(largest.disparities) / space.range().count;
  const double list =
      share * static_cast<double>(space.entries()) / (space.height() * space.tiles());
  const int fitting =
      static_cast<int>(kCacheBytes / (std::max(list, 1.0) * static_cast<double>(bytes_of_entry)));
  const int tiles = std::clamp(fitting, std::min(4, largest.tiles), largest.tiles);
  const int threads = static_cast<int>(threadCount());
  const int blocks = roundUp((space.tiles() + tiles - 1) / tiles, threads);
  return std::max((space.tiles() + blocks - 1) / blocks, std::min(2, tiles));
}

template <typename Lane, typename Sum, typename Cost>
void aggregateBlocks(const Inputs<Cost>& inputs, PerThread<BlockMemory<Sum>>& memory,
                     WindowedOptimizedVolume& aggregated) {
  const SearchSpace& space = inputs.space;
  const BlockShape largest = largestBlock<Sum>(space, inputs.arms.longest_px);
  memory.prepare([&](BlockMemory<Sum>& block) { block.resize(largest, inputs.arms.longest_px); });
  const int rows = 2 * inputs.arms.longest_px + 1;
  const int across = tilesAcross(space, largest, rows * kTileColumns * sizeof(Sum));
  const int deep = largest.disparities;
  const int blocks_across = (space.tiles() + across - 1) / across;
  const int blocks_deep = (space.range().count + deep - 1) / deep;
  tbb::parallel_for(0, blocks_across * blocks_deep, [&](int block) {
    const int first_tile = block / blocks_deep * across;
    const int first_index = block % blocks_deep * deep;
    const BlockShape shape{std::min(across, space.tiles() - first_tile), largest.margin,
                           first_index, std::min(deep, space.range().count - first_index)};
    BlockAggregator<Cost, Lane, Sum>(inputs, shape, first_tile, memory.local()).run(aggregated);
  });
}

}  // namespace

class WindowedAggregator::Impl {
 public:
  template <typename Cost>
  void aggregate(const SearchSpace& space, const WindowedVolume<Cost>& costs, int max_cost,
                 const SupportArms& arms, View view, WindowedOptimizedVolume& aggregated) {
    const cv::Size size(space.width(), space.height());
    CV_Assert(arms.reference.type() == CV_8UC4 && arms.reference.size() == size);
    CV_Assert(arms.other.type() == CV_8UC4 && arms.other.size() == size);
    CV_Assert(costs.entries() == space.entries() && max_cost <= 16383);

    aggregated.resize(space);
    const Inputs<Cost> inputs{space, costs, arms, view};
    if (fit16Bits(arms.longest_px, max_cost)) {
      aggregateBlocks<std::uint16_t>(inputs, short_memory_, aggregated);
    } else {
      aggregateBlocks<std::uint32_t>(inputs, long_memory_, aggregated);
    }
  }

 private:
  PerThread<BlockMemory<std::uint32_t>> short_memory_;
  PerThread<BlockMemory<std::uint64_t>> long_memory_;
};

WindowedAggregator::WindowedAggregator() : impl_(std::make_unique<Impl>()) {}
WindowedAggregator::~WindowedAggregator() = default;

void WindowedAggregator::aggregate(const SearchSpace& space, const WindowedOptimizedVolume& costs,
                                   int max_cost, const SupportArms& arms, View view,
                                   WindowedOptimizedVolume& aggregated) {
  CV_Assert(&costs != &aggregated);
  impl_->aggregate(space, costs, max_cost, arms, view, aggregated);
}

void WindowedAggregator::aggregate(const SearchSpace& space, const WindowedMatchingVolume& costs,
                                   int max_cost, const SupportArms& arms, View view,
                                   WindowedOptimizedVolume& aggregated) {
  impl_->aggregate(space, costs, std::min<int>(max_cost, kOutsideCost), arms, view, aggregated);
}

}  // namespace cbmv
#endif  // HWY_ONCE
