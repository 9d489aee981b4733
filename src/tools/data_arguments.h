#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "data_sets/data_set.h"
#include "tools/range_checks.h"
#include "training/forest_training.h"

namespace cbmv {

inline constexpr const char* kDataSetHelp =
    "KIND:DIR; KIND is middlebury_v3, middlebury_2005 (2006 too; third size), "
    "middlebury_2005_half, "
    "middlebury_2005_full, kitti2012, kitti2015 or eth3d; or list:FILE, a text file of lines `left "
    "right disparity scale [ndisp]`";

/// --dataset, repeatable.
inline void addDataSetOption(CLI::App& app, std::vector<std::string>& data_sets) {
  app.add_option("--dataset", data_sets, std::string(kDataSetHelp) + "; repeatable")->required();
}

inline std::vector<DataSet> openDataSets(const std::vector<std::string>& names) {
  std::vector<DataSet> data_sets;
  data_sets.reserve(names.size());
  for (const std::string& name : names) {
    data_sets.push_back(DataSet::open(name));
  }
  return data_sets;
}

/// The folder or list file of each data set.
inline std::vector<std::string> foldersOf(const std::vector<DataSet>& data_sets) {
  std::vector<std::string> folders;
  for (const DataSet& data_set : data_sets) {
    folders.push_back(data_set.folder());
  }
  return folders;
}

inline void addSceneOptions(CLI::App& app, SceneFilter& filter) {
  app.add_option("--scenes", filter.only, "Only these scenes, separated by commas")->delimiter(',');
  app.add_option("--exclude", filter.excluded, "All but these scenes, separated by commas")
      ->delimiter(',');
}

inline void addSecondForestOptions(CLI::App& app, SecondForestOptions& options) {
  app.add_flag_callback(
      "--no-second-forest", [&options] { options.enabled = false; },
      "Train no confidence forest and no selection forest");
  app.add_option("--groups", options.groups,
                 "Number of scene groups: the second forest is trained on maps from first forests "
                 "that were trained on the other groups")
      ->check(wholeNumber(2, 100))
      ->capture_default_str();
  app.add_option("--second-pixels-per-scene", options.pixels_per_scene,
                 "Pixels drawn from each scene for each part of the second forest")
      ->check(wholeNumber(1))
      ->capture_default_str();
  app.add_option_function<int>(
         "--second-trees",
         [&options](int trees) { options.confidence.trees = options.selection.trees = trees; },
         "Trees of each part of the second forest, default " +
             std::to_string(options.confidence.trees))
      ->check(wholeNumber(1, ConfidenceForest::kMaxTrees));
}

inline void addTrainingOptions(CLI::App& app, TrainingOptions& options) {
  addSecondForestOptions(app, options.second);
  app.add_option("--pixels-per-scene", options.pixels_per_scene,
                 "Pixels drawn from each level of each scene for training; each gives up to three "
                 "samples")
      ->check(wholeNumber(1))
      ->capture_default_str();
  app.add_option("--max-samples", options.max_samples,
                 "Maximum number of samples from all scenes, default " +
                     std::to_string(TrainingOptions::defaultMaxSamples(ForestKind::kOblivious)) +
                     ", of a random forest " +
                     std::to_string(TrainingOptions::defaultMaxSamples(ForestKind::kRandomForest)) +
                     "; limits the memory (about 90 bytes per sample, random forest 1800)")
      ->check(wholeNumber(1, 1000000000000));
  options.search.levels = 3;  // as in the presets
  app.add_option("--search-levels", options.search.levels,
                 "Levels of the coarse-to-fine search that the forest is trained for; 0: "
                 "exhaustive search only")
      ->check(wholeNumber(0, 8))
      ->capture_default_str();
  app.add_option("--search-margin", options.search.margin_px,
                 "Search margin of the presets that the forest is trained for (px)")
      ->check(wholeNumber(0, 16))
      ->capture_default_str();
  app.add_option("--windowed-share", options.windowed_share,
                 "Fraction of the pixels (0 to 1) whose competing hypotheses are limited to the "
                 "search windows; the others use the whole range")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Random seed of the sampling")->capture_default_str();
  const std::map<std::string, ForestKind> kinds = {{"oblivious", ForestKind::kOblivious},
                                                   {"random-forest", ForestKind::kRandomForest}};
  app.add_option_function<std::string>(
         "--kind", [&options, kinds](const std::string& kind) { options.kind = kinds.at(kind); },
         "oblivious: boosted oblivious trees, fast (the default); random-forest: the paper's "
         "forest, slow in matching")
      ->check(CLI::IsMember(kinds));
  app.add_option_function<int>(
      "--trees",
      [&options](int trees) {
        options.boosting.trees = trees;
        options.random_forest.trees = trees;
      },
      "Number of trees, default " + std::to_string(options.boosting.trees) +
          ", of a random forest " + std::to_string(options.random_forest.trees));
  app.add_option("--depth", options.boosting.depth, "Levels of an oblivious tree")
      ->capture_default_str();
  app.add_option("--learning-rate", options.boosting.learning_rate,
                 "Learning rate of oblivious trees")
      ->capture_default_str();
  app.add_option("--samples-per-leaf", options.random_forest.samples_per_leaf,
                 "Fewest samples in a leaf of a random forest")
      ->capture_default_str();
  app.add_option("--features-per-split", options.random_forest.features_per_split,
                 "Features drawn for each split of a random forest")
      ->capture_default_str();
  app.add_option_function<std::vector<std::string>>(
         "--matchers",
         [&options](const std::vector<std::string>& names) {
           options.boosting.matchers.reset();
           for (const std::string& name : names) {
             const auto found = std::find(kMatcherNames.begin(), kMatcherNames.end(), name);
             options.boosting.matchers.set(found - kMatcherNames.begin());
           }
         },
         "Matchers whose features oblivious trees may use, separated by commas; fewer are "
         "faster "
         "(default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kMatcherNames.begin(), kMatcherNames.end())));
}

}  // namespace cbmv
