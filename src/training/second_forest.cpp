#include "training/second_forest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "evaluation/sigma_coverage.h"
#include "training/boosting.h"
#include "training/held_out_measures.h"
#include "training/judged_scene.h"
#include "training/quantile.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {
namespace {

constexpr std::size_t kFewestErrors = 200;  ///< of a bin that has a standard deviation of its own
constexpr double kLowestSigmaPx = 0.01;
/// Sparse truth (laser scans: a fifth of the pixels) has few pixels at the depth edges where
/// disparities are replaced. What is learnt from it replaces too many.
constexpr double kLeastTruth = 0.5;

bool startsWith(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

bool hasBothClasses(const ConfidenceSamples& samples) {
  std::array<std::array<long, 2>, 2> counts{};
  for (std::size_t i = 0; i < samples.labels.size(); ++i) {
    ++counts[samples.held_out[i]][samples.labels[i]];
  }
  return counts[0][0] > 0 && counts[0][1] > 0 && counts[1][0] + counts[1][1] > 0;
}

/// Absolute errors of correct disparities, by the bins of the model.
using ErrorBins = std::vector<std::vector<float>>;

void collectErrors(const JudgedScene& scene, const ConfidenceForest& forest, ErrorBins& bins) {
  MapConfidence judge(forest, "the confidence forest in training");
  judge.estimate(scene.maps());
  for (int y = 0; y < scene.truth.rows; ++y) {
    for (int x = 0; x < scene.truth.cols; ++x) {
      const float disparity = scene.result.disparity.at<float>(y, x);
      const float error = std::abs(disparity - scene.truth.at<float>(y, x));
      if (disparity != scene.result.range.invalid() && error <= kCorrectPx) {  // the truth is known
        bins[ConfidenceForest::sigmaBin(judge.roughnessBins().at<std::uint8_t>(y, x),
                                        judge.confidence().at<std::uint8_t>(y, x))]
            .push_back(error);
      }
    }
  }
}

/// Limits that make bins of the roughness of about the same size.
void splitRoughness(const ConfidenceSamples& samples, ConfidenceForest& forest) {
  std::vector<std::uint8_t> roughness = samples.features[roughnessFeature()];
  int least = 1;
  int bin = 0;
  for (std::uint8_t& bound : forest.sigma_roughness_bounds) {
    const double share = static_cast<double>(++bin) / ConfidenceForest::kSigmaRoughnessBins;
    bound = static_cast<std::uint8_t>(std::max<int>(least, quantile(roughness, share)));
    least = bound + 1;
  }
}

/// Bins of few errors get the standard deviation of all.
std::vector<double> sigmaOf(ErrorBins& bins) {
  std::vector<float> all;
  for (const std::vector<float>& bin : bins) {
    all.insert(all.end(), bin.begin(), bin.end());
  }
  std::vector<double> sigma_px;
  for (std::vector<float>& bin : bins) {
    const double sigma = quantile(bin.size() < kFewestErrors ? all : bin, kOneSigmaShare);
    sigma_px.push_back(std::max(sigma, kLowestSigmaPx));
  }
  return sigma_px;
}

/// The cross-fitting of one training.
class SecondForestTrainer {
 public:
  SecondForestTrainer(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                      const TrainingProgress& progress)
      : scenes_(scenes), options_(options), progress_(progress) {
    std::vector<std::string> names;
    names.reserve(scenes.size());
    for (const SceneReference& scene : scenes) {
      names.push_back(scene.scene);
    }
    group_of_ = crossFittingGroups(names, options.second.groups);
    groups_ = names.empty() ? 0 : 1 + *std::max_element(group_of_.begin(), group_of_.end());
    const auto maps = static_cast<long>(scenes.size() * options.second.matching.size());
    pixels_ = std::min(options.second.pixels_per_scene, options.maxSamples() / std::max(maps, 1L));
  }

  void train(Forest& forest) {
    if (groups_ < 2) {
      report("no confidence forest: it needs scenes of at least two groups");
      return;
    }
    matchGroups();
    const std::optional<std::vector<ConfidenceForest>> crossed = crossConfidenceForests();
    if (!crossed.has_value()) {
      report(
          "no confidence forest: the scenes of some groups have no correct or no wrong "
          "disparities");
      return;
    }
    const ConfidenceSamples samples = confidenceSamples(kNoGroup);
    ConfidenceForest confidence = grow("confidence forest", samples, options_.second.confidence);
    fitSigma(*crossed, samples, confidence);
    forest.confidence = std::make_shared<const ConfidenceForest>(std::move(confidence));
    const double density = truthDensity();
    if (density < kLeastTruth) {
      report("no selection forest: the truth covers " +
             std::to_string(std::lround(100.0 * density)) + " % of the pixels, expected " +
             std::to_string(std::lround(100.0 * kLeastTruth)) +
             " %. Disparities will not be replaced");
      return;
    }
    const ConfidenceSamples proposals = selectionSamples(*crossed);
    if (hasBothClasses(proposals)) {
      forest.selection = std::make_shared<const ConfidenceForest>(
          grow("selection forest", proposals, options_.second.selection));
    }
  }

 private:
  static constexpr int kNoGroup = -1;

  /// The maps of a scene by one preset.
  struct Judged {
    JudgedScene scene;
    int group;
    std::uint64_t seed;
  };

  void report(const std::string& line) const { progress_({"second forest", 0, 1, line}); }

  void matchGroups() {
    for (int group = 0; group < groups_; ++group) {
      std::vector<SceneReference> others;
      for (std::size_t i = 0; i < scenes_.size(); ++i) {
        if (group_of_[i] != group) {
          others.push_back(scenes_[i]);
        }
      }
      report("second forest: first forest without group " + std::to_string(group + 1) + " of " +
             std::to_string(groups_));
      const auto first = std::make_shared<const Forest>(
          trainOnSamples(drawSamples(others, options_, progress_), others, options_, progress_));
      for (const StereoOptions& preset : options_.second.matching) {
        matchScenes(group, first, preset);
      }
    }
  }

  void matchScenes(int group, const std::shared_ptr<const Forest>& first,
                   const StereoOptions& preset) {
    StereoMatcher matcher(first, preset);
    for (std::size_t i = 0; i < scenes_.size(); ++i) {
      if (group_of_[i] != group) {
        continue;
      }
      const StereoScene scene = scenes_[i].read();
      StereoOptions options = preset;
      options.range = {0, scene.calibration.disparities};
      matcher.setOptions(options);
      judged_.push_back(
          {{matcher.match(scene.left, scene.right), scene.truth}, group, options_.seed + i});
    }
  }

  /// Share of the pixels of all scenes whose truth is known.
  double truthDensity() const {
    double known = 0.0;
    double pixels = 0.0;
    for (const Judged& judged : judged_) {
      const cv::Mat& truth = judged.scene.truth;
      known += cv::countNonZero(cv::abs(truth) < std::numeric_limits<float>::infinity());
      pixels += static_cast<double>(truth.total());
    }
    return known / pixels;
  }

  /// Of all scenes but those of `left_out`.
  ConfidenceSamples confidenceSamples(int left_out) const {
    ConfidenceSamples samples;
    for (const Judged& judged : judged_) {
      if (judged.group != left_out) {
        appendConfidenceSamples(judged.scene, pixels_, judged.seed, samples);
      }
    }
    return samples;
  }

  /// One without each group; none where samples are missing.
  std::optional<std::vector<ConfidenceForest>> crossConfidenceForests() const {
    std::vector<ConfidenceForest> forests;
    for (int group = 0; group < groups_; ++group) {
      const ConfidenceSamples samples = confidenceSamples(group);
      if (!hasBothClasses(samples)) {
        return std::nullopt;
      }
      forests.push_back(grow("confidence forest without group " + std::to_string(group + 1),
                             samples, options_.second.confidence));
    }
    return forests;
  }

  ConfidenceSamples selectionSamples(const std::vector<ConfidenceForest>& crossed) const {
    ConfidenceSamples samples;
    for (const Judged& judged : judged_) {
      appendSelectionSamples(judged.scene, crossed[judged.group], pixels_, judged.seed, samples);
    }
    return samples;
  }

  ConfidenceForest grow(const std::string& name, const ConfidenceSamples& samples,
                        const BoostingOptions& boosting) const {
    ConfidenceForest forest =
        trainConfidenceForest(samples, boosting, [&](int tree, double log_loss) {
          std::ostringstream line;
          if (tree == boosting.trees) {
            line << name << ": " << tree << " trees, " << samples.count()
                 << " samples, held-out log-loss " << log_loss;
          }
          progress_({name, tree, boosting.trees, line.str()});
        });
    measureHeldOut(samples, forest);
    std::ostringstream text;
    text << "trees " << boosting.trees << ", depth " << boosting.depth << ", learning rate "
         << boosting.learning_rate << ", groups " << groups_ << ", pixels per scene " << pixels_
         << ", presets " << options_.second.matching.size();
    forest.record.options = text.str();
    return forest;
  }

  /// To errors at confidences by forests that did not see the scene.
  void fitSigma(const std::vector<ConfidenceForest>& crossed, const ConfidenceSamples& samples,
                ConfidenceForest& forest) const {
    splitRoughness(samples, forest);
    ErrorBins bins(ConfidenceForest::kSigmaRoughnessBins * ConfidenceForest::kSigmaConfidenceBins);
    for (const Judged& judged : judged_) {
      ConfidenceForest judge = crossed[judged.group];
      judge.sigma_roughness_bounds = forest.sigma_roughness_bounds;
      collectErrors(judged.scene, judge, bins);
    }
    forest.sigma_px = sigmaOf(bins);
  }

  const std::vector<SceneReference>& scenes_;
  const TrainingOptions& options_;
  const TrainingProgress& progress_;
  std::vector<int> group_of_;
  int groups_ = 0;
  long pixels_ = 0;  ///< of each map
  std::vector<Judged> judged_;
};

}  // namespace

std::vector<int> crossFittingGroups(const std::vector<std::string>& names, int groups) {
  std::vector<int> group_of;
  const std::size_t wanted = std::max(1, groups);
  int group = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_due = i * wanted >= (static_cast<std::size_t>(group) + 1) * names.size();
    if (is_due && !startsWith(names[i], names[i - 1])) {
      ++group;
    }
    group_of.push_back(group);
  }
  return group_of;
}

void trainSecondForest(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                       const TrainingProgress& progress, Forest& forest) {
  if (options.second.enabled && options.kind == ForestKind::kOblivious) {
    SecondForestTrainer(scenes, options, progress).train(forest);
  }
}

}  // namespace cbmv
