// Measures the errors of the method, or of ready disparity maps, on pairs with ground truth.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "data_arguments.h"
#include "run_tool.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/evaluation/evaluation.h"
#include "cbmv_stereo/evaluation/folds.h"
#include "cbmv_stereo/evaluation/pictures.h"
#include "cbmv_stereo/forest/forest_file.h"
#include "cbmv_stereo/pipeline/parameters.h"

namespace {

struct Arguments {
  std::string data_set, forest, disparities, preset, maps, json, csv, markdown;
  int folds = 0;
  bool resume = false;
  cbmv::SceneFilter filter;
  cbmv::StereoOptions options;
  cbmv::TrainingOptions training;
};

/// What is evaluated: the maps, in which order, and the head of the report.
struct Evaluation {
  std::vector<std::string> scenes;
  cbmv::DisparitySource source;
  cbmv::EvaluationReport report;
};

void printLine(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

std::string nameOf(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// By the three folds of Middlebury v3. Training leaves out what --exclude names.
void setUpFolds(const Arguments& arguments, const cbmv::DataSet& data_set, std::string& settings,
                Evaluation& evaluation) {
  if (arguments.folds != 3 || data_set.kind() != "middlebury_v3") {
    throw cbmv::Error("--folds must be 3 and needs a data set of the kind middlebury_v3");
  }
  cbmv::TrainingOptions training = arguments.training;
  training.rectification = arguments.options.rectification;
  evaluation.scenes = cbmv::orderByFold(evaluation.scenes);
  evaluation.report.forest = "3 folds of " + data_set.title();
  settings += cbmv::describe(training) + ", seed " + std::to_string(training.seed);
  const auto pool = cbmv::chooseScenes({data_set}, {{}, arguments.filter.excluded});
  for (const cbmv::SceneReference& scene : pool) {
    settings += ", " + scene.scene;
  }
  evaluation.source = cbmv::foldSource(pool, training, arguments.options, printLine);
}

Evaluation setUp(const Arguments& arguments, const cbmv::DataSet& data_set) {
  Evaluation evaluation;
  for (const auto& scene : cbmv::chooseScenes({data_set}, arguments.filter)) {
    evaluation.scenes.push_back(scene.scene);
  }
  if (!arguments.disparities.empty()) {
    evaluation.source = cbmv::fileSource(arguments.disparities);
    return evaluation;
  }
  std::string settings = data_set.title() + cbmv::describeOptions(arguments.options);
  if (arguments.folds > 0) {
    setUpFolds(arguments, data_set, settings, evaluation);
  } else {
    const auto forest = std::make_shared<cbmv::Forest>(cbmv::readForest(arguments.forest));
    evaluation.report.forest = forest->name;
    settings += cbmv::forestChecksum(*forest);
    evaluation.source = cbmv::matchingSource(forest, arguments.options);
  }
  evaluation.report.preset = nameOf(arguments.preset);
  evaluation.report.fingerprint = cbmv::fingerprintOf(settings);
  return evaluation;
}

void resume(const Arguments& arguments, const cbmv::DataSet& data_set, Evaluation& evaluation) {
  if (!arguments.resume || !std::filesystem::exists(arguments.json)) {
    return;
  }
  const int found = cbmv::resumeReport(cbmv::readJsonReport(arguments.json), data_set,
                                       evaluation.scenes, evaluation.report);
  if (found < 0) {
    printLine(arguments.json + " is of another forest or other settings; starting anew");
  }
}

void writeReports(const Arguments& arguments, const cbmv::EvaluationReport& report) {
  if (!arguments.json.empty()) {
    cbmv::writeJsonReport(report, arguments.json);
  }
  if (!arguments.csv.empty()) {
    cbmv::writeCsvReport(report, arguments.csv);
  }
  if (!arguments.markdown.empty()) {
    cbmv::writeMarkdownReport(report, arguments.markdown);
  }
}

void evaluate(Arguments arguments) {
  if (!arguments.preset.empty()) {
    cbmv::readPreset(arguments.preset, arguments.options);
  }
  arguments.options.range = cbmv::DisparityRange();  // each scene brings its own
  const cbmv::DataSet data_set = cbmv::DataSet::open(arguments.data_set);
  Evaluation evaluation = setUp(arguments, data_set);
  resume(arguments, data_set, evaluation);
  writeReports(arguments, evaluation.report);  // a path that cannot be written ends it here

  cbmv::EvaluationEvents events;
  events.progress = printLine;
  events.failure = [](const std::string& line) {
    std::fprintf(stderr, "cbmv_eval: %s\n", line.c_str());
  };
  events.maps = [&](const cbmv::StereoScene& scene, const cbmv::SceneMaps& maps) {
    if (!arguments.maps.empty()) {
      cbmv::writeMaps(arguments.maps, scene, maps);
      cbmv::writePictures(arguments.maps, scene, maps);
    }
  };
  events.scored = [&](const cbmv::EvaluationReport& report) { writeReports(arguments, report); };
  const int failed = cbmv::evaluateScenes(data_set, evaluation.scenes, evaluation.source, events,
                                          evaluation.report);
  std::printf("\n%s", cbmv::formatReport(evaluation.report).c_str());
  if (failed > 0) {
    throw cbmv::Error(std::to_string(failed) + " of " + std::to_string(evaluation.scenes.size()) +
                      " scenes are left out");
  }
}

void addSourceOptions(CLI::App& app, Arguments& arguments) {
  CLI::Option_group* source = app.add_option_group("What is measured", "One of these");
  source->add_option("--forest", arguments.forest, "Match with this forest");
  CLI::Option* disparities = source->add_option(
      "--disparities", arguments.disparities,
      "Folder of ready maps: SCENE.pfm or SCENE.png (16 bits, value / 256, 0 = none), and "
      "SCENE_confidence.pfm where there is one");
  source->add_option("--folds", arguments.folds,
                     "3: train the folds of the paper on Middlebury v3 and match each scene with "
                     "the forest that did not see it");
  source->require_option(1);
  app.add_option("--preset", arguments.preset,
                 "YAML file of parameters; the disparities searched are those of the scene")
      ->excludes(disparities);
  app.add_flag("--resume", arguments.resume,
               "Keep the scenes that FILE of --json holds already, of the same forest and settings")
      ->excludes(disparities);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Measures disparity errors on rectified stereo pairs with ground truth"};
  Arguments arguments;
  app.add_option("--dataset", arguments.data_set, cbmv::kDataSetHelp)->required();
  cbmv::addSceneOptions(app, arguments.filter);
  addSourceOptions(app, arguments);
  app.add_option("--threads", arguments.options.threads, "0: as many as the machine has")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  CLI::Option* json =
      app.add_option("--json", arguments.json, "Report to write; replaced after every scene");
  app.get_option("--resume")->needs(json);
  app.add_option("--csv", arguments.csv, "The same as CSV");
  app.add_option("--markdown", arguments.markdown, "The same as tables in Markdown");
  app.add_option("--maps", arguments.maps,
                 "Folder to write the maps to, in the form that --disparities reads, and pictures "
                 "of them, which scripts/evaluation_report shows");
  cbmv::addTrainingOptions(app, arguments.training);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return cbmv::runTool("cbmv_eval", [&] { evaluate(arguments); });
}
