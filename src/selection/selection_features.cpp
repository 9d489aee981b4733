#include "cbmv_stereo/selection/selection_features.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#ifndef CBMV_SELECTION_FEATURES_ONCE
#define CBMV_SELECTION_FEATURES_ONCE
namespace cbmv {
namespace {

/// In the order of selectionFeatureNames.
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

constexpr int kPatternSide = 5;
constexpr int kCodePerSource = 60;
constexpr int kBlock = SelectionFeatures::kBlock;
/// Within this distance disparities support each other, in planes' units.
constexpr int kNear = kPlaneUnitsPerPx;

/// Sums over the pixels of a pattern around the pixels of a block, [source][pixel].
struct Support {
  std::array<std::array<std::int16_t, kBlock>, kSources> count;
  std::array<std::array<std::int16_t, kBlock>, kSources> weight;
  std::array<std::int16_t, kBlock> total_weight;
};

/// Rows of the padded maps that a pattern of 5 × 5 pixels reads, at the first pixel of the block.
struct PatternRows {
  std::array<const std::int16_t*, kPatternSide> disparity;
  std::array<const std::int16_t*, kPatternSide> confidence;
  int step;  ///< px between the pixels of the pattern
};

/// What the codes of a block are made of, from its first pixel on.
struct ProposalBlock {
  int x;
  int count;
  int width;
  const std::int16_t* disparity;
  const std::uint8_t* confidence;
  const std::uint8_t* unmatched;
  const std::int32_t* confidence_sums;
  const std::int32_t* unmatched_sums;
  const std::int32_t* probability_sums;
  std::array<const std::int32_t*, 2> confidence_cells;
  const float* right_disparity;  ///< of the whole row; null: not known
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

/// Adds one pixel of the pattern. All kBlock pixels, so that the loops have a fixed length; those
/// beyond the row read the padding.
HWY_INLINE void addPatternPixel(const std::int16_t* disparity, const std::int16_t* confidence,
                                const SelectionFeatures::Proposals& proposals, Support& support) {
  for (int p = 0; p < kSources; ++p) {
    std::int16_t* count = support.count[p].data();
    std::int16_t* weight = support.weight[p].data();
    const std::int16_t* proposal = proposals[p].data();
    for (int i = 0; i < kBlock; ++i) {
      const auto lowest = static_cast<std::int16_t>(proposal[i] - kNear);
      const auto highest = static_cast<std::int16_t>(proposal[i] + kNear);
      const bool is_near = disparity[i] >= lowest && disparity[i] <= highest;
      count[i] = static_cast<std::int16_t>(count[i] + (is_near ? 1 : 0));
      weight[i] = static_cast<std::int16_t>(weight[i] + (is_near ? confidence[i] : 0));
    }
  }
  for (int i = 0; i < kBlock; ++i) {
    support.total_weight[i] = static_cast<std::int16_t>(support.total_weight[i] + confidence[i]);
  }
}

void findSupport(const PatternRows& rows, const SelectionFeatures::Proposals& proposals,
                 Support& support) {
  support = {};
  for (int dy = 0; dy < kPatternSide; ++dy) {
    for (int dx = 0; dx < kPatternSide; ++dx) {
      const int offset = (dx - kPatternSide / 2) * rows.step;
      addPatternPixel(rows.disparity[dy] + offset, rows.confidence[dy] + offset, proposals,
                      support);
    }
  }
}

HWY_INLINE std::int32_t weightedSupport(std::int32_t weight, std::int32_t total) {
  return static_cast<std::int32_t>(250.0F * static_cast<float>(weight) /
                                   static_cast<float>(std::max(total, 1)));
}

void codeSupport(const Support& support, int source, int count, std::int8_t* plain,
                 std::int8_t* weighted) {
  for (int i = 0; i < count; ++i) {
    plain[i] = asCode(10 * support.count[source][i]);
    weighted[i] = asCode(weightedSupport(support.weight[source][i], support.total_weight[i]));
  }
}

void codeProposals(const ProposalBlock& block, const std::int16_t* proposals,
                   std::int8_t* const* codes) {
  for (int i = 0; i < block.count; ++i) {
    const std::int32_t change = (proposals[i] - block.disparity[i]) >> 3;
    codes[kChange][i] = asCode(std::min(std::max(change + 128, 0), 255));
  }
  codeBorder(proposals, block.x, block.count, codes[kBorder]);
  for (int i = 0; i < block.count; ++i) {
    std::int32_t code = 255;
    const int match = block.x + i - ((proposals[i] + kPlaneUnitsPerPx / 2) >> 3);
    if (block.right_disparity != nullptr && match >= 0 && match < block.width) {
      const float other = block.right_disparity[match];
      const float own = static_cast<float>(proposals[i]) / kPlaneUnitsPerPx;
      const float difference = std::min(std::abs(own - other) * kPlaneUnitsPerPx, 254.0F);
      code = other == block.right_invalid ? 255 : static_cast<std::int32_t>(difference);
    }
    codes[kLeftRight][i] = asCode(code);
  }
}

/// What all proposals of a pixel share.
void codePixels(const ProposalBlock& block, std::int8_t* const* codes) {
  codeBytes(block.confidence, block.count, codes[kConfidence]);
  codeMeans(block.confidence_sums, block.count, codes[kConfidence5]);
  codeCells(block.confidence_cells[0], block.count, codes[kConfidence12]);
  codeCells(block.confidence_cells[1], block.count, codes[kConfidence20]);
  codeBytes(block.unmatched, block.count, codes[kUnmatched]);
  codeMeans(block.unmatched_sums, block.count, codes[kUnmatched5]);
  codeMeans(block.probability_sums, block.count, codes[kProbability5]);
}

void codeBlock(const ProposalBlock& block, const SelectionFeatures::Proposals& proposals,
               std::int8_t* const* first_codes) {
  Support near;
  Support far;
  findSupport(block.near, proposals, near);
  findSupport(block.far, proposals, far);
  for (int p = 0; p < kSources; ++p) {
    std::array<std::int8_t*, kFeatures> codes{};
    for (int f = 0; f < kFeatures; ++f) {
      codes[f] = first_codes[f] + p * kBlock;
    }
    codePixels(block, codes.data());
    codeProposals(block, proposals[p].data(), codes.data());
    std::fill_n(codes[kSource], block.count, asCode(kCodePerSource * p));
    if (block.distances[p] == nullptr) {
      std::fill_n(codes[kDistance], block.count, asCode(0));
    } else {
      codeBytes(block.distances[p], block.count, codes[kDistance]);
    }
    codeSupport(near, p, block.count, codes[kSupport5], codes[kWeightedSupport5]);
    codeSupport(far, p, block.count, codes[kSupport17], codes[kWeightedSupport17]);
    std::copy_n(first_codes[kSupport5], block.count, codes[kOwnSupport5]);
    std::copy_n(first_codes[kWeightedSupport17], block.count, codes[kOwnWeightedSupport17]);
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

/// The padding, and what a block reads beyond the last pixel of a row.
constexpr int kPadding = ConfidencePlanes::kBorderPx;
constexpr std::array<int, 2> kConfidenceCells = {3, 5};

void pad(const cv::Mat& map, cv::Mat& padded) {
  cv::copyMakeBorder(map, padded, kPadding, kPadding, kPadding, kPadding + kBlock,
                     cv::BORDER_REPLICATE);
}

const std::int32_t* cellOf(const cv::Mat& means, int y, int x) {
  return means.ptr<std::int32_t>(y / CellGrid::kCellPx, x / CellGrid::kCellPx);
}

/// Around pixel (x, y).
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

void SelectionFeatures::code(int x, int count, Proposals& proposals, ConfidenceCodes& codes) {
  propose(x, count, proposals);
  const ProposalBlock block{
      x,
      count,
      planes_->disparity.cols,
      planes_->disparity.ptr<std::int16_t>(y_, x),
      confidence_->confidence.ptr<std::uint8_t>(y_, x),
      planes_->unmatched.ptr<std::uint8_t>(y_, x),
      confidence_sums_ + x,
      unmatched_sums_ + x,
      probability_sums_ + x,
      {cellOf(confidence_->cell_means[0], y_, x), cellOf(confidence_->cell_means[1], y_, x)},
      right_disparity_,
      right_invalid_,
      {nullptr, &neighbors_.left_distance[x], &neighbors_.right_distance[x],
       confidence_->neighbors.above(y_).distance + x,
       confidence_->neighbors.below(y_).distance + x},
      patternRows(*confidence_, y_, x, 1),
      patternRows(*confidence_, y_, x, 4)};
  std::array<std::int8_t*, kFeatures> lines{};
  for (int f = 0; f < kFeatures; ++f) {
    lines[f] = codes.line(f);
  }
  HWY_DYNAMIC_DISPATCH(codeBlock)(block, proposals, lines.data());
}

}  // namespace cbmv
#endif  // HWY_ONCE
