// Trains a forest on pairs with ground truth.

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "forest/forest_file.h"
#include "io/other_file.h"
#include "io/output_check.h"
#include "tools/data_arguments.h"
#include "tools/program_files.h"
#include "tools/progress_bar.h"
#include "tools/run_tool.h"
#include "training/forest_training.h"
#include "training/held_out_measures.h"
#include "training/sample_file.h"
#include "training/second_forest.h"

#include "cbmv_stereo/parameters.h"

// NOLINTNEXTLINE(bugprone-exception-escape): only if an option is declared incorrectly
int main(int argc, char** argv) {
  CLI::App app{"Trains a forest on rectified stereo pairs with ground truth"};
  std::vector<std::string> data_sets;
  cbmv::SceneFilter filter;
  std::string output;
  std::string exported;
  cbmv::TrainingOptions options;
  cbmv::addDataSetOption(app, data_sets);
  cbmv::addSceneOptions(app, filter);
  app.add_option("--output", output, "The forest to write")->required();
  app.add_option(
      "--export-samples", exported,
      "CSV file for the training samples: feature values and label (1 correct, 0 wrong)");
  std::vector<std::string> presets = {"quality"};
  app.add_option(
         "--preset", presets,
         "Presets for which the second forest is trained, names or YAML files, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  cbmv::addTrainingOptions(app, options);
  return cbmv::runTool(app, argc, argv, "cbmv_train", [&] {
    cbmv::requireWritableFile(output);
    if (!exported.empty()) {
      cbmv::requireWritableFile(exported);
    }
    options.second.matching.clear();
    for (const std::string& preset : presets) {
      cbmv::readPreset(cbmv::presetFile(preset), options.second.matching.emplace_back());
    }
    cbmv::ProgressBar bar(stdout, cbmv::isTerminal(stdout));
    const auto progress = [&bar](const cbmv::TrainingStep& step) {
      bar.show(step.phase, step.done, step.total, step.line);
    };
    const auto opened = cbmv::openDataSets(data_sets);
    cbmv::requireOtherFiles(cbmv::foldersOf(opened), {output, exported});
    const auto scenes = cbmv::chooseScenes(opened, filter);
    cbmv::Samples samples = cbmv::drawSamples(scenes, options, progress);
    if (!exported.empty()) {
      cbmv::writeSamples(samples, exported);
    }
    cbmv::Forest forest = cbmv::trainOnSamples(samples, scenes, options, progress);
    samples = {};  // frees memory for the second forest
    cbmv::trainSecondForest(scenes, options, progress, forest);
    cbmv::writeForest(forest, output);
    std::printf("\nwrote %s: %zu trees\n%s", output.c_str(),
                std::max(forest.trees.size(), forest.general_trees.size()),
                cbmv::describeProvenance(forest).c_str());
  });
}
