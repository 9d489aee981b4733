#include "cbmv_stereo/selection/map_selector.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "cbmv_stereo/refinement/median_filter.h"

namespace cbmv {
namespace {

constexpr float kNoSigma = std::numeric_limits<float>::quiet_NaN();
constexpr float kBytes = 255.0F;
constexpr int kMedianSizePx = 3;

bool isUnsure(std::uint8_t confidence) { return confidence < ConfidentNeighbors::kConfident; }

}  // namespace

MapSelector::MapSelector(std::shared_ptr<const Forest> forest)
    : forest_(std::move(forest)), confidence_(*forest_->confidence, forest_->name) {
  if (forest_->selection != nullptr) {
    requireFeatures(*forest_->selection, "selection", selectionFeatureNames(), forest_->name);
    evaluator_.emplace(*forest_->selection);
  }
}

void MapSelector::select(const JudgedMaps& judged, bool fill, const SelectedMaps& maps) {
  confidence_.estimate(judged);
  if (forest_->confidence->hasSigma()) {
    maps.disparity_sigma.create(maps.disparity.size(), CV_32FC1);
  } else {
    maps.disparity_sigma.release();
  }
  if (evaluator_.has_value()) {
    planes_.prepare(confidence_.planes(), confidence_.confidence());
    rows_.prepare([&](Row& row) {
      row.features.resize(maps.disparity.cols);
      row.codes.reserve(*forest_->selection);
    });
  }
  tbb::parallel_for(0, maps.disparity.rows, [&](int y) {
    fillRow(y, judged.range.invalid(), maps);
    if (evaluator_.has_value()) {
      selectRow(judged, y, fill, maps, rows_.local());
    }
  });
  if (evaluator_.has_value()) {
    medianFilter(maps.disparity, judged.range, kMedianSizePx, median_padded_, filtered_);
    filtered_.copyTo(maps.disparity);  // no swap: others may share the memory of the map
  }
}

/// What the confidence forest says.
void MapSelector::fillRow(int y, float invalid, const SelectedMaps& maps) const {
  const auto* bytes = confidence_.confidence().ptr<std::uint8_t>(y);
  const auto* disparity = maps.disparity.ptr<float>(y);
  auto* confidence = maps.confidence.ptr<float>(y);
  for (int x = 0; x < maps.disparity.cols; ++x) {
    confidence[x] = disparity[x] == invalid ? 0.0F : static_cast<float>(bytes[x]) / kBytes;
  }
  if (!maps.disparity_sigma.empty()) {
    const auto* bins = confidence_.roughnessBins().ptr<std::uint8_t>(y);
    auto* sigma = maps.disparity_sigma.ptr<float>(y);
    for (int x = 0; x < maps.disparity.cols; ++x) {
      sigma[x] =
          disparity[x] == invalid ? kNoSigma : forest_->confidence->sigmaPx(bins[x], bytes[x]);
    }
  }
}

void MapSelector::selectRow(const JudgedMaps& judged, int y, bool fill, const SelectedMaps& maps,
                            Row& row) {
  constexpr int kBlock = SelectionFeatures::kBlock;
  const auto* bytes = confidence_.confidence().ptr<std::uint8_t>(y);
  const int width = maps.disparity.cols;
  if (std::none_of(bytes, bytes + width, isUnsure)) {
    return;
  }
  row.features.startRow(
      confidence_.planes(), planes_,
      judged.right_disparity.empty() ? nullptr : judged.right_disparity.ptr<float>(y),
      judged.range.invalid(), y);
  const auto* disparity = maps.disparity.ptr<float>(y);
  for (int x = 0; x < width; x += kBlock) {
    const int count = std::min(kBlock, width - x);
    if (std::none_of(bytes + x, bytes + x + count, isUnsure)) {
      continue;
    }
    row.features.code(x, count, row.proposals, row.codes);
    evaluator_->score(row.codes, kBlock * (kSources - 1) + count, row.scores.data());
    for (int i = 0; i < count; ++i) {
      const bool has_disparity = disparity[x + i] != judged.range.invalid();
      if (isUnsure(bytes[x + i]) && (fill || has_disparity)) {
        choose(y, x + i, row, i, has_disparity, maps);
      }
    }
  }
}

/// Proposals within 1 px of the pixel's own disparity say nothing new.
void MapSelector::choose(int y, int x, const Row& row, int i, bool has_disparity,
                         const SelectedMaps& maps) const {
  constexpr int kBlock = SelectionFeatures::kBlock;
  const int own = row.proposals[0][i];
  int best = has_disparity ? 0 : -1;
  for (int p = 1; p < kSources; ++p) {
    const int proposal = row.proposals[p][i];
    const bool is_new = proposal != ConfidentNeighbors::kNoNeighbor &&
                        (!has_disparity || std::abs(proposal - own) > kPlaneUnitsPerPx);
    if (is_new && (best < 0 || row.scores[p * kBlock + i] > row.scores[best * kBlock + i])) {
      best = p;
    }
  }
  if (best < 0) {
    return;
  }
  const std::uint8_t byte = evaluator_->probabilityByte(row.scores[best * kBlock + i]);
  maps.confidence.at<float>(y, x) = static_cast<float>(byte) / kBytes;
  if (best != 0) {
    maps.disparity.at<float>(y, x) =
        static_cast<float>(row.proposals[best][i]) / static_cast<float>(kPlaneUnitsPerPx);
  }
  if (!maps.disparity_sigma.empty()) {
    maps.disparity_sigma.at<float>(y, x) =
        forest_->confidence->sigmaPx(confidence_.roughnessBins().at<std::uint8_t>(y, x), byte);
  }
}

}  // namespace cbmv
