#include "cbmv_stereo/volume/volume_builder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/confidence/row_features.h"
#include "cbmv_stereo/matching/matcher_set.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/volume_builder.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kTile = 16;
using TileRow = hn::FixedTag<std::uint8_t, kTile>;

/// Transposes 16 × 16 bytes by four perfect shuffles: each interleaves the upper half of the rows
/// with the lower one.
HWY_INLINE void transposeTile(const std::uint8_t* from, int from_stride, std::uint8_t* to,
                              int to_stride) {
  const TileRow row;
  alignas(16) std::uint8_t tiles[2][kTile][kTile];
  for (int r = 0; r < kTile; ++r) {
    hn::Store(hn::LoadU(row, from + static_cast<std::ptrdiff_t>(r) * from_stride), row,
              tiles[0][r]);
  }
  for (int round = 0; round < 4; ++round) {
    const auto& before = tiles[round % 2];
    auto& after = tiles[(round + 1) % 2];
    for (int r = 0; r < kTile / 2; ++r) {
      const auto upper = hn::Load(row, before[r]);
      const auto lower = hn::Load(row, before[r + kTile / 2]);
      hn::Store(hn::InterleaveLower(row, upper, lower), row, after[2 * r]);
      hn::Store(hn::InterleaveUpper(row, upper, lower), row, after[2 * r + 1]);
    }
  }
  for (int r = 0; r < kTile; ++r) {
    hn::StoreU(hn::Load(row, tiles[0][r]), row, to + static_cast<std::ptrdiff_t>(r) * to_stride);
  }
}

/// [d][x] to [x][d]; at least a tile in both directions. The last tiles overlap those before.
void transposeTiles(const std::uint8_t* costs, int width, int disparities, std::uint8_t* row) {
  for (int next_x = 0; next_x < width; next_x += kTile) {
    const int x = std::min(next_x, width - kTile);
    for (int next_i = 0; next_i < disparities; next_i += kTile) {
      const int i = std::min(next_i, disparities - kTile);
      transposeTile(costs + static_cast<std::ptrdiff_t>(i) * width + x, width,
                    row + static_cast<std::ptrdiff_t>(x) * disparities + i, disparities);
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

HWY_EXPORT(transposeTiles);

/// Buffers of one thread for one image row.
struct RowWorkspace {
  RowFeatures features;
  std::vector<std::uint8_t> costs;  ///< [d][x]
};

/// Costs of the hypotheses of one disparity of the row: features, their codes, the forest.
void scoreLine(const Forest& forest, const ForestEvaluator& evaluator, int width, int d, int i,
               RowWorkspace& workspace) {
  const ColumnSpan span = matchedColumns(width, d);
  std::uint8_t* line = workspace.costs.data() + static_cast<std::size_t>(i) * width;
  std::fill_n(line, width, kOutsideCost);
  if (span.empty()) {
    return;
  }
  RowFeatures& features = workspace.features;
  const auto evaluate = [&](auto line_of) {
    std::array<decltype(line_of(0)), kFeatureCount> lines{};
    for (int f = 0; f < kFeatureCount; ++f) {
      lines[f] = line_of(f) + span.begin;
    }
    evaluator.evaluate(lines, span.end - span.begin, line + span.begin);
  };
  if (evaluator.wantsValues()) {
    features.compute(i);
    evaluate([&](int f) { return features.line(f); });
  } else {
    features.computeCodes(i, forest.quantizer);
    evaluate([&](int f) { return features.codes(f); });
  }
}

/// [d][x] to [x][d]
void transpose(const std::uint8_t* costs, int width, int disparities, std::uint8_t* row) {
  constexpr int kTile = 16;
  if (width >= kTile && disparities >= kTile) {
    HWY_DYNAMIC_DISPATCH(transposeTiles)(costs, width, disparities, row);
    return;
  }
  for (int i = 0; i < disparities; ++i) {
    for (int x = 0; x < width; ++x) {
      row[static_cast<std::ptrdiff_t>(x) * disparities + i] =
          costs[static_cast<std::ptrdiff_t>(i) * width + x];
    }
  }
}

}  // namespace

class VolumeBuilder::Impl {
 public:
  MatcherSet matchers;
  tbb::enumerable_thread_specific<RowWorkspace> workspaces;
};

VolumeBuilder::VolumeBuilder() : impl_(std::make_unique<Impl>()) {}
VolumeBuilder::~VolumeBuilder() = default;

void VolumeBuilder::build(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
                          const Forest& forest, const ForestEvaluator& evaluator,
                          MatchingVolume& volume) {
  const int width = left.cols;
  volume.resize(left.rows, width, range.count);
  impl_->matchers.prepare(left, right);
  tbb::parallel_for(0, left.rows, [&](int y) {
    RowWorkspace& workspace = impl_->workspaces.local();
    workspace.costs.resize(static_cast<std::size_t>(width) * range.count);
    workspace.features.prepareRow(impl_->matchers, y, width, range);
    for (int i = 0; i < range.count; ++i) {
      scoreLine(forest, evaluator, width, range.min + i, i, workspace);
    }
    transpose(workspace.costs.data(), width, range.count, volume.row(y));
  });
}

void shiftToRightView(const DisparityRange& range, MatchingVolume& volume) {
  tbb::parallel_for(0, volume.height(), [&](int y) {
    std::vector<std::uint8_t> left(
        volume.row(y), volume.row(y) + static_cast<std::size_t>(volume.width()) * range.count);
    for (int x = 0; x < volume.width(); ++x) {
      std::uint8_t* costs = volume.pixel(y, x);
      for (int i = 0; i < range.count; ++i) {
        const int left_x = matchingColumn(View::kRight, x, range.min + i);
        const bool inside = left_x >= 0 && left_x < volume.width();
        costs[i] = inside ? left[static_cast<std::size_t>(left_x) * range.count + i] : kOutsideCost;
      }
    }
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
