#include "selection/confidence_features.h"

#include <algorithm>
#include <array>

#ifndef CBMV_CONFIDENCE_FEATURES_ONCE
#define CBMV_CONFIDENCE_FEATURES_ONCE
namespace cbmv {
namespace {

/// Features in the order of confidenceFeatureNames.
enum MapFeature {
  kProbability,
  kMargin,
  kLeftRight,
  kUnmatched,
  kBorder,
  kUnmatched5,
  kProbability5,
  kMargin5,
  kRoughness5,
  kDeviation5,
  kUnmatched12,
  kProbability12,
  kMargin12,
  kDeviation12,
  kRoughness20,
  kDeviation20,
  kUnmatched36,
  kProbability36,
  kMargin36,
  kRoughness36,
  kDeviation36,
  kFeatures
};

/// Means over windows of cells at the first pixel of a block.
struct CellRow {
  const std::int32_t* unmatched;
  const std::int32_t* probability;
  const std::int32_t* margin;
  const std::int32_t* roughness;
  const std::int32_t* disparity;
};

/// Inputs for the codes of a block of pixels, from its first pixel on.
struct Block {
  int x;
  int count;
  const std::uint8_t* probability;
  const std::uint16_t* margin;
  const std::uint8_t* left_right;
  const std::uint8_t* unmatched;
  const std::int16_t* disparity;
  const std::int32_t* unmatched_sums;
  const std::int32_t* probability_sums;
  const std::int32_t* margin_sums;
  const std::int32_t* roughness_sums;
  const std::int32_t* disparity_sums;
  std::array<CellRow, kWindowCells.size()> cells;
  std::array<std::int8_t*, kFeatures> codes;
};

}  // namespace
}  // namespace cbmv
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "selection/confidence_features.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "selection/code_lines-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

void codeMargins(const std::uint16_t* HWY_RESTRICT margins, int count,
                 std::int8_t* HWY_RESTRICT codes) {
  for (int x = 0; x < count; ++x) {
    codes[x] = asCode(compressed(margins[x]));
  }
}

void codeMeanMargins(const std::int32_t* HWY_RESTRICT sums, int count,
                     std::int8_t* HWY_RESTRICT codes) {
  for (int x = 0; x < count; ++x) {
    codes[x] = asCode(compressed(meanOf25(sums[x])));
  }
}

void codeDeviations5(const std::int16_t* HWY_RESTRICT disparity,
                     const std::int32_t* HWY_RESTRICT sums, int count,
                     std::int8_t* HWY_RESTRICT codes) {
  constexpr int kHighest = 25 * kHighestMargin;
  for (int x = 0; x < count; ++x) {
    const std::int32_t deviation = std::abs(25 * disparity[x] - sums[x]);
    codes[x] = asCode(compressed(meanOf25(std::min(deviation, kHighest))));
  }
}

void codeDeviations(const Block& block) {
  codeDeviations5(block.disparity, block.disparity_sums, block.count, block.codes[kDeviation5]);
  codeCellDeviations(block.disparity, block.cells[0].disparity, block.count,
                     block.codes[kDeviation12]);
  codeCellDeviations(block.disparity, block.cells[1].disparity, block.count,
                     block.codes[kDeviation20]);
  codeCellDeviations(block.disparity, block.cells[2].disparity, block.count,
                     block.codes[kDeviation36]);
}

void codeBlock(const Block& block) {
  const int count = block.count;
  codeBytes(block.probability, count, block.codes[kProbability]);
  codeBytes(block.left_right, count, block.codes[kLeftRight]);
  codeBytes(block.unmatched, count, block.codes[kUnmatched]);
  codeBorder(block.disparity, block.x, count, block.codes[kBorder]);
  codeMeans(block.unmatched_sums, count, block.codes[kUnmatched5]);
  codeMeans(block.probability_sums, count, block.codes[kProbability5]);
  codeMeans(block.roughness_sums, count, block.codes[kRoughness5]);
  codeMargins(block.margin, count, block.codes[kMargin]);
  codeMeanMargins(block.margin_sums, count, block.codes[kMargin5]);
  codeDeviations(block);
  codeCells(block.cells[0].unmatched, count, block.codes[kUnmatched12]);
  codeCells(block.cells[0].probability, count, block.codes[kProbability12]);
  codeCompressedCells(block.cells[0].margin, count, block.codes[kMargin12]);
  codeCells(block.cells[1].roughness, count, block.codes[kRoughness20]);
  codeCells(block.cells[2].unmatched, count, block.codes[kUnmatched36]);
  codeCells(block.cells[2].probability, count, block.codes[kProbability36]);
  codeCompressedCells(block.cells[2].margin, count, block.codes[kMargin36]);
  codeCells(block.cells[2].roughness, count, block.codes[kRoughness36]);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(codeBlock);

}  // namespace

const std::vector<std::string>& confidenceFeatureNames() {
  static const std::vector<std::string> kNames = {
      "probability",  "margin",         "left_right",     "unmatched",    "border",
      "unmatched_5",  "probability_5",  "margin_5",       "roughness_5",  "deviation_5",
      "unmatched_12", "probability_12", "margin_12",      "deviation_12", "roughness_20",
      "deviation_20", "unmatched_36",   "probability_36", "margin_36",    "roughness_36",
      "deviation_36"};
  return kNames;
}

int roughnessFeature() { return kRoughness5; }

void ConfidenceFeatures::resize(int width) {
  for (WindowRow* row : {&unmatched_, &probability_, &margin_, &roughness_, &disparity_}) {
    row->resize(width);
  }
}

void ConfidenceFeatures::startRow(const MapPlanes& planes, int y) {
  planes_ = &planes;
  y_ = y;
  unmatched_sums_ = unmatched_.sums(planes.unmatched, y);
  probability_sums_ = probability_.sums(planes.probability, y);
  margin_sums_ = margin_.sums(planes.margin, y);
  roughness_sums_ = roughness_.sums(planes.roughness, y);
  disparity_sums_ = disparity_.sums(planes.disparity, y);
}

void ConfidenceFeatures::code(int x, int count, ConfidenceCodes& codes) const {
  Block block{};
  block.x = x;
  block.count = count;
  block.probability = planes_->probability.ptr<std::uint8_t>(y_, x);
  block.margin = planes_->margin.ptr<std::uint16_t>(y_, x);
  block.left_right = planes_->left_right.ptr<std::uint8_t>(y_, x);
  block.unmatched = planes_->unmatched.ptr<std::uint8_t>(y_, x);
  block.disparity = planes_->disparity.ptr<std::int16_t>(y_, x);
  block.unmatched_sums = unmatched_sums_ + x;
  block.probability_sums = probability_sums_ + x;
  block.margin_sums = margin_sums_ + x;
  block.roughness_sums = roughness_sums_ + x;
  block.disparity_sums = disparity_sums_ + x;
  for (std::size_t i = 0; i < block.cells.size(); ++i) {
    const auto cell = [&](const cv::Mat& means) { return CellGrid::at(means, y_, x); };
    const MapPlanes::Windows& windows = planes_->windows[i];
    block.cells[i] = {cell(windows.unmatched), cell(windows.probability), cell(windows.margin),
                      cell(windows.roughness), cell(windows.disparity)};
  }
  for (int f = 0; f < kFeatures; ++f) {
    block.codes[f] = codes.line(f);
  }
  HWY_DYNAMIC_DISPATCH(codeBlock)(block);
}

}  // namespace cbmv
#endif  // HWY_ONCE
