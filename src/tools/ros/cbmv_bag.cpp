// Processes bags of a stereo camera.

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <malloc.h>

#include "forest/forest_file.h"
#include "io/other_file.h"
#include "io/output_check.h"
#include "offline/bag_check.h"
#include "offline/bag_processing.h"
#include "offline/bag_writer.h"
#include "tools/program_files.h"
#include "tools/progress_bar.h"
#include "tools/range_checks.h"
#include "tools/run_tool.h"
#include "tools/stereo_arguments.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr const char* kTool = "cbmv_bag";
constexpr int kIncomplete = 3;  ///< exit status: finished, but some frames are missing
volatile std::sig_atomic_t stop_requested = 0;

struct Arguments {
  BagProcessingOptions processing;
  StereoArguments stereo;
  std::string forest, json, shard;
  std::string format = "auto";
  bool resume = false, overwrite = false;
};

void writeJson(const std::string& path, const std::string& json) {
  std::ofstream file(path);
  file << json;
  file.close();
  if (!file) {
    throw cannotWrite(path, std::strerror(errno));
  }
}

/// Parses --format; auto: files for a folder, else a bag.
std::optional<DisparityFormat> fileFormat(const std::string& format, const std::string& output) {
  if (format == "kitti") {
    return DisparityFormat::kKitti;
  }
  const bool folder =
      std::filesystem::path(output).filename().empty() || std::filesystem::is_directory(output);
  return format == "files" || (format == "auto" && folder)
             ? std::optional<DisparityFormat>(DisparityFormat::kPfm)
             : std::nullopt;
}

/// Reports the output, and on stderr why it is incomplete.
void reportOutput(const std::string& output, const BagProcessingSummary& summary) {
  for (const std::string& problem : summary.problems) {
    std::fprintf(stderr, "%s: %s\n", kTool, problem.c_str());
  }
  const char* text = summary.interrupted   ? "%s is incomplete. Use --resume to continue\n"
                     : summary.was_written ? "wrote %s\n"
                                           : "nothing was written to %s\n";
  std::printf(text, output.c_str());
}

/// Reports the plan before a long run, so that the user can stop it.
void reportPlan(const BagProcessingSummary& summary) {
  std::printf("%s\n", summary.plan.topics.rectification.c_str());
  std::fflush(stdout);
  for (const std::string& warning : summary.warnings) {
    std::fprintf(stderr, "%s: warning: %s\n", kTool, warning.c_str());
  }
}

std::vector<std::string> inputFiles(const Arguments& arguments) {
  std::vector<std::string> files = arguments.processing.inputs;
  const TopicChoice& topics = arguments.processing.topics;
  files.insert(files.end(),
               {forestFile(arguments.forest), topics.left_calibration, topics.right_calibration});
  if (!arguments.stereo.preset.empty()) {
    files.push_back(presetFile(arguments.stereo.preset));
  }
  return files;
}

/// Checks the JSON path before the work starts.
void requireWritableJson(const Arguments& arguments) {
  if (arguments.json.empty()) {
    return;
  }
  requireWritableFile(arguments.json);
  requireOtherFiles(inputFiles(arguments), {arguments.json});
}

void requireWritable(const Arguments& arguments) {
  const BagProcessingOptions& options = arguments.processing;
  options.files ? requireWritableFolder(options.output) : requireWritableFile(options.output);
  requireWritableJson(arguments);
  const std::string written = options.files ? options.output + "/index.csv" : options.output;
  requireOtherFiles(inputFiles(arguments), {written});
  if (!arguments.json.empty() && isSameFile(arguments.json, written)) {
    throw Error("--json and --output both write " + written +
                ", expected two files. Choose another name for one of them.");
  }
}

int process(Arguments& arguments) {
  BagProcessingOptions& options = arguments.processing;
  options.files = fileFormat(arguments.format, options.output);
  options.matching.stereo = readStereoOptions(arguments.stereo, kTool);
  requireWritable(arguments);
  if (!arguments.shard.empty()) {
    options.shard = parseShard(arguments.shard);
  }
  options.earlier = arguments.overwrite ? EarlierParts::kOverwrite
                    : arguments.resume  ? EarlierParts::kResume
                                        : EarlierParts::kReject;
  const auto forest = loadForest(forestFile(arguments.forest));
  BagProcessingSummary summary;
  {
    ProgressBar bar(stderr, isTerminal(stderr));
    BagProcessingEvents events;
    events.begin = reportPlan;
    events.progress = [&](std::size_t done, std::size_t total) {
      bar.show("frames", static_cast<int>(done), static_cast<int>(total), "");
    };
    events.should_stop = [] { return stop_requested != 0; };
    summary = processBags(options, forest, events);
  }
  if (summary.was_complete) {
    std::printf("%s is complete already\n", options.output.c_str());
    return 0;
  }
  std::fputs(describeSummary(summary).c_str(), stdout);
  if (!arguments.json.empty()) {
    writeJson(arguments.json, summaryJson(summary));
  }
  reportOutput(options.output, summary);
  return summary.isComplete() ? 0 : kIncomplete;
}

int check(Arguments& arguments) {
  arguments.processing.matching.stereo = readStereoOptions(arguments.stereo, kTool);
  requireWritableJson(arguments);
  const auto forest = loadForest(forestFile(arguments.forest));
  const BagCheck found = checkBags(arguments.processing, forest);
  std::fputs(found.text.c_str(), stdout);
  for (const std::string& problem : found.problems) {
    std::printf("problem: %s\n", problem.c_str());
  }
  if (!arguments.json.empty()) {
    writeJson(arguments.json, checkJson(found));
  }
  return found.problems.empty() ? 0 : kIncomplete;
}

int merge(const MergeOptions& options) {
  const MergeSummary summary = mergeShards(options);
  std::printf("wrote %s: %zu shards, %zu frames, of which %zu failed%s\n", options.output.c_str(),
              summary.shards, summary.frames, summary.failed,
              summary.damaged ? "; an input bag is damaged" : "");
  return summary.isComplete() ? 0 : kIncomplete;
}

void addInput(CLI::App& app, Arguments& arguments) {
  BagProcessingOptions& options = arguments.processing;
  app.add_option("bags", options.inputs, "Bags of one recording (processed as one bag)")
      ->required();
  app.add_option("--left", options.topics.left, "Topic of the left images");
  app.add_option("--right", options.topics.right, "Topic of the right images");
  app.add_option("--namespace", options.topics.camera_namespace,
                 "Namespace of left/… and right/…, and of the outputs");
  const std::map<std::string, Rectified> rectified = {
      {"auto", Rectified::kAuto}, {"yes", Rectified::kYes}, {"no", Rectified::kNo}};
  app.add_option_function<std::string>(
         "--rectified",
         [&options, rectified](const std::string& answer) {
           options.topics.rectified = rectified.at(answer);
         },
         "Whether the images are rectified; auto: yes if both topic names contain \"rect\". Raw "
         "images are rectified first")
      ->check(CLI::IsMember(rectified))
      ->default_str("auto");
  CLI::Option* const calibration = app.add_option(
      "--left-calibration", options.topics.left_calibration,
      "Calibration instead of camera_info: YAML of the left camera (ROS, or EuRoC's sensor.yaml), "
      "or a file for both cameras (KITTI, Middlebury)");
  app.add_option("--right-calibration", options.topics.right_calibration,
                 "YAML of the right camera")
      ->needs(calibration);
  app.add_option("--max-stamp-difference-s", options.plan.max_stamp_difference_s,
                 "Largest stamp difference between the images of a pair; 0: equal stamps only")
      ->check(nonNegativeNumber())
      ->capture_default_str();
  app.add_option("--start", options.plan.start_s, "Seconds to skip at the start")
      ->check(nonNegativeNumber());
  app.add_option("--duration", options.plan.duration_s, "Seconds to process; 0: to the end")
      ->check(nonNegativeNumber());
  app.add_option("--every", options.plan.every, "Process only every n-th pair")
      ->check(wholeNumber(1))
      ->capture_default_str();
}

void addMatching(CLI::App& app, Arguments& arguments) {
  MatchingOptions& options = arguments.processing.matching;
  app.add_option("--forest", arguments.forest, kForestHelp)->required();
  addStereoOptions(app, arguments.stereo);
  app.add_option("--min-confidence", options.min_confidence,
                 "Pixels with a lower confidence become invalid")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--allow-different-frame-ids,!--reject-different-frame-ids",
               options.allow_different_frame_ids,
               "Accept pairs with different frame_ids (default: yes)");
}

void addCompression(CLI::App& app, std::string& compression) {
  app.add_option("--compression", compression, "Compression of the output bag: none, lz4 or bz2")
      ->capture_default_str();
}

/// `check` accepts the options of processing, but requires none of them.
void addOutput(CLI::App& app, Arguments& arguments, bool check) {
  BagProcessingOptions& options = arguments.processing;
  app.add_option("--output", options.output, "Bag or folder to write, see --format")
      ->required(!check);
  app.add_option("--format", arguments.format,
                 "bag; files: one file per frame and output (PFM, PNG, PLY, YAML); kitti: like "
                 "files, with disparities as KITTI PNG; auto: files if --output ends with / or is "
                 "a folder, otherwise bag")
      ->check(CLI::IsMember({"auto", "bag", "files", "kitti"}))
      ->capture_default_str();
  app.add_option(
         "--write", options.outputs,
         "Outputs, separated by commas: disparity, depth, depth_sigma, depth_raw, camera_info, "
         "confidence, valid_mask, disparity_color, cloud")
      ->delimiter(',')
      ->capture_default_str();
  addCompression(app, options.compression);
  app.add_flag("--copy", options.copy, "Copy the other topics of the input (bag output only)");
  app.add_option("--shard", arguments.shard,
                 "Process only one of several equal parts, for example 2/4");
  app.add_flag("--resume", arguments.resume, "Continue an earlier run that was stopped or killed");
  app.add_flag("--overwrite", arguments.overwrite, "Start again and replace existing output");
  app.add_option("--frames-per-part", options.frames_per_part,
                 "Maximum number of frames lost when the run is killed")
      ->check(wholeNumber(1))
      ->capture_default_str();
  app.add_option("--json", arguments.json, "File for the summary");
}

/// Keeps freed memory in the process, shared by all threads. Each frame frees and allocates some
/// MB, usually on different threads. Returning it to the system in between costs about 10 % of the
/// time.
void keepFreedMemory() {
#ifdef __GLIBC__
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

int runMerge(int argc, char** argv) {
  CLI::App app{"Merges the bags written with --shard into one bag"};
  MergeOptions options;
  app.add_option("bags", options.shards, "The bags of all shards, in any order")->required();
  app.add_option("--output", options.output, "The bag to write")->required();
  addCompression(app, options.compression);
  app.add_flag("--overwrite", options.overwrite, "Replace the output if it exists");
  int status = 0;
  const int error_status = runTool(app, argc, argv, kTool, [&] { status = merge(options); });
  return error_status != 0 ? error_status : status;
}

int runCheckOrProcess(int argc, char** argv, bool is_check) {
  CLI::App app{is_check ? "Checks bags of a stereo camera: pairs, calibration, processing time"
                        : "Computes disparity, depth and point clouds for bags of a stereo camera"};
  Arguments arguments;
  addInput(app, arguments);
  addMatching(app, arguments);
  addOutput(app, arguments, is_check);
  if (!is_check) {
    app.footer(
        "`cbmv_bag check BAG...` checks bags without processing them; `cbmv_bag merge BAG...` "
        "merges the bags of all shards.");
  }
  int status = 0;
  const int error_status = runTool(
      app, argc, argv, kTool, [&] { status = is_check ? check(arguments) : process(arguments); });
  return error_status != 0 ? error_status : status;
}

}  // namespace
}  // namespace cbmv

// NOLINTNEXTLINE(bugprone-exception-escape): only if an option is declared incorrectly
int main(int argc, char** argv) {
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, [](int) { cbmv::stop_requested = 1; });
  }
  std::signal(SIGXFSZ, SIG_IGN);  // reports the file size limit as an error, like a full disk

  cbmv::keepFreedMemory();

  // Parsed manually, because CLI11 would require the options of processing for the subcommands too.
  const std::string command = argc > 1 ? argv[1] : "";
  if (command == "merge") {
    return cbmv::runMerge(argc - 1, argv + 1);
  }
  const bool check = command == "check";
  return cbmv::runCheckOrProcess(check ? argc - 1 : argc, check ? argv + 1 : argv, check);
}
