#include "training/judged_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "selection/confidence_features.h"
#include "selection/selection_features.h"
#include "training/sampling.h"

namespace cbmv {
namespace {

/// Columns that are drawn, row by row.
using DrawnPixels = std::vector<std::vector<int>>;

/// Pixels with a disparity whose truth is known, without those of the margins.
std::vector<cv::Point> candidatesOf(const JudgedScene& scene, const HeldOutBand& band) {
  const cv::Mat& disparity = scene.result.disparity;
  const float invalid = scene.result.range.invalid();
  std::vector<cv::Point> candidates;
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; !band.isMargin(y) && x < disparity.cols; ++x) {
      if (std::isfinite(scene.truth.at<float>(y, x)) && disparity.at<float>(y, x) != invalid) {
        candidates.emplace_back(x, y);
      }
    }
  }
  return candidates;
}

/// Up to `pixels` of these.
DrawnPixels draw(const JudgedScene& scene, const HeldOutBand& band, long pixels,
                 std::uint64_t seed) {
  std::vector<cv::Point> candidates = candidatesOf(scene, band);
  std::mt19937_64 random(seed);
  const auto wanted =
      std::min<std::ptrdiff_t>(pixels, static_cast<std::ptrdiff_t>(candidates.size()));
  for (std::ptrdiff_t i = 0; i < wanted; ++i) {  // std::sample's draws differ between libraries
    const std::uint64_t left = candidates.size() - static_cast<std::size_t>(i);
    std::swap(candidates[i], candidates[i + static_cast<std::ptrdiff_t>(random() % left)]);
  }
  DrawnPixels drawn(scene.truth.rows);
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
    const std::int8_t code = codes.line(static_cast<int>(f))[query];
    samples.features[f].push_back(static_cast<std::uint8_t>(code + 128));
  }
  samples.labels.push_back(is_correct ? 1 : 0);
  samples.held_out.push_back(is_held_out ? 1 : 0);
}

ConfidenceCodes codesFor(const std::vector<std::string>& feature_names) {
  ConfidenceForest shape;
  shape.feature_names = feature_names;
  return ConfidenceCodes(shape);
}

/// Features are computed from the first pixel of a cell on.
int firstOfCell(int x) { return x / CellGrid::kCellPx * CellGrid::kCellPx; }

bool isCorrect(float disparity, float truth) { return std::abs(disparity - truth) <= kCorrectPx; }

/// Is proposal p of pixel i unlike those before it?
bool isNew(const SelectionFeatures::Proposals& proposals, int p, int i) {
  return p == 0 || (SelectionFeatures::isNew(proposals, p, i, true) &&
                    std::none_of(proposals.begin() + 1, proposals.begin() + p,
                                 [&](const auto& other) { return other[i] == proposals[p][i]; }));
}

/// The proposals of pixels of a scene as samples.
class ProposalSampler {
 public:
  ProposalSampler(const JudgedScene& scene, const ConfidenceForest& confidence)
      : scene_(scene),
        judge_(confidence, "the confidence forest in training"),
        codes_(codesFor(selectionFeatureNames())) {
    judge_.estimate(scene.maps());
    planes_.prepare(judge_.planes(), judge_.confidence());
    features_.resize(scene.truth.cols);
  }

  void startRow(int y) {
    const cv::Mat& right = scene_.result.right_disparity;
    y_ = y;
    features_.startRow(judge_.planes(), planes_, right.empty() ? nullptr : right.ptr<float>(y),
                       scene_.result.range.invalid(), y);
  }

  void append(int x, bool is_held_out, ConfidenceSamples& samples) {
    const int first = firstOfCell(x);
    const int i = x - first;
    features_.propose(first, i + 1, proposals_);
    features_.code(first, i + 1, proposals_, 0, codes_);
    for (int p = 0; p < kSources; ++p) {
      if (isNew(proposals_, p, i)) {
        appendQuery(codes_, SelectionFeatures::query(p, 0, i),
                    isCorrect(disparityOf(p, x, i), scene_.truth.at<float>(y_, x)), is_held_out,
                    samples);
      }
    }
  }

 private:
  float disparityOf(int source, int x, int i) const {
    return source == 0 ? scene_.result.disparity.at<float>(y_, x)
                       : static_cast<float>(proposals_[source][i]) / kPlaneUnitsPerPx;
  }

  const JudgedScene& scene_;
  MapConfidence judge_;
  ConfidencePlanes planes_;
  SelectionFeatures features_;
  SelectionFeatures::Proposals proposals_{};
  ConfidenceCodes codes_;
  int y_ = 0;
};

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
  const DrawnPixels drawn = draw(scene, band, pixels, seed);
  ConfidenceCodes codes = codesFor(confidenceFeatureNames());
  ConfidenceFeatures features;
  features.resize(disparity.cols);
  for (int y = 0; y < disparity.rows; ++y) {
    if (drawn[y].empty()) {
      continue;
    }
    features.startRow(planes, y);
    for (const int x : drawn[y]) {
      const int first = firstOfCell(x);
      features.code(first, x - first + 1, codes);
      appendQuery(codes, x - first,
                  isCorrect(disparity.at<float>(y, x), scene.truth.at<float>(y, x)),
                  band.contains(y), samples);
    }
  }
}

void appendSelectionSamples(const JudgedScene& scene, const ConfidenceForest& confidence,
                            long pixels, std::uint64_t seed, ConfidenceSamples& samples) {
  startSamples(selectionFeatureNames(), samples);
  const HeldOutBand band(scene.truth.rows, seed);
  const DrawnPixels drawn = draw(scene, band, pixels, seed);
  ProposalSampler sampler(scene, confidence);
  for (int y = 0; y < scene.truth.rows; ++y) {
    if (!drawn[y].empty()) {
      sampler.startRow(y);
    }
    for (const int x : drawn[y]) {
      sampler.append(x, band.contains(y), samples);
    }
  }
}

}  // namespace cbmv
