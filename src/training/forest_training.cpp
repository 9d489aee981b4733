#include "training/forest_training.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>

#include "forest/forest_evaluator.h"
#include "pipeline/machine_memory.h"
#include "pipeline/pyramid_matcher.h"
#include "training/held_out_measures.h"
#include "training/second_forest.h"
#include "training/training_checks.h"

namespace cbmv {
namespace {

constexpr std::size_t kSamplesPerPixel = 3;
constexpr double kBytesPerSample = 4.0 * kFeatureCount + 2;  // as reserve takes them

TrainingPair preparePair(const StereoScene& scene, const RectificationOptions& options) {
  const DisparityRange range{0, scene.calibration.disparities};
  cv::Mat right = scene.right;
  if (options.enabled) {
    right = alignRightRows(right, estimateVerticalOffset(scene.left, right, range, options));
  }
  return {scene.left, right, scene.truth, scene.visible, range};
}

/// Samples of the whole range at full size, for the forest that finds the windows.
Samples drawFirstSamples(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                         long pixels, const TrainingProgress& progress) {
  Samples samples;
  const auto total = static_cast<int>(scenes.size());
  for (int done = 0; done < total;) {
    appendSamples(preparePair(scenes[done].read(), options.rectification), pixels,
                  options.seed + done, samples);
    progress({"first sampling", ++done, total, ""});
  }
  return samples;
}

/// Draws the samples of a pair from every level of a search.
class LevelSampler {
 public:
  /// `first`: finds the windows; null: none are wanted.
  LevelSampler(const TrainingOptions& options, std::unique_ptr<const Forest> first)
      : options_(options), first_(std::move(first)) {
    matching_.search = options.search;
    if (first_ != nullptr) {
      evaluator_ = std::make_unique<ForestEvaluator>(*first_);
    }
  }

  void append(TrainingPair pair, long pixels, std::uint64_t seed, Samples& samples) {
    matching_.range = pair.range;
    const int levels = searchLevels(pair.left.size(), matching_) + 1;
    if (first_ != nullptr) {
      pyramid_.match(pair.left, pair.right, matching_, *first_, *evaluator_, result_);
    }
    const long windowed =
        first_ == nullptr ? 0 : std::lround(options_.windowed_share * static_cast<double>(pixels));
    HeldOutBand band(pair.left.rows, seed);
    for (int level = 0; level < levels; ++level) {
      const std::uint64_t own_seed = seed + kSeedsPerLevel * level;
      if (level > 0) {
        pair = halvePair(pair);
        band = band.halved();
      }
      if (windowed < pixels) {
        whole_.buildExhaustive(pair.left.rows, pair.left.cols, pair.range);
        appendSamples(pair, whole_, band, pixels - windowed, own_seed, samples);
      }
      if (windowed > 0) {
        appendSamples(pair, pyramid_.space(level), band, windowed, own_seed + kSeedsPerLevel / 2,
                      samples);
      }
    }
  }

 private:
  static constexpr std::uint64_t kSeedsPerLevel = std::uint64_t{1} << 32;  // scenes have the rest

  const TrainingOptions& options_;
  std::unique_ptr<const Forest> first_;
  std::unique_ptr<const ForestEvaluator> evaluator_;
  StereoOptions matching_;
  PyramidMatcher pyramid_;
  StereoResult result_;
  SearchSpace whole_;
};

/// Null where no windows are wanted.
std::unique_ptr<const Forest> trainFirstForest(const std::vector<SceneReference>& scenes,
                                               const TrainingOptions& options, long pixels,
                                               const TrainingProgress& progress) {
  if (options.search.levels == 0 || options.windowed_share == 0.0) {
    return nullptr;
  }
  const long few = std::max(pixels / 4, 1L);
  return std::make_unique<const Forest>(trainForest(
      drawFirstSamples(scenes, options, few, progress), options.boosting, [&](int tree, double) {
        progress({"first forest", tree, options.boosting.trees, ""});
      }));
}

/// Growing while scenes come would take twice the memory.
void reserve(Samples& samples, std::size_t count) {
  for (std::vector<float>& column : samples.features) {
    column.reserve(count);
  }
  samples.labels.reserve(count);
  samples.held_out.reserve(count);
}

/// Titles of the data sets, each once.
std::string dataSetTitles(const std::vector<SceneReference>& scenes) {
  std::vector<std::string> titles;
  std::string text;
  for (const SceneReference& scene : scenes) {
    const std::string& title = scene.data_set.title();
    if (std::find(titles.begin(), titles.end(), title) == titles.end()) {
      titles.push_back(title);
      text += (text.empty() ? "" : ", ") + title;
    }
  }
  return text;
}

Forest trainOblivious(const Samples& samples, const BoostingOptions& options,
                      const TrainingProgress& progress) {
  return trainForest(samples, options, [&](int tree, double log_loss) {
    std::ostringstream line;
    if (tree % 8 == 0 || tree == options.trees) {
      line << "tree " << tree << " of " << options.trees << ", held-out log-loss " << log_loss;
    }
    progress({"boosting", tree, options.trees, line.str()});
  });
}

Forest trainPaperForest(const Samples& samples, const TrainingOptions& options,
                        const TrainingProgress& progress) {
  progress({"growing", 0, 1, ""});  // all trees at once
  Forest forest = trainRandomForest(samples, options.random_forest, options.seed);
  progress({"growing", 1, 1,
            "grew " + std::to_string(options.random_forest.trees) + " trees of a random forest"});
  return forest;
}

void describeTo(std::ostream& text, const BoostingOptions& boosting) {
  text << "trees " << boosting.trees << ", depth " << boosting.depth << ", learning rate "
       << boosting.learning_rate << ", regularization " << boosting.regularization;
  if (!boosting.matchers.all()) {
    text << ", matchers";
    for (int m = 0; m < kMatcherCount; ++m) {
      text << (boosting.matchers[m] ? std::string(" ") + kMatcherNames[m] : "");
    }
  }
}

void describeTo(std::ostream& text, const RandomForestOptions& forest) {
  text << "random forest, trees " << forest.trees << ", samples per leaf "
       << forest.samples_per_leaf << ", features per split " << forest.features_per_split
       << ", part of the samples per tree " << forest.samples_per_tree;
}

}  // namespace

std::string describe(const TrainingOptions& options) {
  std::ostringstream text;
  if (options.kind == ForestKind::kOblivious) {
    describeTo(text, options.boosting);
  } else {
    describeTo(text, options.random_forest);
  }
  if (options.search.levels > 0) {
    text << ", search levels " << options.search.levels << ", neighborhood "
         << options.search.neighborhood_px << ", margin " << options.search.margin_px
         << ", windowed share " << options.windowed_share;
  }
  text << ", pixels per scene " << options.pixels_per_scene << ", samples at most "
       << options.maxSamples() << ", rectification refinement "
       << (options.rectification.enabled ? "on" : "off");
  return text.str();
}

long pixelsPerScene(std::size_t scenes, const TrainingOptions& options) {
  const std::size_t least = kSamplesPerPixel * (options.search.levels + 1) * scenes;
  const long share = options.maxSamples() / static_cast<long>(least);
  requireForTraining(share > 0, "the samples must be at least " + std::to_string(least) + " for " +
                                    std::to_string(options.search.levels + 1) + " levels of " +
                                    std::to_string(scenes) + " scenes");
  return std::min(options.pixels_per_scene, share);
}

Samples drawSamples(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                    const TrainingProgress& progress) {
  const long pixels = pixelsPerScene(scenes.size(), options);
  requireForTraining(options.windowed_share >= 0.0 && options.windowed_share <= 1.0,
                     "the windowed share is not in [0, 1]. Correct --windowed-share");
  const auto total = static_cast<int>(scenes.size());
  int done = 0;
  for (const SceneReference& scene : scenes) {
    scene.read();  // bad files are rejected before hours are spent
    progress({"reading", ++done, total, ""});
  }
  LevelSampler sampler(options, trainFirstForest(scenes, options, pixels, progress));
  Samples samples;
  const std::size_t count = kSamplesPerPixel * (options.search.levels + 1) *
                            static_cast<std::size_t>(pixels) * scenes.size();
  requireMachineMemory(static_cast<double>(count) * kBytesPerSample / (1 << 20),
                       std::to_string(count) + " samples",
                       "Lower --max-samples or --pixels-per-scene");
  reserve(samples, count);
  for (done = 0; done < total;) {
    const SceneReference& scene = scenes[done];
    sampler.append(preparePair(scene.read(), options.rectification), pixels, options.seed + done,
                   samples);
    progress(
        {"sampling", ++done, total,
         "sampled " + scene.scene + ", " + std::to_string(samples.count()) + " samples so far"});
  }
  return samples;
}

Forest trainOnSamples(const Samples& samples, const std::vector<SceneReference>& scenes,
                      const TrainingOptions& options, const TrainingProgress& progress) {
  Forest forest = options.kind == ForestKind::kOblivious
                      ? trainOblivious(samples, options.boosting, progress)
                      : trainPaperForest(samples, options, progress);
  measureHeldOut(samples, forest);
  forest.provenance.program = "cbmv_train " CBMV_VERSION;
  forest.provenance.data_set = dataSetTitles(scenes);
  for (const SceneReference& scene : scenes) {
    forest.provenance.scenes.push_back(scene.scene);
  }
  forest.provenance.options = describe(options);
  forest.provenance.seed = options.seed;
  return forest;
}

Forest trainOnScenes(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                     const TrainingReport& report) {
  const TrainingProgress progress = [&](const TrainingStep& step) {
    if (!step.line.empty()) {
      report(step.line);
    }
  };
  Forest forest = trainOnSamples(drawSamples(scenes, options, progress), scenes, options, progress);
  trainSecondForest(scenes, options, progress, forest);
  return forest;
}

}  // namespace cbmv
