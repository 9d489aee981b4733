#include "volume/windowed_volume_builder.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include <tbb/parallel_for.h>

#include "base/per_thread.h"
#include "volume/row_scorer.h"
#include "volume/volume_builder.h"

namespace cbmv {
namespace {

/// Buffers per thread.
struct RowWorkspace {
  RowEntries entries;
  RowScorer scorer;
};

void scoreRow(const Scoring& scoring, const SearchSpace& space, int y, RowWorkspace& workspace,
              WindowedMatchingVolume& volume) {
  RowEntries& entries = workspace.entries;
  entries.build(space, y);
  std::uint8_t* costs_of_row = volume.entry(space.tile(y, 0).first_entry);
  const auto costs_of = [=](std::int32_t number) {
    return costs_of_row + static_cast<std::ptrdiff_t>(number) * kTileColumns;
  };
  for (const std::int32_t number : entries.outside()) {
    std::fill_n(costs_of(number), kTileColumns, kOutsideCost);
  }
  workspace.scorer.score(scoring, y, space.width(), entries,
                         [=](const RowEntries::Entry& entry, const std::uint8_t* costs) {
                           std::memcpy(costs_of(entry.number), costs, kTileColumns);
                         });
}

}  // namespace

class WindowedVolumeBuilder::Impl {
 public:
  MatcherSet matchers;
  PerThread<RowWorkspace> workspaces;
};

WindowedVolumeBuilder::WindowedVolumeBuilder() : impl_(std::make_unique<Impl>()) {}
WindowedVolumeBuilder::~WindowedVolumeBuilder() = default;

void WindowedVolumeBuilder::build(const cv::Mat& left, const cv::Mat& right,
                                  const SearchSpace& space, const Forest& forest,
                                  const ForestEvaluator& evaluator,
                                  WindowedMatchingVolume& volume) {
  volume.resize(space);
  const Scoring scoring{impl_->matchers, forest, evaluator, askedMatchers(forest)};
  impl_->matchers.prepare(left, right, scoring.asked);
  const std::size_t most = mostEntriesOfRow(space);
  impl_->workspaces.prepare([&](RowWorkspace& workspace) {
    workspace.entries.reserve(space.range(), most);
    workspace.scorer.reserve(scoring, space.width(), most);
  });
  tbb::parallel_for(0, space.height(),
                    [&](int y) { scoreRow(scoring, space, y, impl_->workspaces.local(), volume); });
}

}  // namespace cbmv
