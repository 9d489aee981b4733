#include "selection/map_confidence.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace cbmv {

MapConfidence::MapConfidence(const ConfidenceForest& forest, const std::string& file_name)
    : forest_(forest), evaluator_(forest) {
  requireFeatures(forest, "confidence", confidenceFeatureNames(), file_name);
}

void MapConfidence::estimate(const JudgedMaps& maps) {
  planes_.prepare(maps);
  confidence_.create(maps.disparity.size(), CV_8UC1);
  roughness_bins_.create(maps.disparity.size(), CV_8UC1);
  rows_.prepare([&](Row& row) {
    row.features.resize(confidence_.cols);
    row.codes.reserve(forest_);
  });
  tbb::parallel_for(0, confidence_.rows, [&](int y) { estimateRow(y, rows_.local()); });
}

void MapConfidence::estimateRow(int y, Row& row) {
  row.features.startRow(planes_, y);
  auto* confidence = confidence_.ptr<std::uint8_t>(y);
  auto* bins = roughness_bins_.ptr<std::uint8_t>(y);
  for (int x = 0; x < confidence_.cols; x += ConfidenceFeatures::kBlock) {
    const int count = std::min(ConfidenceFeatures::kBlock, confidence_.cols - x);
    row.features.code(x, count, row.codes);
    evaluator_.score(row.codes, count, row.scores.data());
    const auto* disparity = planes_.disparity.ptr<std::int16_t>(y, x);
    std::transform(row.scores.begin(), row.scores.begin() + count, disparity, confidence + x,
                   [&](std::uint16_t score, std::int16_t units) {
                     return units == planes_.no_disparity ? std::uint8_t{0}
                                                          : evaluator_.probabilityByte(score);
                   });
    const std::int8_t* roughness = row.codes.line(roughnessFeature());
    std::transform(roughness, roughness + count, bins + x, [&](std::int8_t code) {
      return static_cast<std::uint8_t>(forest_.roughnessBin(static_cast<std::uint8_t>(code + 128)));
    });
  }
}

}  // namespace cbmv
