// Matches one rectified pair of image files.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "run_tool.h"
#include "stereo_arguments.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/forest/forest_file.h"
#include "cbmv_stereo/io/camera_yaml.h"
#include "cbmv_stereo/io/image_file.h"
#include "cbmv_stereo/io/pfm.h"
#include "cbmv_stereo/io/points.h"
#include "cbmv_stereo/io/preview.h"
#include "cbmv_stereo/pipeline/stereo_matcher.h"

namespace cbmv {
namespace {

struct Arguments {
  StereoArguments stereo;
  std::string left, right, forest, calibration, right_calibration, output;
};

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

StereoCalibration readCalibration(const Arguments& arguments) {
  const std::string extension = std::filesystem::path(arguments.calibration).extension().string();
  if (extension != ".yaml" && extension != ".yml") {
    return readMiddleburyCalibration(arguments.calibration, StereoOptions().range.count);
  }
  if (arguments.right_calibration.empty()) {
    throw Error(arguments.calibration +
                " describes the left camera alone; give the right one's by --right-calibration");
  }
  return readCameraYamlPair(arguments.calibration, arguments.right_calibration);
}

/// None without --calibration.
std::optional<StereoCalibration> calibrationFor(const cv::Size& size, const Arguments& arguments) {
  if (arguments.calibration.empty()) {
    return std::nullopt;
  }
  const StereoCalibration calibration = readCalibration(arguments);
  if (cv::Size(calibration.width, calibration.height) != size) {
    throw Error(arguments.calibration + " describes images of " +
                sizeText(calibration.width, calibration.height) + " pixels, " + arguments.left +
                " has " + sizeText(size.width, size.height));
  }
  return calibration;
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

void match(const Arguments& arguments) {
  const StereoOptions options = readStereoOptions(arguments.stereo, "cbmv_match");
  const cv::Mat left = readGreyImage(arguments.left);
  const cv::Mat right = readGreyImage(arguments.right);
  if (left.size() != right.size()) {
    throw Error(arguments.left + " and " + arguments.right +
                " differ in size; a rectified pair has one size");
  }
  const std::optional<StereoCalibration> calibration = calibrationFor(left.size(), arguments);
  const auto forest = std::make_shared<Forest>(readForest(arguments.forest));
  std::filesystem::create_directories(arguments.output);
  std::fputs(describeOptions(options).c_str(), stdout);

  StereoMatcher matcher(forest, options);
  const StereoResult result = matcher.match(left, right);
  const std::string folder = arguments.output + "/";
  writeMaps(folder, result);
  if (calibration) {
    const cv::Mat depth = toDepth(result.disparity, result.range.invalid(), *calibration);
    writePfm(folder + "depth.pfm", depth);
    writePly(folder + "cloud.ply", toPoints(depth, readColorImage(arguments.left), *calibration));
  }
  std::printf("%.0f ms; wrote disparity%s and confidence to %s\n", result.times.total_ms,
              calibration ? ", depth, cloud" : "", folder.c_str());
}

}  // namespace
}  // namespace cbmv

// NOLINTNEXTLINE(bugprone-exception-escape): an option that is declared wrongly
int main(int argc, char** argv) {
  CLI::App app{
      "Matches a rectified pair: disparity and confidence as PFM and as colour PNG; with a "
      "calibration depth as PFM (m, NaN where there is none) and the cloud as PLY, too"};
  cbmv::Arguments arguments;
  app.add_option("left", arguments.left, "Left image file")->required();
  app.add_option("right", arguments.right, "Right image file")->required();
  app.add_option("--forest", arguments.forest, "File of the forest")->required();
  cbmv::addStereoOptions(app, arguments.stereo);
  CLI::Option* const calibration = app.add_option(
      "--calibration", arguments.calibration,
      "Middlebury's calib.txt, or the left camera's .yaml as camera_calibration writes it");
  app.add_option("--right-calibration", arguments.right_calibration, "The right camera's .yaml")
      ->needs(calibration);
  app.add_option("--output", arguments.output, "Folder to write to")->required();
  return cbmv::runTool(app, argc, argv, "cbmv_match", [&] { cbmv::match(arguments); });
}
