#include "optimization/windowed_aggregation.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/per_thread.h"
#include "base/round_up.h"
#include "optimization/windowed_aggregation_rows.h"

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

/// Bits of a Sum from this one on are the number of pixels.
template <typename Sum>
constexpr int kPixelsShift = sizeof(Sum) == 4 ? 22 : 32;

/// At most as many lanes as a tile has columns.
template <typename Value>
using TileTag = hn::CappedTag<Value, kTileColumns>;

/// Pairs the horizontal arms of pixels with those of the pixels `step` columns further.
void pairArms(const std::uint32_t* arms, int columns, int step,
              const std::array<std::uint16_t*, 2>& pairs) {
  forLanes(hn::ScalableTag<std::uint32_t>(), std::max(-step, 0), columns - std::max(step, 0),
           [&](auto tag, int x, int /*done*/) {
             const hn::Rebind<std::uint16_t, decltype(tag)> narrow;
             const auto low = hn::Set(tag, 255);
             const auto first = hn::LoadU(tag, arms + x);
             const auto second = hn::LoadU(tag, arms + x + step);
             const auto left = hn::Or(hn::And(first, low), hn::ShiftLeft<8>(hn::And(second, low)));
             const auto right =
                 hn::Or(hn::And(hn::ShiftRight<8>(first), low), hn::AndNot(low, second));
             hn::StoreU(hn::TruncateTo(narrow, left), narrow, pairs[0] + x);
             hn::StoreU(hn::TruncateTo(narrow, right), narrow, pairs[1] + x);
           });
}

/// Converts numbers to signed lanes of the same or a larger width.
template <class Tag, class Numbers>
HWY_INLINE hn::Vec<Tag> widen(Tag tag, Numbers numbers) {
  if constexpr (sizeof(hn::TFromD<Tag>) == sizeof(hn::TFromV<Numbers>)) {
    return hn::BitCast(tag, numbers);
  } else {
    return hn::BitCast(tag, hn::PromoteTo(hn::RebindToUnsigned<Tag>(), numbers));
  }
}

/// Lanes whose arm has at least `length` pixels.
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

/// Calls f(length). With kUnroll, common arm lengths are passed as constants, so that loops are
/// unrolled.
template <bool kUnroll, typename F>
HWY_INLINE void withConstant(int length, const F& f) {
  switch (kUnroll ? length : -1) {
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

/// Calls f(first lane, longest arm) for vectors that cover the columns of a tile with `hypotheses`.
/// arm(x) is the longer of the two arms of column x of the tile, at most `longest`.
template <class Tag, typename Arm, typename F>
HWY_INLINE void forColumns(Tag /*tag*/, int hypotheses, int longest, const Arm& arm, const F& f) {
  constexpr bool kUnroll = sizeof(hn::TFromD<Tag>) == 4;
  const auto lanes = static_cast<int>(hn::Lanes(Tag()));
  for (int first_lane = 0; first_lane < kTileColumns; first_lane += lanes) {
    unsigned found = 0;
    for (int x = first_lane; x < first_lane + lanes; ++x) {
      found = std::max(found, arm(x));
    }
    // With few hypotheses, branches that depend on the arms cost more than long arms.
    constexpr int kFew = 20;
    withConstant<kUnroll>(hypotheses <= kFew ? longest : static_cast<int>(found),
                          [&](auto length) { f(first_lane, length); });
  }
}

/// The hypotheses of a tile at the indices 2 number and 2 number + 1. One of them may be missing.
struct Pair {
  int number;
  bool has_even;
  bool has_odd;
  int first;  ///< positions in the list
  int last;
};

/// Calls f(pair) for every pair of a list. Uses branches, so that the processor can start the next
/// pair early.
template <typename F>
HWY_INLINE void forPairs(const SearchSpace::Tile& list, int first_index, const F& f) {
  const std::int16_t* indices = list.indices;
  const int count = list.count;
  for (int j = 0; j < count;) {
    const int index = indices[j] - first_index;
    const bool odd = (index & 1) != 0;
    const bool both = !odd && j + 1 < count && indices[j + 1] == indices[j] + 1;
    const int last = both ? j + 1 : j;
    f(Pair{index >> 1, !odd, odd || both, j, last});
    j = last + 1;
  }
}

/// Copies the costs of the lists to pairs that are contiguous along the row. A missing cost of a
/// pair is unspecified, because no arm reaches it.
template <typename Cost, typename Lane, typename Sum>
HWY_INLINE void layCosts(const BlockRowToSum<Cost, Lane, Sum>& row) {
  const TileTag<Sum> tag;
  const hn::Rebind<Lane, decltype(tag)> narrow;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  const BlockShape& shape = row.shape;
  const int tiles = shape.tilesWithMargins();
  std::fill_n(row.present, tiles * shape.pairs(), std::uint16_t{0});
  for (int t = 0; t < tiles; ++t) {
    const SearchSpace::Tile& list = row.lists[t];
    const Cost* costs = row.costs + list.first_entry * kTileColumns;
    forPairs(list, shape.first_index, [&](const Pair& pair) {
      row.present[t * shape.pairs() + pair.number] =
          static_cast<std::uint16_t>((pair.has_even ? 0xff : 0) | (pair.has_odd ? 0xff00 : 0));
      Sum* out = row.line + (pair.number * tiles + t) * kTileColumns;
      for (int x = 0; x < kTileColumns; x += lanes) {
        const auto load = [&](int j) {
          return hn::PromoteTo(tag, loadWidened(narrow, costs + j * kTileColumns + x));
        };
        const auto odd = hn::ShiftLeft<8 * sizeof(Lane)>(load(pair.last));
        hn::Store(hn::Or(load(pair.first), odd), tag, out + x);
      }
    });
    if (t < shape.margin || t >= tiles - shape.margin) {  // sumTile prefetches the others
      const Cost* next = row.costs + row.next_lists[t].first_entry * kTileColumns;
      for (int j = 0; j < list.count; j += 2) {
        hwy::Prefetch(next + j * kTileColumns);
      }
    }
  }
}

/// Counts the consecutive columns with the hypothesis, from the near end of each tile to the left
/// and to the right. At most 255.
template <typename Cost, typename Lane, typename Sum>
HWY_INLINE void measureReach(const BlockRowToSum<Cost, Lane, Sum>& row) {
  const int tiles = row.shape.tilesWithMargins();
  const int count = 2 * row.shape.pairs();
  const auto* present = reinterpret_cast<const std::uint8_t*>(row.present);
  const auto measure = [&](int t, int farther, std::uint16_t* pairs) {
    auto* reach = reinterpret_cast<std::uint8_t*>(pairs);
    const bool ends = farther < 0 || farther == tiles;
    for (int i = 0; i < count; ++i) {
      const int beyond = ends ? 0 : reach[farther * count + i];
      const int columns = present[t * count + i] != 0 ? beyond + kTileColumns : 0;
      reach[t * count + i] = static_cast<std::uint8_t>(std::min(columns, 255));
    }
  };
  for (int t = 0; t < tiles; ++t) {
    measure(t, t - 1, row.left_reach);
    measure(tiles - 1 - t, tiles - t, row.right_reach);
  }
}

/// Combined horizontal arms of a pair. `columns` is the number of columns between the pixel and the
/// end of its tile, `reach` is the number of columns beyond it.
template <class Bytes>
HWY_INLINE hn::Vec<Bytes> combinedArms(Bytes bytes, hn::Vec<Bytes> reference,
                                       const std::uint16_t* other, hn::Vec<Bytes> columns,
                                       std::uint16_t reach) {
  const hn::Repartition<std::uint16_t, Bytes> pair;
  const auto arms = hn::Min(reference, hn::BitCast(bytes, hn::LoadU(pair, other)));
  return hn::Min(arms, hn::SaturatedAdd(columns, hn::BitCast(bytes, hn::Set(pair, reach))));
}

/// Stores the sums of pairs. `left` and `right` have the sums on the left and right arms as `Lane`;
/// `pixels` has the numbers of pixels.
template <typename Lane, class Tag>
HWY_INLINE void storePair(Tag tag, hn::Vec<Tag> left, hn::Vec<Tag> right, hn::Vec<Tag> pixels,
                          hn::TFromD<Tag>* even, hn::TFromD<Tag>* odd) {
  constexpr int kShift = kPixelsShift<hn::TFromD<Tag>>;
  constexpr int kLaneBits = 8 * sizeof(Lane);
  const auto low = hn::Set(tag, static_cast<Lane>(-1));
  const auto even_sum = hn::Add(hn::And(left, low), hn::And(right, low));
  const auto odd_sum = hn::Add(hn::ShiftRight<kLaneBits>(left), hn::ShiftRight<kLaneBits>(right));
  const auto odd_pixels = hn::ShiftLeft<kShift>(hn::ShiftRight<kLaneBits>(pixels));
  const auto even_pixels = hn::ShiftLeft<kShift>(pixels);  // the odd ones are shifted out
  hn::Store(hn::Add(even_sum, even_pixels), tag, even);
  hn::Store(hn::Add(odd_sum, odd_pixels), tag, odd);
}

template <typename Cost, typename Lane, typename Sum, typename Length>
HWY_INLINE void sumTile(const BlockRowToSum<Cost, Lane, Sum>& row, int t, int first_lane,
                        Length longest) {
  const TileTag<Sum> tag;
  const hn::Repartition<Lane, decltype(tag)> lane;
  const hn::RebindToSigned<decltype(lane)> arm_tag;
  const hn::Rebind<std::uint8_t, decltype(lane)> bytes;
  const hn::Repartition<std::uint16_t, decltype(bytes)> pair_tag;

  const BlockShape& shape = row.shape;
  const int x = t * kTileColumns + first_lane;
  const int tile = t + shape.margin;
  const auto left_arms = hn::BitCast(bytes, hn::LoadU(pair_tag, row.arms.reference[0] + x));
  const auto right_arms = hn::BitCast(bytes, hn::LoadU(pair_tag, row.arms.reference[1] + x));
  const auto first_column = static_cast<std::uint8_t>(2 * first_lane);
  const auto columns_left = hn::ShiftRight<1>(countFrom(bytes, first_column));
  const auto columns_right = hn::Sub(hn::Set(bytes, kTileColumns - 1), columns_left);
  const std::uint16_t* left_reach = row.left_reach + (tile - 1) * shape.pairs();
  const std::uint16_t* right_reach = row.right_reach + (tile + 1) * shape.pairs();
  const Cost* next = row.costs + row.next_lists[tile].first_entry * kTileColumns;
  const int pitch = shape.tilesWithMargins() * kTileColumns;
  forPairs(row.lists[tile], shape.first_index, [&](const Pair& pair) {
    hwy::Prefetch(next + pair.first * kTileColumns);
    const int other = x + 2 * pair.number * row.arms.other_step;
    const auto left = widen(arm_tag, combinedArms(bytes, left_arms, row.arms.other[0] + other,
                                                  columns_left, left_reach[pair.number]));
    const auto right = widen(arm_tag, combinedArms(bytes, right_arms, row.arms.other[1] + other,
                                                   columns_right, right_reach[pair.number]));
    const Sum* costs = row.line + pair.number * pitch + tile * kTileColumns + first_lane;
    const auto load = [&](int k) { return hn::BitCast(lane, hn::LoadU(tag, costs + k)); };
    auto left_sum = load(0);
    auto right_sum = hn::Zero(lane);
    for (int k = 1; k <= longest; ++k) {
      left_sum = addWhere(lane, reaches(lane, left, k), left_sum, load(-k));
      right_sum = addWhere(lane, reaches(lane, right, k), right_sum, load(k));
    }
    const auto pixels = hn::Add(hn::Add(left, right), hn::Set(arm_tag, 1));
    Sum* sums = row.sums + (t * shape.disparities + 2 * pair.number) * kTileColumns + first_lane;
    storePair<Lane>(tag, hn::BitCast(tag, left_sum), hn::BitCast(tag, right_sum),
                    hn::BitCast(tag, pixels), pair.has_even ? sums : row.unused,
                    pair.has_odd ? sums + kTileColumns : row.unused);
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
  layCosts(row);
  if constexpr (sizeof(Lane) == 2) {
    row.left_reach = row.right_reach = row.present;  // arms reach at most into the next tile
  } else {
    measureReach(row);
  }
  for (int t = 0; t < row.shape.tiles; ++t) {
    const auto arm = [&](int x) {
      const auto reference = [&](int direction) {
        return row.arms.reference[direction][t * kTileColumns + x] & 0xffU;
      };
      return std::max(reference(0), reference(1));
    };
    const int hypotheses = row.lists[t + row.shape.margin].count;
    forColumns(TileTag<Sum>(), hypotheses, row.longest_arm_px, arm,
               [&](int first_lane, auto longest) { sumTile(row, t, first_lane, longest); });
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

/// Stores sum / pixels, rounded to the nearest integer (halves up), for means of at most 16383 over
/// at most 225 pixels.
///
/// The result is exact. Halves are exact in float, and the small offset rounds them up. All other
/// quotients are at least 1/450 away from a half, which is more than the offset plus the rounding
/// error. Adding 2^23 rounds to an integer and leaves it in the low bits.
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

/// In double, which is exact for integers up to 2^53.
HWY_INLINE void storeMeans(TileTag<std::uint64_t> tag, hn::Vec<TileTag<std::uint64_t>> sums,
                           std::uint16_t* means) {
  constexpr int kShift = kPixelsShift<std::uint64_t>;
  HWY_ALIGN std::uint64_t lanes[kTileColumns];
  hn::Store(sums, tag, lanes);
  for (int i = 0; i < static_cast<int>(hn::Lanes(tag)); ++i) {
    const auto pixels = static_cast<std::uint32_t>(lanes[i] >> kShift);
    const std::uint64_t sum = lanes[i] & ((std::uint64_t{1} << kShift) - 1);
    const std::uint32_t half = pixels / 2;
    means[i] = static_cast<std::uint16_t>(static_cast<double>(sum + half) / pixels);
  }
}

template <typename Sum, typename Length>
HWY_INLINE void averageTile(const BlockRowToAverage<Sum>& row, int t, int first_lane,
                            Length longest) {
  const TileTag<Sum> tag;
  const hn::RebindToSigned<decltype(tag)> arm_tag;
  const hn::Rebind<std::uint32_t, decltype(tag)> pixel;
  const hn::Repartition<std::uint8_t, decltype(pixel)> channels;
  const int x = t * kTileColumns + first_lane;
  const auto reference = hn::BitCast(channels, hn::LoadU(pixel, row.arms.reference + x));
  const SearchSpace::Tile& list = row.lists[t + row.shape.margin];
  std::uint16_t* means = row.means + list.first_entry * kTileColumns + first_lane;
  for (int j = 0; j < list.count; ++j) {
    const int index = list.indices[j] - row.shape.first_index;
    const auto other = hn::LoadU(pixel, row.arms.other + x + index * row.arms.other_step);
    const auto arms = hn::BitCast(pixel, hn::Min(reference, hn::BitCast(channels, other)));
    const auto up = widen(arm_tag, hn::And(hn::ShiftRight<16>(arms), hn::Set(pixel, 255)));
    const auto down = widen(arm_tag, hn::ShiftRight<24>(arms));
    const int place = (t * row.shape.disparities + index) * kTileColumns + first_lane;
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
  for (int t = 0; t < row.shape.tiles; ++t) {
    const auto arm = [&](int x) {
      const std::uint32_t arms = row.arms.reference[t * kTileColumns + x];
      return std::max(arms >> 16 & 0xffU, arms >> 24);
    };
    const int hypotheses = row.lists[t + row.shape.margin].count;
    forColumns(TileTag<Sum>(), hypotheses, row.longest_arm_px, arm,
               [&](int first_lane, auto longest) { averageTile(row, t, first_lane, longest); });
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

/// Returns whether 16 bits suffice for the sum on an arm with its center, and 22 bits for the sum
/// of a region of at most 225 pixels.
bool fit16Bits(int longest_arm_px, int max_cost) {
  return longest_arm_px <= 7 && (longest_arm_px + 1) * max_cost <= 0xffff;
}

/// Arms of a row of an image, for columns inside and outside. Outside, arms are 0, so the region of
/// a hypothesis whose match is there is the pixel itself, and its cost is copied.
class ArmLine {
 public:
  void resize(int columns) {
    const std::size_t size = columns + kReadableBytesBeyond / sizeof(std::uint32_t);
    arms_.resize(size);
    for (std::vector<std::uint16_t>& pairs : pairs_) {
      pairs.resize(size);
    }
  }

  /// Sets the line to `columns` columns from column `first` on.
  void assign(const cv::Mat& arms, int y, int first, int columns) {
    columns_ = columns;
    const int begin = std::clamp(-first, 0, columns);
    const int end = std::clamp(arms.cols - first, begin, columns);
    if (begin == 0 && end == columns) {
      taken_ = arms.ptr<std::uint32_t>(y) + first;
      return;
    }
    taken_ = arms_.data();
    std::fill_n(arms_.begin(), begin, 0U);
    if (begin < end) {
      std::memcpy(arms_.data() + begin, arms.ptr<std::uint8_t>(y) + 4 * (first + begin),
                  (end - begin) * sizeof(std::uint32_t));
    }
    std::fill(arms_.begin() + end, arms_.begin() + columns, 0U);
  }

  /// Pairs each column with the column `step` further.
  void pair(int step) {
    HWY_DYNAMIC_DISPATCH(pairArms)
    (taken_, columns_, step, {pairs_[0].data(), pairs_[1].data()});
  }

  /// The arms from position `place` of the line on.
  const std::uint32_t* arms(int place) const { return taken_ + place; }
  std::array<const std::uint16_t*, 2> pairs(int place) const {
    return {pairs_[0].data() + place, pairs_[1].data() + place};
  }

 private:
  int columns_ = 0;
  /// Four channels. Points into the image if all columns are inside.
  const std::uint32_t* taken_ = nullptr;
  std::vector<std::uint32_t> arms_;
  std::array<std::vector<std::uint16_t>, 2> pairs_;
};

template <typename Cost>
struct Inputs {
  const SearchSpace& space;
  const WindowedVolume<Cost>& costs;
  const SupportArms& arms;
  View view;
};

/// Memory of a block. The sums are 0 between blocks.
template <typename Sum>
struct BlockMemory {
  /// Makes room for blocks of at most this shape.
  void resize(const BlockShape& shape, int longest_arm_px) {
    const auto tiles = static_cast<std::size_t>(shape.tilesWithMargins());
    const int columns = shape.tiles * kTileColumns;
    rows = 2 * longest_arm_px + 1;
    // One extra line avoids cache conflicts between rows whose size is a multiple of a power of
    // two.
    row_size = static_cast<std::size_t>(columns) * shape.disparities + 64 / sizeof(Sum);
    sums.resize(row_size * rows);
    around.resize(rows);
    lists.resize(tiles * (rows + 2));
    line.resize((tiles * kTileColumns) * shape.pairs());
    for (auto* table : {&present, &left_reach, &right_reach}) {
      table->resize(tiles * shape.pairs());
    }
    reference_arms.resize(columns);
    other_arms.resize(columns + 2 * shape.pairs());
  }

  int rows = 0;
  std::size_t row_size = 0;
  std::vector<Sum, CacheLineAllocator<Sum>> sums;  ///< for as many rows as arms can span
  std::vector<const Sum*> around;
  std::vector<SearchSpace::Tile> lists;
  std::vector<Sum, CacheLineAllocator<Sum>> line;
  std::vector<std::uint16_t> present;
  std::vector<std::uint16_t> left_reach;
  std::vector<std::uint16_t> right_reach;
  alignas(64) std::array<Sum, kTileColumns> unused;
  ArmLine reference_arms;
  ArmLine other_arms;
};

/// Aggregates a block from top to bottom, first along the rows, then along the columns.
template <typename Cost, typename Lane, typename Sum>
class BlockAggregator {
 public:
  BlockAggregator(const Inputs<Cost>& inputs, const BlockShape& shape, int first_tile,
                  BlockMemory<Sum>& memory)
      : inputs_(inputs), shape_(shape), first_tile_(first_tile), memory_(memory) {}

  void run(WindowedAggregatedVolume& aggregated) {
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

  /// Lists of a row that has sums, or of the next row.
  SearchSpace::Tile* lists(int y) {
    return memory_.lists.data() +
           static_cast<std::ptrdiff_t>(y % (memory_.rows + 2)) * shape_.tilesWithMargins();
  }

  void findLists(int y) {
    for (int t = 0; t < shape_.tilesWithMargins(); ++t) {
      lists(y)[t] = list(y, first_tile_ - shape_.margin + t);
    }
  }

  /// The part of a tile's list that is in the block.
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

  int step() const { return inputs_.view == View::kLeft ? -1 : 1; }

  /// Sets the arms of row y. Returns the start of the arms of the other image.
  int takeArms(int y) {
    const int x = first_tile_ * kTileColumns;
    const int columns = shape_.tiles * kTileColumns;
    memory_.reference_arms.assign(inputs_.arms.reference, y, x, columns);
    const int first_disparity = inputs_.space.range().min + shape_.first_index;
    const int origin = step() < 0 ? 2 * shape_.pairs() - 1 : 0;
    memory_.other_arms.assign(inputs_.arms.other, y,
                              matchingColumn(inputs_.view, x, first_disparity) - origin,
                              columns + 2 * shape_.pairs() - 1);
    return origin;
  }

  HorizontalArms horizontalArms(int y) {
    const int origin = takeArms(y);
    memory_.reference_arms.pair(0);
    memory_.other_arms.pair(step());
    return {memory_.reference_arms.pairs(0), memory_.other_arms.pairs(origin), step()};
  }

  VerticalArms verticalArms(int y) {
    const int origin = takeArms(y);
    return {memory_.reference_arms.arms(0), memory_.other_arms.arms(origin), step()};
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
        shape_, lists(y), lists(next), inputs_.costs.entry(0), horizontalArms(y),
        inputs_.arms.longest_px, sums(y), memory_.line.data(), memory_.present.data(),
        memory_.left_reach.data(), memory_.right_reach.data(), memory_.unused.data()});
  }

  void averageRow(int y, WindowedAggregatedVolume& aggregated) {
    const int reach = memory_.rows / 2;
    for (int k = 0; k < memory_.rows; ++k) {
      memory_.around[k] = sums(y + k + memory_.rows - reach);
    }
    cbmv::averageRow(BlockRowToAverage<Sum>{shape_, lists(y), memory_.around.data() + reach,
                                            verticalArms(y), inputs_.arms.longest_px,
                                            aggregated.entry(0)});
  }

  const Inputs<Cost>& inputs_;
  const BlockShape shape_;
  const int first_tile_;
  BlockMemory<Sum>& memory_;
};

/// The largest block, for which memory is allocated.
template <typename Sum>
BlockShape largestBlock(const SearchSpace& space, int longest_arm_px) {
  const int margin = std::max(1, (longest_arm_px + kTileColumns - 1) / kTileColumns);
  return {std::min(16, space.tiles()), margin, 0,
          std::min(sizeof(Sum) == 4 ? 256 : 32, space.range().count)};
}

/// Number of tiles of a block in x: the sums should fit into the second-level cache, and all
/// threads should have the same number of blocks.
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
                     WindowedAggregatedVolume& aggregated) {
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
                 const SupportArms& arms, View view, WindowedAggregatedVolume& aggregated) {
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

void WindowedAggregator::aggregate(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                                   int max_cost, const SupportArms& arms, View view,
                                   WindowedAggregatedVolume& aggregated) {
  CV_Assert(&costs != &aggregated);
  impl_->aggregate(space, costs, max_cost, arms, view, aggregated);
}

void WindowedAggregator::aggregate(const SearchSpace& space, const WindowedMatchingVolume& costs,
                                   int max_cost, const SupportArms& arms, View view,
                                   WindowedAggregatedVolume& aggregated) {
  impl_->aggregate(space, costs, std::min<int>(max_cost, kOutsideCost), arms, view, aggregated);
}

}  // namespace cbmv
#endif  // HWY_ONCE
