#include "cbmv_stereo/volume/volume_builder.h"

#include <algorithm>
#include <array>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/confidence/row_features.h"
#include "cbmv_stereo/matching/matcher_set.h"

namespace cbmv {
namespace {

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
  workspace.features.computeCodes(i, forest.quantizer);
  std::array<const std::uint8_t*, kFeatureCount> codes{};
  for (int f = 0; f < kFeatureCount; ++f) {
    codes[f] = workspace.features.codes(f) + span.begin;
  }
  evaluator.evaluate(codes, span.end - span.begin, line + span.begin);
}

/// [d][x] to [x][d], in blocks that fit the first-level cache.
void transpose(const std::uint8_t* costs, int width, int disparities, std::uint8_t* row) {
  constexpr int kBlock = 64;
  for (int x0 = 0; x0 < width; x0 += kBlock) {
    const int x1 = std::min(width, x0 + kBlock);
    for (int i = 0; i < disparities; ++i) {
      for (int x = x0; x < x1; ++x) {
        row[static_cast<std::size_t>(x) * disparities + i] =
            costs[static_cast<std::size_t>(i) * width + x];
      }
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
