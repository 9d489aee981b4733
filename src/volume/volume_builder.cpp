#include "volume/volume_builder.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include <tbb/parallel_for.h>

#include "volume/row_scorer.h"

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

/// Transposes 16 × 16 bytes by four perfect shuffles. Each shuffle interleaves the upper half of
/// the rows with the lower half.
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

/// Requires at least one tile in both directions. The last tiles overlap the ones before.
void transposeTiles(const std::uint8_t* from, int rows, int columns, std::uint8_t* to) {
  for (int next_column = 0; next_column < columns; next_column += kTile) {
    const int column = std::min(next_column, columns - kTile);
    for (int next_row = 0; next_row < rows; next_row += kTile) {
      const int row = std::min(next_row, rows - kTile);
      transposeTile(from + static_cast<std::ptrdiff_t>(row) * columns + column, columns,
                    to + static_cast<std::ptrdiff_t>(column) * rows + row, rows);
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

/// Buffers for one image row, per thread.
struct RowWorkspace {
  RowScorer scorer;
  std::vector<std::uint8_t> costs;  ///< [d][x]
};

std::size_t hypothesesOfRow(int width, const DisparityRange& range) {
  return static_cast<std::size_t>(width) * range.count;
}

/// Transposes [row][column] to [column][row].
void transpose(const std::uint8_t* from, int rows, int columns, std::uint8_t* to) {
  constexpr int kTile = 16;
  if (rows >= kTile && columns >= kTile) {
    HWY_DYNAMIC_DISPATCH(transposeTiles)(from, rows, columns, to);
    return;
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      to[static_cast<std::ptrdiff_t>(column) * rows + row] =
          from[static_cast<std::ptrdiff_t>(row) * columns + column];
    }
  }
}

/// Moves the costs of one disparity from the left pixels to the right pixels.
void shiftLine(int width, int d, std::uint8_t* line) {
  const ColumnSpan span = matchedColumns(width, d);
  if (span.empty()) {
    std::fill_n(line, width, kOutsideCost);
    return;
  }
  std::memmove(line + span.begin - d, line + span.begin,
               static_cast<std::size_t>(span.end - span.begin));
  std::fill(line, line + span.begin - d, kOutsideCost);
  std::fill(line + span.end - d, line + width, kOutsideCost);
}

}  // namespace

MatcherSelection askedMatchers(const Forest& forest) {
  MatcherSelection asked;
  for (const ObliviousTree& tree : forest.trees) {
    for (const ObliviousTree::Level& level : tree.levels) {
      asked.set(level.feature / kFeaturesPerMatcher);
    }
  }
  for (const DecisionTree& tree : forest.general_trees) {
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
      if (!tree.isLeaf(n)) {
        asked.set(tree.nodes[n].feature / kFeaturesPerMatcher);
      }
    }
  }
  return asked;
}

class VolumeBuilder::Impl {
 public:
  SearchSpace row;  ///< the same for all rows
  RowEntries entries;
  MatcherSet matchers;
  PerThread<RowWorkspace> workspaces;
};

double VolumeBuilder::bytesPerThread(double width, double disparities, bool shifts) {
  const double entries = 1.2;
  const double costs = 1 + 4 + 2 + 2;  // of the four matchers
  const double terms_census_and_ncc = 200;
  return width * ((entries + costs + (shifts ? 1 : 0)) * disparities + terms_census_and_ncc);
}

VolumeBuilder::VolumeBuilder() : impl_(std::make_unique<Impl>()) {}
VolumeBuilder::~VolumeBuilder() = default;

void VolumeBuilder::build(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
                          const Forest& forest, const ForestEvaluator& evaluator,
                          MatchingVolume& volume) {
  const int width = left.cols;
  volume.resize(left.rows, width, range.count);
  const Scoring scoring{impl_->matchers, forest, evaluator, askedMatchers(forest)};
  impl_->matchers.prepare(left, right, scoring.asked);
  impl_->row.buildExhaustive(1, width, range);
  const RowEntries& entries = impl_->entries;
  impl_->entries.build(impl_->row, 0);
  impl_->workspaces.prepare([&](RowWorkspace& workspace) {
    workspace.scorer.reserve(scoring, width, entries.count());
    workspace.costs.resize(hypothesesOfRow(width, range));
  });
  tbb::parallel_for(0, left.rows, [&](int y) {
    RowWorkspace& workspace = impl_->workspaces.local();
    std::fill(workspace.costs.begin(), workspace.costs.end(), kOutsideCost);
    workspace.scorer.score(
        scoring, y, width, entries, [&](const RowEntries::Entry& entry, const std::uint8_t* costs) {
          const int i = entry.column - entry.right_column - range.min;
          std::copy_n(costs, std::min(kTileColumns, width - entry.column),
                      &workspace.costs[static_cast<std::size_t>(i) * width + entry.column]);
        });
    transpose(workspace.costs.data(), range.count, width, volume.row(y));
  });
}

void shiftToRightView(const DisparityRange& range, MatchingVolume& volume,
                      PerThread<std::vector<std::uint8_t>>& rows) {
  const int width = volume.width();
  rows.prepare([&](auto& row) { row.resize(hypothesesOfRow(width, range)); });
  tbb::parallel_for(0, volume.height(), [&](int y) {
    std::vector<std::uint8_t>& lines = rows.local();  // [d][x]
    transpose(volume.row(y), width, range.count, lines.data());
    for (int i = 0; i < range.count; ++i) {
      shiftLine(width, range.min + i, &lines[static_cast<std::size_t>(i) * width]);
    }
    transpose(lines.data(), range.count, width, volume.row(y));
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
