// Matches one rectified pair of image files.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "forest/forest_file.h"
#include "io/image_file.h"
#include "io/other_file.h"
#include "io/output_check.h"
#include "io/pfm.h"
#include "io/ply.h"
#include "io/preview.h"
#include "io/stereo_cameras.h"
#include "pipeline/frame_processor.h"
#include "tools/program_files.h"
#include "tools/run_tool.h"
#include "tools/stereo_arguments.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/points.h"

namespace cbmv {
namespace {

constexpr const char* kTool = "cbmv_match";
constexpr double kMostPxApart = 1.0;  // limit for the rows of a rectified pair
constexpr const char* kOutputs[] = {"disparity.pfm",  "disparity.png", "confidence.pfm",
                                    "confidence.png", "depth.pfm",     "cloud.ply"};

struct Arguments {
  StereoArguments stereo;
  std::string left, right, forest, calibration, right_calibration, output;
};

/// Needed because the output folder may contain the input images.
void requireOtherOutputs(const Arguments& arguments) {
  const std::vector<std::string> inputs = {arguments.left, arguments.right, arguments.calibration,
                                           arguments.right_calibration};
  std::vector<std::string> outputs;
  for (const char* name : kOutputs) {
    outputs.push_back(arguments.output + "/" + name);
  }
  requireOtherFiles(inputs, outputs);
}

std::optional<StereoCameraFile> readCalibration(const Arguments& arguments) {
  return arguments.calibration.empty()
             ? std::nullopt
             : std::optional(readStereoCameras(arguments.calibration, arguments.right_calibration));
}

/// The images are rectified, so the distortion in the calibration is ignored.
StereoInput readInput(const Arguments& arguments,
                      const std::optional<StereoCameraFile>& calibration) {
  StereoInput input;
  input.left = readImage(arguments.left);
  input.right = readImage(arguments.right);
  const bool one_file = arguments.right_calibration.empty();
  input.names = {arguments.left, arguments.calibration, arguments.right,
                 one_file ? arguments.calibration : arguments.right_calibration};
  if (calibration) {
    std::printf("calibration: %s\n", calibration->description.c_str());
    input.cameras = calibration->cameras;
    input.rectified_by = RectifiedBy::kFiles;
  }
  return input;
}

/// Uses the calibration's number of disparities if it has one and the user gives none.
StereoOptions readOptions(const Arguments& arguments,
                          const std::optional<StereoCameraFile>& calibration, int image_width) {
  StereoOptions options = readStereoOptions(arguments.stereo, kTool);
  if (arguments.stereo.disparities || !calibration || calibration->disparities <= 0) {
    return options;
  }
  const char* const file = arguments.calibration.c_str();
  if (calibration->disparities < image_width) {
    options.range.count = calibration->disparities;
    std::printf("%s: disparity_range = %d, from ndisp\n", file, options.range.count);
  } else {
    options.range.count = 0;
    std::printf(
        "%s: ndisp = %d is not less than the image width and is ignored. The disparity range is "
        "found in the images\n",
        file, calibration->disparities);
  }
  return options;
}

void writeMaps(const std::string& folder, const StereoResult& result) {
  const DisparityRange& range = result.range;
  writePfm(folder + "disparity.pfm", result.disparity);
  writePfm(folder + "confidence.pfm", result.confidence);
  writeImage(folder + "disparity.png",
             colorizeDisparity(result.disparity, static_cast<float>(range.min),
                               static_cast<float>(range.max()), range.invalid()));
  writeImage(folder + "confidence.png", colorizeConfidence(result.confidence));
}

void writeDepth(const std::string& folder, const ProcessedFrame& frame, const cv::Mat& left) {
  const cv::Mat valid = toValidDisparity(frame.result.disparity, frame.result.range.invalid(),
                                         frame.geometry.disparity_offset_px);
  writePfm(folder + "depth.pfm", toDepth(valid, frame.geometry));
  if (!frame.result.disparity_sigma.empty()) {
    writePfm(folder + "depth_sigma.pfm",
             toDepthSigma(valid, frame.result.disparity_sigma, frame.geometry));
  }
  writePly(folder + "cloud.ply", toPoints(valid, toColor8(left), frame.geometry));
}

/// Warns about images that are not rectified: their depth is wrong even if their rows are aligned
/// later.
void warnOfVerticalOffset(const Arguments& arguments, const VerticalOffsetMeasurement& rows) {
  if (rows.model.matches > 0 && rows.rms_before_px > kMostPxApart) {
    std::fprintf(
        stderr,
        "%s: warning: the vertical offset between %s and %s is %.2f px (RMS), expected at most "
        "%.2f px. It is corrected, but depth is probably wrong. Rectify the images, or calibrate "
        "the cameras again.\n",
        kTool, arguments.left.c_str(), arguments.right.c_str(), rows.rms_before_px, kMostPxApart);
  }
}

void match(const Arguments& arguments) {
  requireWritableFolder(arguments.output);
  requireOtherOutputs(arguments);
  const auto calibration = readCalibration(arguments);
  const StereoInput input = readInput(arguments, calibration);
  const StereoOptions options = readOptions(arguments, calibration, input.left.cols);
  FrameProcessor processor(loadForest(forestFile(arguments.forest)), options);
  const PreparedPair pair = processor.prepare(input);
  for (const std::string& warning : pair.warnings) {
    std::fprintf(stderr, "%s: warning: %s\n", kTool, warning.c_str());
  }
  warnOfVerticalOffset(arguments, processor.measureOffset(pair));
  std::fputs(describeOptions(options).c_str(), stdout);

  OwnOffset offset;
  const ProcessedFrame frame = processor.match(pair, offset);
  if (!frame.range_correction.empty()) {
    std::fprintf(stderr, "%s: warning: %s\n", kTool, frame.range_correction.c_str());
  }
  if (frame.range_is_automatic) {
    std::printf("disparity range found in the images: %s\n",
                describeRange(frame.result.range).c_str());
  }
  const std::string folder = arguments.output + "/";
  std::filesystem::create_directories(folder);
  writeMaps(folder, frame.result);
  if (calibration) {
    writeDepth(folder, frame, input.left);
  }
  std::printf("%.0f ms; wrote disparity%s and confidence to %s\n", frame.result.times.total_ms,
              calibration ? ", depth, cloud" : "", folder.c_str());
}

}  // namespace
}  // namespace cbmv

// NOLINTNEXTLINE(bugprone-exception-escape): only if an option is declared incorrectly
int main(int argc, char** argv) {
  CLI::App app{
      "Matches a rectified pair: disparity and confidence as PFM and as color PNG; with a "
      "calibration depth as PFM (m, NaN where there is none), its standard deviation if the forest "
      "provides it, and the point cloud as PLY"};
  cbmv::Arguments arguments;
  app.add_option("left", arguments.left, "Left image file")->required();
  app.add_option("right", arguments.right, "Right image file")->required();
  app.add_option("--forest", arguments.forest, cbmv::kForestHelp)->required();
  cbmv::addStereoOptions(app, arguments.stereo);
  CLI::Option* const calibration = app.add_option(
      "--calibration", arguments.calibration,
      "Middlebury's or ETH3D's calib.txt; KITTI's calib_cam_to_cam.txt or calib/NNNNNN.txt "
      "(append :02,03 for the color cameras); or the left camera's YAML of "
      "camera_calibration, or EuRoC's sensor.yaml");
  app.add_option("--right-calibration", arguments.right_calibration, "The right camera's YAML")
      ->needs(calibration);
  app.add_option("--output", arguments.output, "Folder to write to")->required();
  return cbmv::runTool(app, argc, argv, "cbmv_match", [&] { cbmv::match(arguments); });
}
