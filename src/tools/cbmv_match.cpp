// Matches one rectified pair of image files.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "run_tool.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/forest/forest_file.h"
#include "cbmv_stereo/io/image_file.h"
#include "cbmv_stereo/io/pfm.h"
#include "cbmv_stereo/io/preview.h"
#include "cbmv_stereo/pipeline/parameters.h"
#include "cbmv_stereo/pipeline/stereo_matcher.h"

namespace {

struct Arguments {
  std::string left, right, forest, preset, output;
  cbmv::StereoOptions options;
};

void match(const Arguments& arguments) {
  cbmv::StereoOptions options = arguments.options;
  if (!arguments.preset.empty()) {
    cbmv::readPreset(arguments.preset, options);
  }
  const cv::Mat left = cbmv::readGreyImage(arguments.left);
  const cv::Mat right = cbmv::readGreyImage(arguments.right);
  if (left.size() != right.size()) {
    throw cbmv::Error(arguments.left + " and " + arguments.right +
                      " differ in size; a rectified pair has one size");
  }
  const auto forest = std::make_shared<cbmv::Forest>(cbmv::readForest(arguments.forest));
  std::filesystem::create_directories(arguments.output);
  std::fputs(cbmv::describeOptions(options).c_str(), stdout);

  cbmv::StereoMatcher matcher(forest, options);
  const cbmv::StereoResult result = matcher.match(left, right);
  const std::string folder = arguments.output + "/";
  cbmv::writePfm(folder + "disparity.pfm", result.disparity);
  cbmv::writePfm(folder + "confidence.pfm", result.confidence);
  cbmv::writeImage(
      folder + "disparity.png",
      cbmv::colorizeDisparity(result.disparity, static_cast<float>(options.range.min),
                              static_cast<float>(options.range.max()), options.range.invalid()));
  cbmv::writeImage(folder + "confidence.png", cbmv::colorizeConfidence(result.confidence));
  std::printf("%.0f ms; wrote disparity and confidence to %s\n", result.times.total_ms,
              folder.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Matches a rectified pair: disparity and confidence as PFM and as colour PNG"};
  Arguments arguments;
  app.add_option("left", arguments.left, "Left image file")->required();
  app.add_option("right", arguments.right, "Right image file")->required();
  app.add_option("--forest", arguments.forest, "File of the forest")->required();
  app.add_option("--disparities", arguments.options.range.count, "Number of disparities, px")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--min-disparity", arguments.options.range.min, "Lowest disparity, px")
      ->check(CLI::Range(-2048, 2048))
      ->capture_default_str();
  app.add_option("--preset", arguments.preset, "YAML file of parameters, wins over the options");
  app.add_option("--threads", arguments.options.threads, "0: as many as the machine has")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--output", arguments.output, "Folder to write to")->required();
  return cbmv::runTool(app, argc, argv, "cbmv_match", [&] { match(arguments); });
}
