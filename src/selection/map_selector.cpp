#include "selection/map_selector.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "refinement/median_filter.h"
#include "selection/confidence_scaling.h"
#include "selection/thin_pixels.h"

namespace cbmv {
namespace {

constexpr float kNoSigma = std::numeric_limits<float>::quiet_NaN();
constexpr float kBytes = 255.0F;
constexpr int kMedianSizePx = 3;

}  // namespace

double MapSelector::memoryBytes(double pixels, double width, double threads, bool replaces) {
  const double planes = 1 + 1 + 2 + 1 + 2 + 1;
  const double cells = (5 * 3 + 2) * 4.0 / 16;  // means over windows and sums
  const double confidence_and_bins = 1 + 1;
  const double sigma = 4;
  const double row = 5 * (4 + 4);
  const double judging =
      pixels * (planes + cells + confidence_and_bins + sigma) + threads * width * row;
  if (!replaces) {
    return judging;
  }
  const double support_cells = (2 + 2) * 4.0 / 16;
  const double wide_and_padded = 2 + 2 + 2;
  const double neighbors = 2 * (2 + 1);
  const double median = 4;
  const double row_of_proposals = 3 * (4 + 4) + 2 * (2 + 1);
  return judging + pixels * (support_cells + wide_and_padded + neighbors + median) +
         threads * width * row_of_proposals;
}

MapSelector::MapSelector(std::shared_ptr<const Forest> forest)
    : forest_(std::move(forest)), confidence_(*forest_->confidence, forest_->name) {
  if (forest_->selection != nullptr) {
    requireFeatures(*forest_->selection, "selection", selectionFeatureNames(), forest_->name);
    evaluator_.emplace(*forest_->selection);
  }
}

void MapSelector::select(const JudgedMaps& judged, const SelectionOptions& options,
                         const SelectedMaps& maps) {
  const bool replaces = options.replace && evaluator_.has_value();
  tabulate(options);
  confidence_.estimate(judged);
  if (forest_->confidence->hasSigma()) {
    maps.disparity_sigma.create(maps.disparity.size(), CV_32FC1);
  } else {
    maps.disparity_sigma.release();
  }
  if (replaces) {
    planes_.prepare(confidence_.planes(), confidence_.confidence());
    rows_.prepare([&](Row& row) {
      row.features.resize(maps.disparity.cols);
      row.codes.reserve(*forest_->selection);
    });
  }
  tbb::parallel_for(0, maps.disparity.rows, [&](int y) {
    fillRow(y, judged.range.invalid(), maps);
    if (replaces) {
      selectRow(judged, y, options.fill, maps, rows_.local());
    }
  });
  if (replaces) {
    medianFilter(maps.disparity, judged.range, kMedianSizePx, median_padded_, filtered_);
    filtered_.copyTo(maps.disparity);  // no swap: others may share the memory of the map
  }
}

void MapSelector::tabulate(const SelectionOptions& options) {
  sigma_scale_ = options.sigma_scale;
  const bool as_trained = options.confidence_scale == 1.0F && options.confidence_shift == 0.0F;
  for (std::size_t byte = 0; byte < published_.size(); ++byte) {
    const float trained = static_cast<float>(byte) / kBytes;
    published_[byte] =
        as_trained ? trained
                   : static_cast<float>(scaledConfidence(
                         logOddsOf(trained), options.confidence_scale, options.confidence_shift));
  }
}

float MapSelector::sigmaPx(int y, int x, std::uint8_t probability) const {
  const std::uint8_t bin = confidence_.roughnessBins().at<std::uint8_t>(y, x);
  return sigma_scale_ * forest_->confidence->sigmaPx(bin, probability);
}

/// What the confidence forest says.
void MapSelector::fillRow(int y, float invalid, const SelectedMaps& maps) const {
  const auto* bytes = confidence_.confidence().ptr<std::uint8_t>(y);
  const auto* disparity = maps.disparity.ptr<float>(y);
  auto* confidence = maps.confidence.ptr<float>(y);
  for (int x = 0; x < maps.disparity.cols; ++x) {
    confidence[x] = disparity[x] == invalid ? 0.0F : published_[bytes[x]];
  }
  if (!maps.disparity_sigma.empty()) {
    auto* sigma = maps.disparity_sigma.ptr<float>(y);
    for (int x = 0; x < maps.disparity.cols; ++x) {
      sigma[x] = disparity[x] == invalid ? kNoSigma : sigmaPx(y, x, bytes[x]);
    }
  }
}

void MapSelector::selectRow(const JudgedMaps& judged, int y, bool fill, const SelectedMaps& maps,
                            Row& row) {
  constexpr int kBlock = SelectionFeatures::kBlock;
  const int width = maps.disparity.cols;
  if (!isAnyImprobable(y, 0, width, fill)) {
    return;
  }
  row.features.startRow(
      confidence_.planes(), planes_,
      judged.right_disparity.empty() ? nullptr : judged.right_disparity.ptr<float>(y),
      judged.range.invalid(), y);
  row.blocks = 0;
  for (int x = 0; x < width; x += kBlock) {
    const int count = std::min(kBlock, width - x);
    if (!isAnyImprobable(y, x, count, fill)) {
      continue;
    }
    SelectionFeatures::Proposals& proposals = row.proposals[row.blocks];
    row.features.propose(x, count, proposals);
    bool changes = false;
    for (int i = 0; i < count && !changes; ++i) {
      changes = canChange(y, x + i, proposals, fill, i);
    }
    if (!changes) {
      continue;
    }
    row.features.code(x, count, proposals, row.blocks, row.codes);
    row.first_pixels[row.blocks] = x;
    if (++row.blocks == SelectionFeatures::kSlots) {
      chooseInBlocks(y, fill, maps, row);
    }
  }
  chooseInBlocks(y, fill, maps, row);
}

/// Is there anything to choose for pixel `i` of a block, the one in column `x`?
bool MapSelector::canChange(int y, int x, const SelectionFeatures::Proposals& proposals, bool fill,
                            int i) const {
  if (!isImprobable(y, x, fill)) {
    return false;
  }
  const bool has_own = hasDisparity(proposals[0][i]);
  bool is_any_new = false;
  for (int p = 1; p < kSources; ++p) {
    is_any_new = is_any_new || SelectionFeatures::isNew(proposals, p, i, has_own);
  }
  return is_any_new;
}

/// May the disparity of a pixel be replaced?
bool MapSelector::isImprobable(int y, int x, bool fill) const {
  return confidence_.confidence().at<std::uint8_t>(y, x) < ConfidentNeighbors::kConfident &&
         (fill || hasDisparity(confidence_.planes().disparity.at<std::int16_t>(y, x)));
}

/// A thin object has few pixels to support it, so its background looks more probable.
bool MapSelector::isThinObject(int y, int x) const {
  const MapPlanes& planes = confidence_.planes();
  return planes.unmatched.at<std::uint8_t>(y, x) == 0 && isThin(planes.disparity, y, x);
}

/// Of the `count` pixels from `x` on.
bool MapSelector::isAnyImprobable(int y, int x, int count, bool fill) const {
  for (const int end = x + count; x < end; ++x) {
    if (isImprobable(y, x, fill)) {
      return true;
    }
  }
  return false;
}

void MapSelector::chooseInBlocks(int y, bool fill, const SelectedMaps& maps, Row& row) const {
  if (row.blocks == 0) {
    return;
  }
  evaluator_->score(row.codes, SelectionFeatures::query(kSources, 0, 0), row.scores.data());
  for (int block = 0; block < row.blocks; ++block) {
    const int x = row.first_pixels[block];
    const int count = std::min(SelectionFeatures::kBlock, maps.disparity.cols - x);
    for (int i = 0; i < count; ++i) {
      if (canChange(y, x + i, row.proposals[block], fill, i)) {
        choose(y, row, block, i, maps);
      }
    }
  }
  row.blocks = 0;
}

/// The first of the most probable proposals, of those at `least` or more; −1 if there is none.
int MapSelector::mostProbable(const Row& row, int block, int i, int least) const {
  const SelectionFeatures::Proposals& proposals = row.proposals[block];
  const auto score = [&](int p) { return row.scores[SelectionFeatures::query(p, block, i)]; };
  const bool has_own = hasDisparity(proposals[0][i]);
  int best = has_own ? 0 : -1;
  for (int p = 1; p < kSources; ++p) {
    if (proposals[p][i] >= least && SelectionFeatures::isNew(proposals, p, i, has_own) &&
        (best < 0 || score(p) > score(best))) {
      best = p;
    }
  }
  return best;
}

void MapSelector::choose(int y, const Row& row, int block, int i, const SelectedMaps& maps) const {
  const SelectionFeatures::Proposals& proposals = row.proposals[block];
  const int x = row.first_pixels[block] + i;
  const int own = proposals[0][i];
  int best = mostProbable(row, block, i, INT16_MIN);
  if (hasDisparity(own) && proposals[best][i] < own && isThinObject(y, x)) {
    best = mostProbable(row, block, i, own);
  }
  const std::uint8_t byte =
      evaluator_->probabilityByte(row.scores[SelectionFeatures::query(best, block, i)]);
  maps.confidence.at<float>(y, x) = published_[byte];
  if (best != 0) {
    maps.disparity.at<float>(y, x) =
        static_cast<float>(proposals[best][i]) / static_cast<float>(kPlaneUnitsPerPx);
  }
  if (!maps.disparity_sigma.empty()) {
    maps.disparity_sigma.at<float>(y, x) = sigmaPx(y, x, byte);
  }
}

}  // namespace cbmv
