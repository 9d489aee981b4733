#include "selection/selection_features.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#ifndef CBMV_SELECTION_FEATURES_ONCE
#define CBMV_SELECTION_FEATURES_ONCE
namespace cbmv {
namespace {

/// Features in the order of selectionFeatureNames.
enum ProposalFeature {
  kChange,
  kLeftRight,
  kBorder,
  kDistance,
  kSource,
  kSupport5,
  kWeightedSupport5,
  kSupport17,
  kWeightedSupport17,
  kConfidence,
  kConfidence5,
  kConfidence12,
  kConfidence20,
  kUnmatched,
  kUnmatched5,
  kProbability5,
  kOwnSupport5,
  kOwnWeightedSupport17,
  kFeatures
};

/// Features of the pixel, which are the same for all proposals.
constexpr std::array<int, 7> kSharedFeatures = {kConfidence,   kConfidence5, kConfidence12,
                                                kConfidence20, kUnmatched,   kUnmatched5,
                                                kProbability5};
constexpr int kPatternSide = 5;
constexpr int kCodePerSource = 60;
constexpr int kBlock = SelectionFeatures::kBlock;
/// Disparities within this distance support each other, in units of the disparity plane.
constexpr int kNear = kPlaneUnitsPerPx;

/// Sums over the pixels of a pattern around the pixels of a block, [source][pixel].
struct Support {
  std::array<std::array<std::int16_t, kBlock>, kSources> count;
  std::array<std::array<std::int16_t, kBlock>, kSources> weight;
  std::array<std::int16_t, kBlock> total_weight;
};

/// Rows of the padded maps for a pattern of 5 × 5 pixels, at the first pixel of the block.
struct PatternRows {
  std::array<const std::int16_t*, kPatternSide> disparity;
  std::array<const std::int16_t*, kPatternSide> confidence;
  int step;  ///< px between the pixels of the pattern
};

/// Inputs for the codes of a block, from its first pixel on.
struct ProposalBlock {
  int x;
  int count;
  int width;
  const std::uint8_t* confidence;
  const std::uint8_t* unmatched;
  const std::int32_t* confidence_sums;
  const std::int32_t* unmatched_sums;
  const std::int32_t* probability_sums;
  std::array<const std::int32_t*, 2> confidence_cells;
  const float* right_disparity;  ///< the whole row; null: unknown
  float right_invalid;
  std::array<const std::uint8_t*, kSources> distances;  ///< null for the pixel itself
  PatternRows near;
  PatternRows far;
};

}  // namespace
}  // namespace cbmv
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "selection/selection_features.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "selection/code_lines-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using PixelTag = hn::CappedTag<std::int16_t, 16>;

/// Calls f(disparities, confidences) for each pixel of the pattern around one vector of pixels from
/// `begin` on. Pixels beyond the row read the padding.
template <class F>
HWY_INLINE void forPattern(const PatternRows& rows, int begin, const F& f) {
  const PixelTag tag;
  for (int dy = 0; dy < kPatternSide; ++dy) {
    for (int dx = 0; dx < kPatternSide; ++dx) {
      const int x = begin + (dx - kPatternSide / 2) * rows.step;
      f(hn::LoadU(tag, rows.disparity[dy] + x), hn::LoadU(tag, rows.confidence[dy] + x));
    }
  }
}

using PixelVector = hn::Vec<PixelTag>;

/// Number and total weight of the pixels near a proposal.
HWY_INLINE void findSupport(const PatternRows& rows, const std::int16_t* proposals, int begin,
                            std::int16_t* counts, std::int16_t* weights) {
  const PixelTag tag;
  const auto far = hn::Set(tag, kNear + 1);
  const auto one = hn::Set(tag, 1);
  const auto proposal = hn::LoadU(tag, proposals + begin);
  auto count = hn::Zero(tag);
  auto weight = hn::Zero(tag);
  forPattern(rows, begin, [&](PixelVector disparity, PixelVector confidence) HWY_ATTR {
    const auto is_near = hn::Lt(hn::Abs(hn::SaturatedSub(disparity, proposal)), far);
    count = hn::Add(count, hn::IfThenElseZero(is_near, one));
    weight = hn::Add(weight, hn::IfThenElseZero(is_near, confidence));
  });
  hn::StoreU(count, tag, counts + begin);
  hn::StoreU(weight, tag, weights + begin);
}

void findSupport(const PatternRows& rows, const SelectionFeatures::Proposals& proposals,
                 Support& support) {
  const PixelTag tag;
  for (int begin = 0; begin < kBlock; begin += static_cast<int>(hn::Lanes(tag))) {
    auto total = hn::Zero(tag);
    forPattern(rows, begin, [&](PixelVector /*disparity*/, PixelVector confidence) HWY_ATTR {
      total = hn::Add(total, confidence);
    });
    hn::StoreU(total, tag, support.total_weight.data() + begin);
    for (int p = 0; p < kSources; ++p) {
      findSupport(rows, proposals[p].data(), begin, support.count[p].data(),
                  support.weight[p].data());
    }
  }
}

HWY_INLINE std::int32_t weightedSupport(std::int32_t weight, std::int32_t total) {
  return static_cast<std::int32_t>(250.0F * static_cast<float>(weight) /
                                   static_cast<float>(std::max(total, 1)));
}

// The following functions process all kBlock pixels, so that the loops have a fixed length. Codes
// of pixels beyond the row are meaningless.

void codeCounts(const std::int16_t* HWY_RESTRICT support, std::int8_t* HWY_RESTRICT codes) {
  for (int i = 0; i < kBlock; ++i) {
    codes[i] = asCode(10 * support[i]);
  }
}

void codeWeights(const std::int16_t* HWY_RESTRICT weights, const std::int16_t* HWY_RESTRICT totals,
                 std::int8_t* HWY_RESTRICT codes) {
  for (int i = 0; i < kBlock; ++i) {
    codes[i] = asCode(weightedSupport(weights[i], totals[i]));
  }
}

void codeSupport(const Support& support, int source, std::int8_t* plain, std::int8_t* weighted) {
  codeCounts(support.count[source].data(), plain);
  codeWeights(support.weight[source].data(), support.total_weight.data(), weighted);
}

void codeLeftRight(const ProposalBlock& block, const std::int16_t* HWY_RESTRICT proposals,
                   std::int8_t* HWY_RESTRICT codes) {
  const int first = block.x;
  const int last_column = block.width - 1;
  const float* HWY_RESTRICT right = block.right_disparity;
  const float invalid = block.right_invalid;
  if (right == nullptr) {
    std::fill_n(codes, kBlock, asCode(kUnknownDifference));
    return;
  }
  for (int i = 0; i < kBlock; ++i) {
    codes[i] =
        asCode(leftRightUnits(static_cast<float>(proposals[i]), matchOf(first + i, proposals[i]),
                              right, invalid, last_column));
  }
}

void codeChange(const std::int16_t* HWY_RESTRICT own, const std::int16_t* HWY_RESTRICT proposals,
                std::int8_t* HWY_RESTRICT codes) {
  for (int i = 0; i < kBlock; ++i) {
    const std::int32_t change = (proposals[i] - own[i]) >> 1;
    codes[i] = asCode(std::min(std::max(change + 128, 0), 255));
  }
}

/// Codes that are the same for all proposals of a pixel.
void codePixels(const ProposalBlock& block, std::int8_t* const* codes) {
  codeBytes(block.confidence, block.count, codes[kConfidence]);
  codeMeans(block.confidence_sums, block.count, codes[kConfidence5]);
  codeCells(block.confidence_cells[0], block.count, codes[kConfidence12]);
  codeCells(block.confidence_cells[1], block.count, codes[kConfidence20]);
  codeBytes(block.unmatched, block.count, codes[kUnmatched]);
  codeMeans(block.unmatched_sums, block.count, codes[kUnmatched5]);
  codeMeans(block.probability_sums, block.count, codes[kProbability5]);
}

/// The first query of a source in the line of a feature.
HWY_INLINE std::int8_t* ofSource(std::int8_t* line, int source) {
  return line + SelectionFeatures::query(source, 0, 0);
}

void codeBlock(const ProposalBlock& block, const SelectionFeatures::Proposals& proposals,
               std::int8_t* const* lines) {
  Support near;
  Support far;
  findSupport(block.near, proposals, near);
  findSupport(block.far, proposals, far);
  codePixels(block, lines);
  for (int p = 0; p < kSources; ++p) {
    const std::int16_t* proposal = proposals[p].data();
    codeChange(proposals[0].data(), proposal, ofSource(lines[kChange], p));
    codeBorder(proposal, block.x, kBlock, ofSource(lines[kBorder], p));
    codeLeftRight(block, proposal, ofSource(lines[kLeftRight], p));
    codeSupport(near, p, ofSource(lines[kSupport5], p), ofSource(lines[kWeightedSupport5], p));
    codeSupport(far, p, ofSource(lines[kSupport17], p), ofSource(lines[kWeightedSupport17], p));
    std::fill_n(ofSource(lines[kSource], p), kBlock, asCode(kCodePerSource * p));
    if (block.distances[p] == nullptr) {
      std::fill_n(ofSource(lines[kDistance], p), kBlock, asCode(0));
    } else {
      codeBytes(block.distances[p], block.count, ofSource(lines[kDistance], p));
    }
    std::memcpy(ofSource(lines[kOwnSupport5], p), lines[kSupport5], kBlock);
    std::memcpy(ofSource(lines[kOwnWeightedSupport17], p), lines[kWeightedSupport17], kBlock);
  }
  for (const int f : kSharedFeatures) {
    for (int p = 1; p < kSources; ++p) {
      std::memcpy(ofSource(lines[f], p), lines[f], kBlock);
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

HWY_EXPORT(codeBlock);

constexpr int kPadding = ConfidencePlanes::kBorderPx;
constexpr std::array<int, 2> kConfidenceCells = {3, 5};

/// Adds the border. On the right, it is wider by the pixels that a block reads beyond the end of a
/// row.
void pad(const cv::Mat& map, cv::Mat& padded) {
  cv::copyMakeBorder(map, padded, kPadding, kPadding, kPadding, kPadding + kBlock,
                     cv::BORDER_REPLICATE);
}

/// The pattern around pixel (x, y).
PatternRows patternRows(const ConfidencePlanes& planes, int y, int x, int step) {
  PatternRows rows{};
  rows.step = step;
  for (int i = 0; i < kPatternSide; ++i) {
    const int row = y + kPadding + (i - kPatternSide / 2) * step;
    rows.disparity[i] = planes.padded_disparity.ptr<std::int16_t>(row, x + kPadding);
    rows.confidence[i] = planes.padded_confidence.ptr<std::int16_t>(row, x + kPadding);
  }
  return rows;
}

}  // namespace

const std::vector<std::string>& selectionFeatureNames() {
  static const std::vector<std::string> kNames = {"change",
                                                  "left_right",
                                                  "border",
                                                  "distance",
                                                  "source",
                                                  "support_5",
                                                  "weighted_support_5",
                                                  "support_17",
                                                  "weighted_support_17",
                                                  "confidence",
                                                  "confidence_5",
                                                  "confidence_12",
                                                  "confidence_20",
                                                  "unmatched",
                                                  "unmatched_5",
                                                  "probability_5",
                                                  "own_support_5",
                                                  "own_weighted_support_17"};
  return kNames;
}

void ConfidencePlanes::prepare(const MapPlanes& planes, const cv::Mat& confidences) {
  CV_Assert(confidences.type() == CV_8UC1 && confidences.size() == planes.disparity.size());
  confidence = confidences;
  confidences.convertTo(wide_confidence_, CV_16S);
  pad(wide_confidence_, padded_confidence);
  pad(planes.disparity, padded_disparity);
  grid_.sum(confidences);
  for (std::size_t i = 0; i < cell_means.size(); ++i) {
    grid_.windowMeans(kConfidenceCells[i], cell_means[i]);
  }
  neighbors.find(planes.disparity, confidences);
}

void SelectionFeatures::resize(int width) {
  for (WindowRow* row : {&unmatched_, &probability_, &confidence_window_}) {
    row->resize(width);
  }
  neighbors_.resize(width);
}

void SelectionFeatures::startRow(const MapPlanes& planes, const ConfidencePlanes& confidence,
                                 const float* right_disparity, float right_invalid, int y) {
  planes_ = &planes;
  confidence_ = &confidence;
  right_disparity_ = right_disparity;
  right_invalid_ = right_invalid;
  y_ = y;
  unmatched_sums_ = unmatched_.sums(planes.unmatched, y);
  probability_sums_ = probability_.sums(planes.probability, y);
  confidence_sums_ = confidence_window_.sums(confidence.confidence, y);
  confidence.neighbors.findOnRow(y, neighbors_);
}

void SelectionFeatures::propose(int x, int count, Proposals& proposals) const {
  const std::array<const std::int16_t*, kSources> sources = {
      planes_->disparity.ptr<std::int16_t>(y_, x), &neighbors_.left[x], &neighbors_.right[x],
      confidence_->neighbors.above(y_).disparity + x,
      confidence_->neighbors.below(y_).disparity + x};
  for (int p = 0; p < kSources; ++p) {
    std::copy_n(sources[p], count, proposals[p].data());
    std::fill_n(proposals[p].data() + count, kBlock - count, ConfidentNeighbors::kNoNeighbor);
  }
}

void SelectionFeatures::code(int x, int count, const Proposals& proposals, int slot,
                             ConfidenceCodes& codes) const {
  const ProposalBlock block{x,
                            count,
                            planes_->disparity.cols,
                            confidence_->confidence.ptr<std::uint8_t>(y_, x),
                            planes_->unmatched.ptr<std::uint8_t>(y_, x),
                            confidence_sums_ + x,
                            unmatched_sums_ + x,
                            probability_sums_ + x,
                            {CellGrid::at(confidence_->cell_means[0], y_, x),
                             CellGrid::at(confidence_->cell_means[1], y_, x)},
                            right_disparity_,
                            right_invalid_,
                            {nullptr, &neighbors_.left_distance[x], &neighbors_.right_distance[x],
                             confidence_->neighbors.above(y_).distance + x,
                             confidence_->neighbors.below(y_).distance + x},
                            patternRows(*confidence_, y_, x, 1),
                            patternRows(*confidence_, y_, x, 4)};
  std::array<std::int8_t*, kFeatures> lines{};
  for (int f = 0; f < kFeatures; ++f) {
    lines[f] = codes.line(f) + query(0, slot, 0);
  }
  HWY_DYNAMIC_DISPATCH(codeBlock)(block, proposals, lines.data());
}

}  // namespace cbmv
#endif  // HWY_ONCE
