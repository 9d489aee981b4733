// Measures the errors of the method, or of existing disparity maps, on pairs with ground truth.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "evaluation/evaluation.h"
#include "evaluation/evaluation_page.h"
#include "evaluation/json_report.h"
#include "evaluation/opencv_baseline.h"
#include "evaluation/pictures.h"
#include "evaluation/submission.h"
#include "forest/forest_file.h"
#include "io/binary_file.h"
#include "io/other_file.h"
#include "io/output_check.h"
#include "tools/data_arguments.h"
#include "tools/program_files.h"
#include "tools/range_checks.h"
#include "tools/run_tool.h"
#include "training/cross_validation.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/parameters.h"

namespace {

struct Arguments {
  std::string data_set, train_data_set, forest, disparities, maps, json, csv, markdown, report,
      submission;
  std::vector<std::string> presets;
  int folds = 0;
  std::optional<double> density;
  double error_scale = 1.0;
  bool resume = false;
  bool stereo_sgbm = false;
  bool automatic_range = false;
  cbmv::SceneFilter filter;
  cbmv::StereoOptions options;  ///< before presets are applied
  cbmv::TrainingOptions training;
};

/// What is evaluated: source of the maps, order of the scenes, and the header of the report.
struct Evaluation {
  std::vector<std::string> scenes;
  cbmv::DisparitySource source;
  cbmv::EvaluationReport report;
};

std::string nameOf(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// Identifies a data set in the fingerprint. It includes the folder, because other data sets may
/// have scenes with the same names, and the kind, because it determines how the truth is read.
std::string identityOf(const cbmv::DataSet& data_set) {
  return data_set.title() + " " + data_set.kind() + " " +
         std::filesystem::weakly_canonical(data_set.folder()).string();
}

/// Training data of the fold forests, without the scenes of --exclude.
cbmv::DataSet trainingDataSet(const Arguments& arguments, const cbmv::DataSet& data_set) {
  if (arguments.train_data_set.empty()) {
    return data_set;
  }
  cbmv::DataSet training = cbmv::DataSet::open(arguments.train_data_set);
  if (training.kind() != data_set.kind()) {
    throw cbmv::Error("--train-dataset " + arguments.train_data_set + " has the kind " +
                      training.kind() + ", expected " + data_set.kind() +
                      ", the kind of --dataset. Give a data set of this kind.");
  }
  return training;
}

/// Sets up the three folds of Middlebury v3.
void setUpFolds(const Arguments& arguments, const std::vector<cbmv::StereoOptions>& options,
                const cbmv::DataSet& data_set, std::string& settings, Evaluation& evaluation) {
  if (arguments.folds != 3 || data_set.kind() != "middlebury_v3") {
    throw cbmv::Error(
        "--folds requires the value 3 and a data set of kind middlebury_v3. Correct --folds or "
        "--dataset");
  }
  cbmv::TrainingOptions training = arguments.training;
  training.rectification = arguments.options.rectification;
  evaluation.scenes = cbmv::orderByFold(evaluation.scenes);
  const cbmv::DataSet train_data_set = trainingDataSet(arguments, data_set);
  evaluation.report.forest = "3 folds of " + train_data_set.title();
  settings += cbmv::describe(training) + ", seed " + std::to_string(training.seed) + " " +
              identityOf(train_data_set);
  const auto pool = cbmv::chooseScenes({train_data_set}, {{}, arguments.filter.excluded});
  for (const cbmv::SceneReference& scene : pool) {
    settings += ", " + scene.scene;
  }
  evaluation.source = cbmv::foldSource(pool, training, options, cbmv::printLine);
}

/// One element per preset; the defaults without a preset.
std::vector<cbmv::StereoOptions> readPresets(const Arguments& arguments) {
  if (arguments.presets.size() > 1 && arguments.folds == 0) {
    throw cbmv::Error(std::to_string(arguments.presets.size()) +
                      " presets are given, expected one, or three with --folds 3 (one per fold). "
                      "Correct --preset");
  }
  std::vector<cbmv::StereoOptions> options(std::max<std::size_t>(1, arguments.presets.size()),
                                           arguments.options);
  for (std::size_t i = 0; i < arguments.presets.size(); ++i) {
    cbmv::readPreset(arguments.presets[i], options[i]);
  }
  for (cbmv::StereoOptions& each : options) {
    each.range = cbmv::DisparityRange();  // each scene has its own range
    if (arguments.automatic_range) {
      each.range.count = 0;
    }
  }
  return options;
}

Evaluation setUp(const Arguments& arguments, const cbmv::DataSet& data_set) {
  Evaluation evaluation;
  evaluation.report.scoring = {data_set.correctPx(), arguments.error_scale};
  evaluation.report.density = arguments.density;
  for (const auto& scene : cbmv::chooseScenes({data_set}, arguments.filter)) {
    evaluation.scenes.push_back(scene.scene);
  }
  if (!arguments.disparities.empty()) {
    evaluation.source = cbmv::fileSource(arguments.disparities);
    return evaluation;
  }
  if (arguments.stereo_sgbm) {
    evaluation.source = cbmv::stereoSgbmSource();
    evaluation.report.fingerprint = cbmv::fingerprintOf(identityOf(data_set) + "StereoSGBM");
    return evaluation;
  }
  const std::vector<cbmv::StereoOptions> options = readPresets(arguments);
  std::string settings = identityOf(data_set);
  for (const cbmv::StereoOptions& each : options) {
    settings += cbmv::describeOptions(each);
  }
  if (arguments.folds > 0) {
    setUpFolds(arguments, options, data_set, settings, evaluation);
  } else {
    const auto forest = cbmv::loadForest(cbmv::forestFile(arguments.forest));
    evaluation.report.forest = forest->name;
    settings += cbmv::forestChecksum(*forest);
    evaluation.source = cbmv::matchingSource(forest, options.front());
  }
  for (const std::string& preset : arguments.presets) {
    evaluation.report.preset += (evaluation.report.preset.empty() ? "" : ", ") + nameOf(preset);
  }
  evaluation.report.fingerprint = cbmv::fingerprintOf(settings);
  return evaluation;
}

using Submission = std::optional<cbmv::SubmissionWriter>;

/// Whether all outputs of this run exist for the scene.
bool isWritten(const Arguments& arguments, const Submission& submission, const std::string& scene) {
  const std::string base = (std::filesystem::path(arguments.maps) / scene).string();
  return (arguments.maps.empty() || (std::filesystem::exists(base + ".pfm") &&
                                     std::filesystem::exists(base + "_disparity.jpg"))) &&
         (!submission || submission->has(scene));
}

void resume(const Arguments& arguments, const cbmv::DataSet& data_set, const Submission& submission,
            Evaluation& evaluation) {
  if (!arguments.resume || !std::filesystem::exists(arguments.json)) {
    return;
  }
  std::vector<std::string> written;
  std::copy_if(evaluation.scenes.begin(), evaluation.scenes.end(), std::back_inserter(written),
               [&](const std::string& scene) { return isWritten(arguments, submission, scene); });
  const int found = cbmv::resumeReport(cbmv::readJsonReport(arguments.json), data_set, written,
                                       evaluation.report);
  if (found < 0) {
    cbmv::printLine(arguments.json +
                    " has another data set, forest or other settings. Starting again");
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

/// Checks all outputs before the work starts.
void requireWritableOutputs(const Arguments& arguments) {
  for (const std::string& folder : {arguments.maps, arguments.submission}) {
    if (!folder.empty()) {
      cbmv::requireWritableFolder(folder);
    }
  }
  for (const std::string& file : {arguments.json, arguments.csv, arguments.markdown}) {
    if (!file.empty()) {
      cbmv::requireWritableFile(file);
    }
  }
}

/// Outputs must not overwrite a forest, a preset, a list of pairs or maps to evaluate.
void requireOtherOutputs(const Arguments& arguments, const cbmv::DataSet& data_set) {
  std::vector<std::string> inputs = arguments.presets;
  inputs.push_back(data_set.folder());
  if (!arguments.forest.empty()) {
    inputs.push_back(cbmv::forestFile(arguments.forest));
  }
  cbmv::requireOtherFiles(inputs, {arguments.json, arguments.csv, arguments.markdown});
  cbmv::requireOtherFiles({arguments.disparities}, {arguments.maps});
}

/// Sets options that follow from other options.
void complete(Arguments& arguments) {
  for (std::string& preset : arguments.presets) {
    preset = cbmv::presetFile(preset);
  }
  if (!arguments.report.empty()) {
    cbmv::requireWritableFolder(arguments.report);
    cbmv::makeFolder(arguments.report);
    const std::filesystem::path folder(arguments.report);
    arguments.json = arguments.json.empty() ? (folder / "report.json").string() : arguments.json;
    arguments.maps = arguments.maps.empty() ? (folder / "maps").string() : arguments.maps;
  }
  if (arguments.resume && arguments.json.empty()) {
    throw cbmv::Error(
        "--resume needs --json or --report with the report to resume. Add one of them");
  }
}

cbmv::EvaluationEvents makeEvents(const Arguments& arguments, const Submission& submission) {
  cbmv::EvaluationEvents events;
  events.progress = cbmv::printLine;
  events.failure = [](const std::string& line) {
    std::fprintf(stderr, "cbmv_eval: %s\n", line.c_str());
  };
  events.maps = [&](const cbmv::StereoScene& scene, const cbmv::SceneMaps& maps) {
    if (!arguments.maps.empty()) {
      cbmv::writeMaps(arguments.maps, scene, maps);
      cbmv::writePictures(arguments.maps, scene, maps);
    }
    if (submission) {
      submission->write(scene, maps);
    }
  };
  events.scored = [&](const cbmv::EvaluationReport& report) { writeReports(arguments, report); };
  return events;
}

/// The program that creates the page is installed beside this one.
void writePage(const Arguments& arguments) {
  const std::filesystem::path tools = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::string page = (std::filesystem::path(arguments.report) / "index.html").string();
  cbmv::writeEvaluationPage((tools / "cbmv_evaluation_report").string(), arguments.json,
                            arguments.maps, page);
  cbmv::printLine("wrote " + page);
}

/// Prints the results; called last.
void conclude(const Arguments& arguments, const cbmv::EvaluationReport& report) {
  if (!report.scenes.empty()) {
    std::printf("\n%s", cbmv::formatReport(report).c_str());
  }
  if (!report.unscored.empty()) {
    cbmv::printLine(std::to_string(report.unscored.size()) + " of " +
                    std::to_string(report.scenes.size() + report.unscored.size()) +
                    " scenes have no ground truth and no score");
  }
  if (!arguments.submission.empty()) {
    cbmv::printLine("wrote the upload " + arguments.submission);
  }
  if (!arguments.report.empty() && report.scenes.empty()) {
    cbmv::printLine("no page is written, because no scene has a score");
  } else if (!arguments.report.empty()) {
    writePage(arguments);
  }
}

void evaluate(Arguments arguments) {
  complete(arguments);
  requireWritableOutputs(arguments);
  const cbmv::DataSet data_set = cbmv::DataSet::open(
      arguments.data_set,
      arguments.submission.empty() ? cbmv::Truth::kRequired : cbmv::Truth::kOptional);
  requireOtherOutputs(arguments, data_set);
  Submission submission;
  if (!arguments.submission.empty()) {
    submission.emplace(data_set, arguments.submission);
  }
  Evaluation evaluation = setUp(arguments, data_set);
  resume(arguments, data_set, submission, evaluation);
  writeReports(arguments, evaluation.report);  // detects a full disk early
  const int failed = cbmv::evaluateScenes(data_set, evaluation.scenes, evaluation.source,
                                          makeEvents(arguments, submission), evaluation.report);
  conclude(arguments, evaluation.report);
  if (failed > 0) {
    throw cbmv::Error(std::to_string(failed) + " of " + std::to_string(evaluation.scenes.size()) +
                      " scenes failed. See the messages above");
  }
}

void addSourceOptions(CLI::App& app, Arguments& arguments) {
  CLI::Option_group* source = app.add_option_group("Source of the disparity maps", "One of these");
  source->add_option("--forest", arguments.forest,
                     std::string(cbmv::kForestHelp) + "; scenes are matched with it");
  CLI::Option* disparities = source->add_option(
      "--disparities", arguments.disparities,
      "Folder of existing maps: SCENE.pfm or SCENE.png (16 bits, value / 256, 0 = none); optional: "
      "SCENE_confidence.pfm and SCENE_sigma.pfm (standard deviation, px)");
  CLI::Option* folds = source->add_option(
      "--folds", arguments.folds,
      "3: train the folds of the paper on Middlebury v3 and match each scene with "
      "the forest that was not trained on it");
  CLI::Option* baseline = source->add_flag(
      "--stereo-sgbm", arguments.stereo_sgbm,
      "Match with OpenCV's StereoSGBM, blocks of 5 px, holes filled along the row");
  source->require_option(1);
  app.add_option("--train-dataset", arguments.train_data_set,
                 "Train the folds on the scenes of this data set, KIND:DIR, instead of those of "
                 "--dataset; for example the same scenes at another resolution")
      ->needs(folds);
  app.add_flag("--automatic-range", arguments.automatic_range,
               "Find the number of disparities in each pair (default: use the data set's)")
      ->excludes(disparities)
      ->excludes(baseline);
  app.add_option(
         "--preset", arguments.presets,
         cbmv::kPresetHelp + std::string("; the disparity range is that of the scene. With --folds "
                                         "3 also three, separated by commas, one per fold"))
      ->delimiter(',')
      ->excludes(disparities)
      ->excludes(baseline);
  app.add_flag("--resume", arguments.resume,
               "Keep the scenes that are already in the file of --json or in the report, if data "
               "set, forest and settings are the same")
      ->excludes(disparities);
  app.add_option("--submission", arguments.submission,
                 "Folder for the upload to the benchmark of this data set; scenes without ground "
                 "truth are then matched too, but not scored")
      ->excludes(disparities);
}

void addScoringOptions(CLI::App& app, Arguments& arguments) {
  app.add_option("--density", arguments.density,
                 "Also report bad 1 and bad 3 of this percentage of most confident pixels: with "
                 "one confidence threshold for all scenes, and with one per scene")
      ->check(cbmv::numberCheck<double>([](double number) { return number > 0 && number <= 100; },
                                        "a number above 0, up to 100"));
  app.add_option("--error-scale", arguments.error_scale,
                 "Scale factor for disparities and truth; 2 gives the errors of half-resolution "
                 "images at full-resolution scale")
      ->check(cbmv::positiveNumber())
      ->capture_default_str();
}

void addOutputOptions(CLI::App& app, Arguments& arguments) {
  app.add_option("--json", arguments.json, "Report to write; replaced after every scene");
  app.add_option("--csv", arguments.csv, "The report as CSV");
  app.add_option("--markdown", arguments.markdown, "The report as tables in Markdown");
  app.add_option(
      "--maps", arguments.maps,
      "Folder for the maps, in the format that --disparities reads, and for pictures of them");
  app.add_option("--report", arguments.report,
                 "Folder for the self-contained page index.html (needs Python's matplotlib), "
                 "report.json and maps/ (unless --json and --maps are given)");
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): only if an option is declared incorrectly
int main(int argc, char** argv) {
  CLI::App app{"Measures disparity errors on rectified stereo pairs with ground truth"};
  Arguments arguments;
  app.add_option("--dataset", arguments.data_set, cbmv::kDataSetHelp)->required();
  cbmv::addSceneOptions(app, arguments.filter);
  addSourceOptions(app, arguments);
  app.add_option("--threads", arguments.options.threads,
                 "Number of threads; 0: all hardware threads")
      ->check(cbmv::wholeNumber(0, 1024))
      ->capture_default_str();
  addScoringOptions(app, arguments);
  addOutputOptions(app, arguments);
  cbmv::addTrainingOptions(app, arguments.training);
  return cbmv::runTool(app, argc, argv, "cbmv_eval", [&] { evaluate(arguments); });
}
