// Searches parameters of cost aggregation, SGM and refinement on pairs with ground truth.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "forest/forest_file.h"
#include "io/other_file.h"
#include "io/output_check.h"
#include "tools/data_arguments.h"
#include "tools/program_files.h"
#include "tools/range_checks.h"
#include "tools/run_tool.h"
#include "training/cross_validation.h"
#include "tuning/tuning.h"

#include "cbmv_stereo/parameters.h"

namespace {

struct Arguments {
  std::vector<std::string> data_sets, forests;
  std::string start, output;
  int folds = 0;
  cbmv::SceneFilter filter;
  cbmv::TrainingOptions training;
  cbmv::TuningRequest request;
};

std::vector<std::shared_ptr<const cbmv::Forest>> readForests(
    const std::vector<std::string>& files) {
  std::vector<std::shared_ptr<const cbmv::Forest>> forests;
  forests.reserve(files.size());
  for (const std::string& file : files) {
    forests.push_back(cbmv::loadForest(file));
  }
  return forests;
}

void tune(Arguments& arguments) {
  cbmv::TuningRequest& request = arguments.request;
  if (!arguments.start.empty()) {
    arguments.start = cbmv::presetFile(arguments.start);
    cbmv::readPreset(arguments.start, request.start);
    request.start_name = std::filesystem::path(arguments.start).filename().string();
  }
  cbmv::requireWritableFile(arguments.output);
  std::transform(arguments.forests.begin(), arguments.forests.end(), arguments.forests.begin(),
                 cbmv::forestFile);
  const std::vector<cbmv::DataSet> data_sets = cbmv::openDataSets(arguments.data_sets);
  cbmv::requireOtherFiles(arguments.forests, {arguments.output});
  cbmv::requireOtherFiles(cbmv::foldersOf(data_sets), {arguments.output});
  cbmv::requireOtherFiles({arguments.start}, {arguments.output});
  request.scenes = cbmv::chooseScenes(data_sets, arguments.filter);
  request.search.seed = arguments.training.seed;
  arguments.training.rectification = request.start.rectification;
  arguments.training.second.matching = {request.start};
  cbmv::TuningEvents events;
  events.progress = cbmv::printLine;
  events.improved = [&](const cbmv::TuningReport& report) {
    cbmv::writePresets(report, arguments.output);
  };
  request.forests =
      arguments.folds > 0
          ? cbmv::trainFolds(request.scenes,
                             cbmv::chooseScenes(data_sets, {{}, arguments.filter.excluded}),
                             arguments.training, cbmv::printLine)
          : readForests(arguments.forests);
  const cbmv::TuningReport report = cbmv::tune(request, events);
  std::printf("\n%swrote %s\n", cbmv::describeReport(report).c_str(), arguments.output.c_str());
}

void addSearchOptions(CLI::App& app, Arguments& arguments) {
  cbmv::TuningRequest& request = arguments.request;
  app.add_option("--start", arguments.start,
                 "Preset to start from, name or path (default: the default parameters)");
  app.add_option("--parameters", request.parameters,
                 "Parameters to search, separated by commas (names: docs/parameters.md)")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--objective", request.objectives,
                 "Error to minimize, mean over non-occluded pixels: bad_0.5, bad_1, bad_2, bad_3, "
                 "avg, …, or a sum such as bad_1+bad_4. One for all data sets, or one per data "
                 "set, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--evaluations", request.search.evaluations, "Number of evaluations")
      ->check(cbmv::wholeNumber(1))
      ->capture_default_str();
  app.add_option("--global-evaluations", request.search.global_evaluations,
                 "Number of evaluations for the global search, before the local search")
      ->check(cbmv::wholeNumber(0))
      ->capture_default_str();
  app.add_option("--rows", request.rows,
                 "Use only this number of middle rows per scene, for quick trials; 0: all. "
                 "Parameters tuned on a strip are not optimal for whole images")
      ->check(cbmv::wholeNumber(0))
      ->capture_default_str();
  app.add_flag("--cross-validate", request.cross_validate,
               "Search three more times, each without one fold of Middlebury v3; score this fold "
               "and write its preset to PRESET_without_fold_N.yaml, for cbmv_eval --folds 3");
  app.add_option("--threads", request.start.threads, "Number of threads; 0: all hardware threads")
      ->check(cbmv::wholeNumber(0, 1024))
      ->capture_default_str();
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): only if an option is declared incorrectly
int main(int argc, char** argv) {
  CLI::App app{
      "Searches the parameters of cost aggregation, SGM and refinement on rectified stereo pairs "
      "with ground truth, and writes them as a preset"};
  Arguments arguments;
  arguments.request.objectives = {"bad_1"};
  cbmv::addDataSetOption(app, arguments.data_sets);
  cbmv::addSceneOptions(app, arguments.filter);
  CLI::Option_group* forests = app.add_option_group("Forests", "One of these");
  forests->add_option(
      "--forest", arguments.forests,
      std::string(cbmv::kForestHelp) +
          "; repeatable; each scene is matched with the first that was not trained on it");
  forests
      ->add_option(
          "--folds", arguments.folds,
          "3: train on the folds of the paper on Middlebury v3; each scene is matched with "
          "the forest that was not trained on it")
      ->check(CLI::IsMember({3}));
  forests->require_option(1);
  addSearchOptions(app, arguments);
  app.add_option("--output", arguments.output,
                 "Preset to write; replaced whenever a better one is found")
      ->required();
  cbmv::addTrainingOptions(app, arguments.training);
  return cbmv::runTool(app, argc, argv, "cbmv_tune", [&] { tune(arguments); });
}
