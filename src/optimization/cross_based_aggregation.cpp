#include "cbmv_stereo/optimization/cross_based_aggregation.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <tbb/parallel_for.h>

#include "matching_row.h"

namespace cbmv {
namespace {

/// A tile takes this many disparities of a pixel at a time: one cache line of costs.
constexpr int kTileDisparities = 32;
constexpr int kMinTileColumns = 32;
/// Up to these arms, 31² costs of at most 16383 add up to less than 2^24.
constexpr int kMaxFloatArm = 15;

/// Channels of the arms.
enum Arm { kLeftArm = 0, kRightArm = 1, kUpArm = 2, kDownArm = 3 };

/// One element per disparity of the tile.
template <typename Value>
using Lane = std::array<Value, kTileDisparities>;

/// Sum of the costs of a region in the low 32 bits, its number of pixels in the high ones: both are
/// added and subtracted at once. A sum has at most 509² pixels of at most 16383 each: it fits.
using Region = std::uint64_t;

Region makeRegion(std::uint32_t sum, std::uint32_t pixels) {
  return (static_cast<Region>(pixels) << 32) + sum;
}

/// Part of the volumes that is worked on at once: all rows of some columns and disparities.
struct Tile {
  cv::Range columns;
  cv::Range disparities;  // indices
};

/// Combined arms, in two opposite directions, of the hypotheses of a tile in one row.
class CombinedArms {
 public:
  CombinedArms(View view, const Tile& tile, const DisparityRange& range, Arm first, Arm second)
      : channels_{first, second},
        disparities_(tile.disparities.size()),
        other_{MatchingRow<std::uint8_t>(view, tile.columns, part(range, tile)),
               MatchingRow<std::uint8_t>(view, tile.columns, part(range, tile))} {}

  void fillRow(const cv::Mat& reference_arms, const cv::Mat& other_arms, int y) {
    reference_ = reference_arms.ptr<cv::Vec4b>(y);
    const auto* other = other_arms.ptr<cv::Vec4b>(y);
    for (std::size_t i = 0; i < 2; ++i) {
      const int channel = channels_[i];
      // No arms outside of the other image: the region of such a hypothesis is itself, a copy.
      other_[i].fill(other_arms.cols, 0,
                     [other, channel](int column) { return other[column][channel]; });
    }
  }

  void setPixel(int x) {
    for (std::size_t i = 0; i < 2; ++i) {
      shorter(reference_[x][channels_[i]], other_[i].hypotheses(x), disparities_,
              lengths_[i].data());
    }
  }

  int first(int d) const { return lengths_[0][d]; }
  int second(int d) const { return lengths_[1][d]; }

 private:
  static void shorter(std::uint8_t reference, const std::uint8_t* __restrict other, int count,
                      std::uint8_t* __restrict lengths) {
    for (int d = 0; d < count; ++d) {
      lengths[d] = std::min(reference, other[d]);
    }
  }

  static DisparityRange part(const DisparityRange& range, const Tile& tile) {
    return {range.min + tile.disparities.start, tile.disparities.size()};
  }

  std::array<Arm, 2> channels_;
  int disparities_;
  const cv::Vec4b* reference_ = nullptr;
  std::array<MatchingRow<std::uint8_t>, 2> other_;
  std::array<Lane<std::uint8_t>, 2> lengths_{};
};

struct Inputs {
  const OptimizedVolume& costs;
  const cv::Mat& reference_arms;
  const cv::Mat& other_arms;
  View view;
  DisparityRange range;
  int longest_arm_px;
};

/// Aggregates a tile from top to bottom: sums along the rows come from prefix sums over the
/// columns, regions from prefix sums of those over the rows, of which a ring holds as many as arms
/// can span.
class TileAggregator {
 public:
  TileAggregator(const Inputs& inputs, const Tile& tile)
      : inputs_(inputs),
        tile_(tile),
        disparities_(tile.disparities.size()),
        reach_(std::max(0, tile.columns.start - inputs.longest_arm_px),
               std::min(inputs.costs.width(), tile.columns.end + inputs.longest_arm_px)),
        ring_rows_(powerOfTwoFrom(2 * inputs.longest_arm_px + 2)),
        row_pitch_(tile.columns.size() + 1),
        row_prefix_(reach_.size() + 1),
        rows_above_(inputs.longest_arm_px + 1),
        rows_including_(inputs.longest_arm_px + 1),
        ring_(static_cast<std::size_t>(ring_rows_) * row_pitch_),
        horizontal_(inputs.view, tile, inputs.range, kLeftArm, kRightArm),
        vertical_(inputs.view, tile, inputs.range, kUpArm, kDownArm) {}

  void run(OptimizedVolume& aggregated) {
    const int height = inputs_.costs.height();
    const int delay = inputs_.longest_arm_px;
    for (int y = 0; y < height + delay; ++y) {
      if (y < height) {
        appendRow(y);
      }
      if (y >= delay) {
        if (inputs_.longest_arm_px <= kMaxFloatArm) {
          averageRow<float>(y - delay, aggregated);
        } else {
          averageRow<double>(y - delay, aggregated);
        }
      }
    }
  }

 private:
  static int powerOfTwoFrom(int least) {
    int power = 1;
    while (power < least) {
      power *= 2;
    }
    return power;
  }

  /// Regions of the tile's first `rows` rows, one Lane a column.
  Lane<Region>* regionsAbove(int rows) {
    return ring_.data() + static_cast<std::size_t>(rows & (ring_rows_ - 1)) * row_pitch_;
  }

  void sumPrefixes(int y) {
    for (int i = 0; i < reach_.size(); ++i) {
      addCosts(row_prefix_[i].data(),
               inputs_.costs.pixel(y, reach_.start + i) + tile_.disparities.start, disparities_,
               row_prefix_[i + 1].data());
    }
  }

  static void addCosts(const std::uint32_t* __restrict sums, const std::uint16_t* __restrict costs,
                       int count, std::uint32_t* __restrict new_sums) {
    for (int d = 0; d < count; ++d) {
      new_sums[d] = sums[d] + costs[d];
    }
  }

  void appendRow(int y) {
    sumPrefixes(y);
    horizontal_.fillRow(inputs_.reference_arms, inputs_.other_arms, y);
    const Lane<Region>* above = regionsAbove(y);
    Lane<Region>* including = regionsAbove(y + 1);
    for (int x = tile_.columns.start; x < tile_.columns.end; ++x, ++above, ++including) {
      horizontal_.setPixel(x);
      const Lane<std::uint32_t>* prefix = &row_prefix_[x - reach_.start];
      for (int d = 0; d < disparities_; ++d) {
        const int left = horizontal_.first(d);
        const int right = horizontal_.second(d);
        const std::uint32_t sum = prefix[right + 1][d] - prefix[-left][d];
        (*including)[d] = (*above)[d] + makeRegion(sum, left + 1 + right);
      }
    }
  }

  template <typename Real>
  void averageRow(int y, OptimizedVolume& aggregated) {
    vertical_.fillRow(inputs_.reference_arms, inputs_.other_arms, y);
    for (std::size_t arm = 0; arm < rows_above_.size(); ++arm) {
      const int length = static_cast<int>(arm);
      rows_above_[arm] = regionsAbove(y - length);
      rows_including_[arm] = regionsAbove(y + 1 + length);
    }
    for (int x = tile_.columns.start; x < tile_.columns.end; ++x) {
      vertical_.setPixel(x);
      Lane<Region> regions;
      const int column = x - tile_.columns.start;
      for (int d = 0; d < disparities_; ++d) {
        regions[d] = rows_including_[vertical_.second(d)][column][d] -
                     rows_above_[vertical_.first(d)][column][d];
      }
      average<Real>(regions, aggregated.pixel(y, x) + tile_.disparities.start);
    }
  }

  /// Division of floating-point numbers vectorises and is exact here: where integers below 2^n
  /// (n = 24 for float, 53 for double) do not divide evenly, their quotient is further below the
  /// next whole number than rounding can lift it.
  template <typename Real>
  void average(const Lane<Region>& regions, std::uint16_t* means) const {
    using Integer = std::conditional_t<std::is_same_v<Real, float>, std::int32_t, std::uint32_t>;
    for (int d = 0; d < disparities_; ++d) {
      const auto sum = static_cast<Integer>(regions[d]);
      const auto pixels = static_cast<Integer>(regions[d] >> 32);
      const Integer half_up = sum + pixels / 2;
      const Real mean = static_cast<Real>(half_up) / static_cast<Real>(pixels);
      means[d] = static_cast<std::uint16_t>(static_cast<int>(mean));
    }
  }

  const Inputs& inputs_;
  const Tile tile_;
  const int disparities_;
  const cv::Range reach_;  // columns that arms of the tile can reach
  const int ring_rows_;
  /// Of the ring, in columns. A power of two would have all its rows compete for one part of the
  /// cache.
  const int row_pitch_;
  std::vector<Lane<std::uint32_t>> row_prefix_;
  std::vector<const Lane<Region>*> rows_above_;      // of the current row less an arm, by arm
  std::vector<const Lane<Region>*> rows_including_;  // of the current row plus an arm, by arm
  std::vector<Lane<Region>> ring_;
  CombinedArms horizontal_;
  CombinedArms vertical_;
};

}  // namespace

void aggregateCosts(const OptimizedVolume& costs, const cv::Mat& reference_arms,
                    const cv::Mat& other_arms, View view, const DisparityRange& range,
                    OptimizedVolume& aggregated) {
  const cv::Size size(costs.width(), costs.height());
  CV_Assert(reference_arms.type() == CV_8UC4 && reference_arms.size() == size);
  CV_Assert(other_arms.type() == CV_8UC4 && other_arms.size() == size);
  CV_Assert(costs.disparities() == range.count && &costs != &aggregated);

  aggregated.resize(costs.height(), costs.width(), costs.disparities());
  double longest_arm_px = 0;
  cv::minMaxIdx(reference_arms.reshape(1), nullptr, &longest_arm_px);
  const Inputs inputs{costs, reference_arms, other_arms,
                      view,  range,          static_cast<int>(longest_arm_px)};
  // At least twice the arms, lest a tile mostly sums up columns of its neighbours.
  const int tile_columns = std::max(kMinTileColumns, 2 * inputs.longest_arm_px);
  const int tiles_across = (size.width + tile_columns - 1) / tile_columns;
  const int tiles_deep = (range.count + kTileDisparities - 1) / kTileDisparities;
  tbb::parallel_for(0, tiles_across * tiles_deep, [&](int index) {
    const int x = index / tiles_deep * tile_columns;
    const int d = index % tiles_deep * kTileDisparities;
    const Tile tile{{x, std::min(x + tile_columns, size.width)},
                    {d, std::min(d + kTileDisparities, range.count)}};
    TileAggregator(inputs, tile).run(aggregated);
  });
}

}  // namespace cbmv
