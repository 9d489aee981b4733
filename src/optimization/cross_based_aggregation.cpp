#include "optimization/cross_based_aggregation.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/per_thread.h"
#include "base/round_up.h"
#include "optimization/aggregation_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/cross_based_aggregation.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/cost_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

/// 16-bit sums are kept modulo 2^16. A second lane has the other information. Its lower bits are
/// the sum of the row sums divided by 2^kLowBits, from which the high bits of the sum follow. Its
/// bits from kPixelsShift on are the number of pixels.
constexpr int kLowBits = 12;
constexpr int kPixelsShift = 8;

/// Combined arms of the hypotheses from `h` on. `arm` is 0 or 1: the first or the second direction.
template <class Tag>
HWY_INLINE hn::Vec<Tag> combinedArms(Tag tag, const ArmRows& rows, int arm, int column, int h) {
  const std::uint8_t* other = rows.other[arm] + column * rows.other_step + h;
  return hn::Min(hn::Set(tag, rows.reference[arm][4 * column]), loadWidened(tag, other));
}

/// Lanes whose arm has at least `length` pixels.
template <class Tag, class ArmVector>
HWY_INLINE hn::Mask<Tag> reaches(Tag tag, ArmVector arms, int length) {
  return hn::RebindMask(tag, hn::Gt(arms, hn::Set(hn::RebindToSigned<Tag>(), length - 1)));
}

/// Adds the costs of the pixels on the arms to the sums of two vectors of hypotheses. The first
/// pixel is one `step` after `costs`. Stops at the `longest` arm.
template <class Tag, typename Cost, class ArmVector>
HWY_INLINE void addCostsOnArms(Tag tag, const Cost* costs, std::ptrdiff_t step, int longest,
                               ArmVector arms0, ArmVector arms1, hn::Vec<Tag>& sums0,
                               hn::Vec<Tag>& sums1) {
  for (int k = 1; k <= longest; ++k) {
    costs += step;
    const auto costs0 = loadWidened(tag, costs);
    const auto costs1 = loadWidened(tag, costs + hn::Lanes(tag));
    sums0 = hn::Add(sums0, hn::IfThenElseZero(reaches(tag, arms0, k), costs0));
    sums1 = hn::Add(sums1, hn::IfThenElseZero(reaches(tag, arms1, k), costs1));
  }
}

/// Stores the sums of a row and their numbers of pixels. `first` and `second` fit their lanes, but
/// their sum may exceed 16 bits.
template <class Tag>
HWY_INLINE void storeSums(Tag tag, hn::Vec<Tag> first, hn::Vec<Tag> second, hn::Vec<Tag> pixels,
                          hn::TFromD<Tag>* sums, std::ptrdiff_t pitch) {
  const auto sum = hn::Add(first, second);
  hn::Store(sum, tag, sums);
  if constexpr (sizeof(hn::TFromD<Tag>) == 2) {
    const auto carry = hn::IfThenElseZero(hn::Lt(sum, first), hn::Set(tag, 1U << (16 - kLowBits)));
    const auto high = hn::Add(hn::ShiftRight<kLowBits>(sum), carry);
    hn::Store(hn::Add(high, hn::ShiftLeft<kPixelsShift>(pixels)), tag, sums + pitch);
  } else {
    hn::Store(pixels, tag, sums + pitch);
  }
}

template <typename Cost, typename Sum>
HWY_INLINE void sumRow(const RowToSum<Cost, Sum> row) {
  const LineTag<Sum> tag;
  const hn::RebindToSigned<LineTag<Sum>> arm_tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  const auto one = hn::Set(arm_tag, 1);
  for (int i = 0; i < row.columns; ++i) {
    for (int h = 0; h < row.hypotheses; h += 2 * lanes) {
      const Cost* costs = row.costs + i * row.pixel_step + h;
      Sum* sums = row.sums + 2 * i * row.pitch + h;
      const auto left0 = combinedArms(arm_tag, row.arms, 0, i, h);
      const auto left1 = combinedArms(arm_tag, row.arms, 0, i, h + lanes);
      auto left_sums0 = loadWidened(tag, costs);
      auto left_sums1 = loadWidened(tag, costs + lanes);
      addCostsOnArms(tag, costs, -row.pixel_step, row.arms.reference[0][4 * i], left0, left1,
                     left_sums0, left_sums1);
      const auto right0 = combinedArms(arm_tag, row.arms, 1, i, h);
      const auto right1 = combinedArms(arm_tag, row.arms, 1, i, h + lanes);
      auto right_sums0 = hn::Zero(tag);
      auto right_sums1 = right_sums0;
      addCostsOnArms(tag, costs, row.pixel_step, row.arms.reference[1][4 * i], right0, right1,
                     right_sums0, right_sums1);
      const auto pixels0 = hn::BitCast(tag, hn::Add(hn::Add(left0, right0), one));
      const auto pixels1 = hn::BitCast(tag, hn::Add(hn::Add(left1, right1), one));
      storeSums(tag, left_sums0, right_sums0, pixels0, sums, row.pitch);
      storeSums(tag, left_sums1, right_sums1, pixels1, sums + lanes, row.pitch);
    }
  }
}

void sumRowOfBytes16(const RowToSum<std::uint8_t, std::uint16_t>& row) { sumRow(row); }
void sumRowOfBytes32(const RowToSum<std::uint8_t, std::uint32_t>& row) { sumRow(row); }
void sumRowOfWords16(const RowToSum<std::uint16_t, std::uint16_t>& row) { sumRow(row); }
void sumRowOfWords32(const RowToSum<std::uint16_t, std::uint32_t>& row) { sumRow(row); }

/// Adds the rows on one of the vertical arms to the sums and numbers of pixels of two vectors of
/// hypotheses.
template <class Tag>
HWY_INLINE void addRowsOnArms(Tag tag, const RowToAverage<hn::TFromD<Tag>>& row, int arm,
                              int column, int h, hn::Vec<Tag>& sums0, hn::Vec<Tag>& sums1,
                              hn::Vec<Tag>& pixels0, hn::Vec<Tag>& pixels1) {
  const hn::RebindToSigned<Tag> arm_tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  const auto arms0 = combinedArms(arm_tag, row.arms, arm, column, h);
  const auto arms1 = combinedArms(arm_tag, row.arms, arm, column, h + lanes);
  const int longest = row.arms.reference[arm][4 * column];
  for (int k = 1; k <= longest; ++k) {
    const auto* sums = row.rows[arm == 0 ? -k : k] + 2 * column * row.pitch + h;
    const auto* pixels = sums + row.pitch;
    const auto on_arm0 = reaches(tag, arms0, k);
    const auto on_arm1 = reaches(tag, arms1, k);
    sums0 = hn::Add(sums0, hn::IfThenElseZero(on_arm0, hn::Load(tag, sums)));
    sums1 = hn::Add(sums1, hn::IfThenElseZero(on_arm1, hn::Load(tag, sums + lanes)));
    pixels0 = hn::Add(pixels0, hn::IfThenElseZero(on_arm0, hn::Load(tag, pixels)));
    pixels1 = hn::Add(pixels1, hn::IfThenElseZero(on_arm1, hn::Load(tag, pixels + lanes)));
  }
}

/// Computes sum / pixels, rounded to the nearest integer (halves up), for means of at most 16383
/// over at most 225 pixels. Only the lower 16 bits of the result are valid.
///
/// The result is exact. Halves are exact in float, and the small offset rounds them up. All other
/// quotients are at least 1/450 away from a half, which is more than the offset plus the rounding
/// error. Adding 2^23 rounds to an integer and leaves it in the low bits.
template <class Integers>
HWY_INLINE hn::Vec<Integers> divide(Integers tag, hn::Vec<Integers> sum, hn::Vec<Integers> pixels) {
  const hn::RebindToFloat<Integers> real;
  const auto quotient = hn::Div(hn::ConvertTo(real, sum), hn::ConvertTo(real, pixels));
  const auto above_half = hn::Add(quotient, hn::Set(real, 1.0F / 1024));
  return hn::BitCast(tag, hn::Add(above_half, hn::Set(real, 8388608.0F)));
}

/// Divides even and odd lanes separately, as 32-bit lanes.
HWY_INLINE void storeMeans(LineTag<std::uint16_t> tag, hn::Vec<LineTag<std::uint16_t>> sums,
                           hn::Vec<LineTag<std::uint16_t>> pixels, int count,
                           std::uint16_t* means) {
  const hn::RepartitionToWide<hn::RebindToSigned<decltype(tag)>> wide;
  const auto rows_high = hn::And(pixels, hn::Set(tag, (1U << kPixelsShift) - 1));
  const auto rows_low = hn::Sub(sums, hn::ShiftLeft<kLowBits>(rows_high));
  const auto high = hn::BitCast(
      wide, hn::ShiftRight<16 - kLowBits>(hn::Add(rows_high, hn::ShiftRight<kLowBits>(rows_low))));
  const auto low = hn::BitCast(wide, sums);
  const auto number = hn::BitCast(wide, hn::ShiftRight<kPixelsShift>(pixels));
  const auto even = hn::Set(wide, 0xffff);
  const auto even_mean =
      divide(wide, hn::Or(hn::And(low, even), hn::ShiftLeft<16>(high)), hn::And(number, even));
  // The sums are below 2^22, so `high` and `number` have no sign bit.
  const auto odd_low = hn::And(hn::ShiftRight<16>(low), even);
  const auto odd_mean =
      divide(wide, hn::Or(odd_low, hn::AndNot(even, high)), hn::ShiftRight<16>(number));
  const auto both = hn::Or(hn::And(even_mean, even), hn::ShiftLeft<16>(odd_mean));
  storeFirst(tag, hn::BitCast(tag, both), count, means);
}

/// In double, which is exact for integers up to 2^53.
HWY_INLINE void storeMeans(LineTag<std::uint32_t> tag, hn::Vec<LineTag<std::uint32_t>> sums,
                           hn::Vec<LineTag<std::uint32_t>> pixels, int count,
                           std::uint16_t* means) {
  HWY_ALIGN std::uint32_t sum[16];
  HWY_ALIGN std::uint32_t number[16];
  hn::Store(hn::Add(sums, hn::ShiftRight<1>(pixels)), tag, sum);
  hn::Store(pixels, tag, number);
  const int lanes = std::min(count, static_cast<int>(hn::Lanes(tag)));
  for (int i = 0; i < lanes; ++i) {
    means[i] = static_cast<std::uint16_t>(static_cast<double>(sum[i]) / number[i]);
  }
}

template <typename Sum>
HWY_INLINE void averageRow(const RowToAverage<Sum> row) {
  const LineTag<Sum> tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  for (int i = 0; i < row.columns; ++i) {
    for (int h = 0; h < row.hypotheses; h += 2 * lanes) {
      const Sum* center = row.rows[0] + 2 * i * row.pitch + h;
      auto sums0 = hn::Load(tag, center);
      auto sums1 = hn::Load(tag, center + lanes);
      auto pixels0 = hn::Load(tag, center + row.pitch);
      auto pixels1 = hn::Load(tag, center + row.pitch + lanes);
      addRowsOnArms(tag, row, 0, i, h, sums0, sums1, pixels0, pixels1);
      addRowsOnArms(tag, row, 1, i, h, sums0, sums1, pixels0, pixels1);
      std::uint16_t* means = row.means + i * row.pixel_step + h;
      storeMeans(tag, sums0, pixels0, row.hypotheses - h, means);
      storeMeans(tag, sums1, pixels1, row.hypotheses - h - lanes, means + lanes);
    }
  }
}

void averageRow16(const RowToAverage<std::uint16_t>& row) { averageRow(row); }
void averageRow32(const RowToAverage<std::uint32_t>& row) { averageRow(row); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(sumRowOfBytes16);
HWY_EXPORT(sumRowOfBytes32);
HWY_EXPORT(sumRowOfWords16);
HWY_EXPORT(sumRowOfWords32);
HWY_EXPORT(averageRow16);
HWY_EXPORT(averageRow32);

void sumRow(const RowToSum<std::uint8_t, std::uint16_t>& row) {
  HWY_DYNAMIC_DISPATCH(sumRowOfBytes16)(row);
}
void sumRow(const RowToSum<std::uint8_t, std::uint32_t>& row) {
  HWY_DYNAMIC_DISPATCH(sumRowOfBytes32)(row);
}
void sumRow(const RowToSum<std::uint16_t, std::uint16_t>& row) {
  HWY_DYNAMIC_DISPATCH(sumRowOfWords16)(row);
}
void sumRow(const RowToSum<std::uint16_t, std::uint32_t>& row) {
  HWY_DYNAMIC_DISPATCH(sumRowOfWords32)(row);
}
void averageRow(const RowToAverage<std::uint16_t>& row) { HWY_DYNAMIC_DISPATCH(averageRow16)(row); }
void averageRow(const RowToAverage<std::uint32_t>& row) { HWY_DYNAMIC_DISPATCH(averageRow32)(row); }

/// Channels of the arms.
enum Arm { kLeftArm = 0, kRightArm = 1, kUpArm = 2, kDownArm = 3 };

/// Part of the volumes that is processed at once: all rows of some columns and disparities.
struct Tile {
  cv::Range columns;
  cv::Range disparities;  // indices
};

/// The arms of the other image, one plane per channel. The order makes the arms at the matching
/// columns of a pixel's hypotheses contiguous: mirrored for the left view, where the matching
/// column decreases as d grows. Arms outside of the other image are 0, so the region of such a
/// hypothesis is the pixel itself, and its cost is copied.
class MatchingArms {
 public:
  void assign(const cv::Mat& arms, View view, const DisparityRange& range) {
    width_ = arms.cols;
    mirrored_ = view == View::kLeft;
    const int size = arms.cols + range.count - 1 + static_cast<int>(kReadableBytesBeyond);
    for (cv::Mat& plane : planes_) {
      plane.create(arms.rows, size, CV_8UC1);
    }
    const cv::Range inside(std::clamp(range.min, 0, width_),
                           std::clamp(range.min + size, 0, width_));
    tbb::parallel_for(0, arms.rows, [&](int y) {
      for (int channel = 0; channel < static_cast<int>(planes_.size()); ++channel) {
        auto* plane = planes_[channel].ptr<std::uint8_t>(y);
        std::fill_n(plane, size, std::uint8_t{0});
        copyChannel(arms.ptr<cv::Vec4b>(y), channel, inside, plane + (inside.start - range.min));
      }
    });
  }

  /// Arms for the hypotheses of pixel (x, y).
  const std::uint8_t* hypotheses(Arm arm, int y, int x) const {
    return planes_[arm].ptr<std::uint8_t>(y) + (mirrored_ ? width_ - 1 - x : x);
  }
  /// Distance between columns.
  int step() const { return mirrored_ ? -1 : 1; }

 private:
  void copyChannel(const cv::Vec4b* arms, int channel, const cv::Range& columns,
                   std::uint8_t* out) const {
    for (int i = columns.start; i < columns.end; ++i) {
      *out++ = arms[mirrored_ ? width_ - 1 - i : i][channel];
    }
  }

  int width_ = 0;
  bool mirrored_ = false;
  std::array<cv::Mat, 4> planes_;
};

template <typename Cost>
struct Inputs {
  const Volume<Cost>& costs;
  const cv::Mat& reference_arms;
  const MatchingArms& other_arms;
  int longest_arm_px;
};

/// Elements per cache line.
template <typename Value>
constexpr int kLine = 64 / sizeof(Value);

/// Ring buffer with sums along the rows of a tile, for as many rows as arms can span.
template <typename Sum>
class Ring {
 public:
  /// Makes room for tiles with at most this many columns and disparities.
  void resize(int columns, int disparities, int longest_arm_px) {
    rows_ = 2 * longest_arm_px + 1;
    pitch_ = roundUp(disparities, 2 * kLine<Sum>);
    // One extra line avoids cache conflicts between rows whose size is a multiple of a power of
    // two.
    row_size_ = 2 * pitch_ * columns + kLine<Sum>;
    sums_.resize(row_size_ * rows_);
    around_.resize(rows_);
  }

  /// Length of a line of sums or numbers of pixels of one column, in elements.
  std::ptrdiff_t pitch() const { return pitch_; }
  /// `y` may be up to one ring size above the image.
  Sum* row(int y) { return sums_.data() + (y + rows_) % rows_ * row_size_; }

  /// rowsAround(y)[k] is row(y + k), for k within the longest arm.
  const Sum* const* rowsAround(int y) {
    for (int k = 0; k < rows_; ++k) {
      around_[k] = row(y - rows_ / 2 + k);
    }
    return around_.data() + rows_ / 2;
  }

 private:
  int rows_ = 0;
  std::ptrdiff_t pitch_ = 0;
  std::ptrdiff_t row_size_ = 0;
  std::vector<Sum, CacheLineAllocator<Sum>> sums_;
  std::vector<const Sum*> around_;
};

/// Aggregates a tile from top to bottom, first along the rows, then along the columns.
template <typename Cost, typename Sum>
class TileAggregator {
 public:
  TileAggregator(const Inputs<Cost>& inputs, const Tile& tile, Ring<Sum>& ring)
      : inputs_(inputs), tile_(tile), ring_(ring) {}

  void run(AggregatedVolume& aggregated) {
    const int height = inputs_.costs.height();
    const int delay = inputs_.longest_arm_px;
    for (int y = 0; y < height + delay; ++y) {
      if (y < height) {
        appendRow(y);
      }
      if (y >= delay) {
        averageRow(y - delay, aggregated);
      }
    }
  }

 private:
  ArmRows arms(int y, Arm first, Arm second) const {
    const int x = tile_.columns.start;
    const std::uint8_t* reference = inputs_.reference_arms.template ptr<cv::Vec4b>(y)[x].val;
    const auto other = [&](Arm arm) {
      return inputs_.other_arms.hypotheses(arm, y, x) + tile_.disparities.start;
    };
    return {{reference + first, reference + second},
            {other(first), other(second)},
            inputs_.other_arms.step()};
  }

  void appendRow(int y) {
    const int first = tile_.columns.start;
    sumRow(RowToSum<Cost, Sum>{inputs_.costs.pixel(y, first) + tile_.disparities.start,
                               inputs_.costs.disparities(), tile_.columns.size(),
                               tile_.disparities.size(), arms(y, kLeftArm, kRightArm), ring_.row(y),
                               ring_.pitch()});
  }

  void averageRow(int y, AggregatedVolume& aggregated) {
    const int first = tile_.columns.start;
    cbmv::averageRow(RowToAverage<Sum>{ring_.rowsAround(y), ring_.pitch(), tile_.columns.size(),
                                       tile_.disparities.size(), arms(y, kUpArm, kDownArm),
                                       aggregated.pixel(y, first) + tile_.disparities.start,
                                       aggregated.disparities()});
  }

  const Inputs<Cost>& inputs_;
  const Tile tile_;
  Ring<Sum>& ring_;
};

template <typename Sum, typename Cost>
void aggregateTiles(const Inputs<Cost>& inputs, PerThread<Ring<Sum>>& rings,
                    AggregatedVolume& aggregated) {
  const int width = inputs.costs.width();
  const int count = inputs.costs.disparities();
  // The ring should fit into the second-level cache. A tile also reads the costs of its neighbors.
  const int tile_disparities = std::min(sizeof(Sum) == 2 ? 256 : 32, count);
  const int tile_columns = std::min(std::max(48, 2 * inputs.longest_arm_px), width);
  const int tiles_across = (width + tile_columns - 1) / tile_columns;
  const int tiles_deep = (count + tile_disparities - 1) / tile_disparities;
  rings.prepare(
      [&](Ring<Sum>& ring) { ring.resize(tile_columns, tile_disparities, inputs.longest_arm_px); });
  tbb::parallel_for(0, tiles_across * tiles_deep, [&](int index) {
    const int x = index / tiles_deep * tile_columns;
    const int d = index % tiles_deep * tile_disparities;
    const Tile tile{{x, std::min(x + tile_columns, width)},
                    {d, std::min(d + tile_disparities, count)}};
    TileAggregator<Cost, Sum>(inputs, tile, rings.local()).run(aggregated);
  });
}

/// Returns whether 16 bits suffice for the sum on an arm with its center and for the low bits of a
/// region, and 8 bits for the high bits and for the number of pixels.
bool fit16Bits(int longest_arm_px, int max_cost) {
  const int span = 2 * longest_arm_px + 1;
  return span <= 15 && (longest_arm_px + 1) * max_cost <= 0xffff &&
         span * span * max_cost >> 12 <= 0xff;
}

}  // namespace

class CostAggregator::Impl {
 public:
  template <typename Cost>
  void aggregate(const Volume<Cost>& costs, int max_cost, const SupportArms& arms, View view,
                 const DisparityRange& range, AggregatedVolume& aggregated) {
    const cv::Size size(costs.width(), costs.height());
    CV_Assert(arms.reference.type() == CV_8UC4 && arms.reference.size() == size);
    CV_Assert(arms.other.type() == CV_8UC4 && arms.other.size() == size);
    CV_Assert(costs.disparities() == range.count && max_cost <= 16383);

    aggregated.resize(costs.height(), costs.width(), costs.disparities());
    other_arms_.assign(arms.other, view, range);
    const Inputs<Cost> inputs{costs, arms.reference, other_arms_, arms.longest_px};
    if (fit16Bits(arms.longest_px, max_cost)) {
      aggregateTiles(inputs, short_rings_, aggregated);
    } else {
      aggregateTiles(inputs, long_rings_, aggregated);
    }
  }

 private:
  MatchingArms other_arms_;
  PerThread<Ring<std::uint16_t>> short_rings_;
  PerThread<Ring<std::uint32_t>> long_rings_;
};

double CostAggregator::bytesPerThread(double width, double disparities, int longest_arm_px) {
  const double columns = std::min(width, std::max(48.0, 2.0 * longest_arm_px));
  const double bytes_of_column = 2 * sizeof(std::uint16_t) * std::min(disparities + 64, 256.0);
  return (2 * longest_arm_px + 1) * columns * bytes_of_column;
}

CostAggregator::CostAggregator() : impl_(std::make_unique<Impl>()) {}
CostAggregator::~CostAggregator() = default;

void CostAggregator::aggregate(const AggregatedVolume& costs, int max_cost, const SupportArms& arms,
                               View view, const DisparityRange& range,
                               AggregatedVolume& aggregated) {
  CV_Assert(&costs != &aggregated);
  impl_->aggregate(costs, max_cost, arms, view, range, aggregated);
}

void CostAggregator::aggregate(const MatchingVolume& costs, int max_cost, const SupportArms& arms,
                               View view, const DisparityRange& range,
                               AggregatedVolume& aggregated) {
  impl_->aggregate(costs, std::min<int>(max_cost, kOutsideCost), arms, view, range, aggregated);
}

}  // namespace cbmv
#endif  // HWY_ONCE
