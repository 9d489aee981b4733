#include "cbmv_stereo/training/judged_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "cbmv_stereo/selection/confidence_features.h"
#include "cbmv_stereo/selection/selection_features.h"
#include "cbmv_stereo/training/sampling.h"

namespace cbmv {
namespace {

/// Columns that are drawn, row by row.
using DrawnPixels = std::vector<std::vector<int>>;

/// Up to `pixels` of those that `may_be_drawn(y, x)`.
template <typename Predicate>
DrawnPixels draw(const cv::Size& size, const HeldOutBand& band, long pixels, std::uint64_t seed,
                 const Predicate& may_be_drawn) {
  std::vector<cv::Point> candidates;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; !band.isMargin(y) && x < size.width; ++x) {
      if (may_be_drawn(y, x)) {
        candidates.emplace_back(x, y);
      }
    }
  }
  std::mt19937_64 random(seed);
  const auto wanted =
      std::min<std::ptrdiff_t>(pixels, static_cast<std::ptrdiff_t>(candidates.size()));
  for (std::ptrdiff_t i = 0; i < wanted; ++i) {  // std::sample's draws differ between libraries
    const std::uint64_t left = candidates.size() - static_cast<std::size_t>(i);
    std::swap(candidates[i], candidates[i + static_cast<std::ptrdiff_t>(random() % left)]);
  }
  DrawnPixels drawn(size.height);
  for (std::ptrdiff_t i = 0; i < wanted; ++i) {
    drawn[candidates[i].y].push_back(candidates[i].x);
  }
  return drawn;
}

void startSamples(const std::vector<std::string>& names, ConfidenceSamples& samples) {
  samples.feature_names = names;
  samples.features.resize(names.size());
}

void appendQuery(ConfidenceCodes& codes, int query, bool is_correct, bool is_held_out,
                 ConfidenceSamples& samples) {
  for (std::size_t f = 0; f < samples.features.size(); ++f) {
    const int code = codes.line(static_cast<int>(f))[query];
    samples.features[f].push_back(static_cast<std::uint8_t>(code + 128));
  }
  samples.labels.push_back(is_correct ? 1 : 0);
  samples.held_out.push_back(is_held_out ? 1 : 0);
}

bool isCorrect(float disparity, float truth) { return std::abs(disparity - truth) <= kCorrectPx; }

/// Is proposal p of pixel i unlike those before it?
bool isNew(const SelectionFeatures::Proposals& proposals, int p, int i) {
  return std::none_of(proposals.begin(), proposals.begin() + p, [&](const auto& other) {
    return other[i] != ConfidentNeighbors::kNoNeighbor &&
           std::abs(other[i] - proposals[p][i]) <= (&other == &proposals[0] ? kPlaneUnitsPerPx : 0);
  });
}

}  // namespace

JudgedMaps JudgedScene::maps() const {
  return {result.disparity,  result.right_disparity, result.labels,
          result.confidence, result.margin,          result.range};
}

void appendConfidenceSamples(const JudgedScene& scene, long pixels, std::uint64_t seed,
                             ConfidenceSamples& samples) {
  startSamples(confidenceFeatureNames(), samples);
  MapPlanes planes;
  planes.prepare(scene.maps());
  const cv::Mat& disparity = scene.result.disparity;
  const HeldOutBand band(disparity.rows, seed);
  const DrawnPixels drawn = draw(disparity.size(), band, pixels, seed, [&](int y, int x) {
    return std::isfinite(scene.truth.at<float>(y, x));
  });
  ConfidenceForest shape;
  shape.feature_names = confidenceFeatureNames();
  ConfidenceCodes codes(shape);
  ConfidenceFeatures features;
  features.resize(disparity.cols);
  for (int y = 0; y < disparity.rows; ++y) {
    if (drawn[y].empty()) {
      continue;
    }
    features.startRow(planes, y);
    for (const int x : drawn[y]) {
      const int first = x / CellGrid::kCellPx * CellGrid::kCellPx;
      features.code(first, x - first + 1, codes);
      appendQuery(codes, x - first, isCorrect(disparity.at<float>(y, x), scene.truth.at<float>(y, x)),
                  band.contains(y), samples);
    }
  }
}

void appendSelectionSamples(const JudgedScene& scene, const ConfidenceForest& confidence,
                            long pixels, std::uint64_t seed, ConfidenceSamples& samples) {
  startSamples(selectionFeatureNames(), samples);
  MapConfidence judge(confidence, "the confidence forest in training");
  judge.estimate(scene.maps());
  ConfidencePlanes planes;
  planes.prepare(judge.planes(), judge.confidence());
  const cv::Mat& disparity = scene.result.disparity;
  const float invalid = scene.result.range.invalid();
  const HeldOutBand band(disparity.rows, seed);
  const DrawnPixels drawn = draw(disparity.size(), band, pixels, seed, [&](int y, int x) {
    return std::isfinite(scene.truth.at<float>(y, x)) &&
           disparity.at<float>(y, x) != invalid;
  });
  ConfidenceForest shape;
  shape.feature_names = selectionFeatureNames();
  ConfidenceCodes codes(shape);
  SelectionFeatures features;
  features.resize(disparity.cols);
  SelectionFeatures::Proposals proposals{};
  const cv::Mat& right = scene.result.right_disparity;
  for (int y = 0; y < disparity.rows; ++y) {
    if (drawn[y].empty()) {
      continue;
    }
    features.startRow(judge.planes(), planes, right.empty() ? nullptr : right.ptr<float>(y),
                      invalid, y);
    for (const int x : drawn[y]) {
      const int first = x / CellGrid::kCellPx * CellGrid::kCellPx;
      const int i = x - first;
      features.propose(first, i + 1, proposals);
      features.code(first, i + 1, proposals, 0, codes);
      for (int p = 0; p < kSources; ++p) {
        const int proposal = proposals[p][i];
        if (proposal == ConfidentNeighbors::kNoNeighbor || !isNew(proposals, p, i)) {
          continue;
        }
        const float proposed = p == 0 ? disparity.at<float>(y, x)
                                      : static_cast<float>(proposal) / kPlaneUnitsPerPx;
        appendQuery(codes, SelectionFeatures::query(p, 0, i),
                    isCorrect(proposed, scene.truth.at<float>(y, x)), band.contains(y), samples);
      }
    }
  }
}

}  // namespace cbmv
