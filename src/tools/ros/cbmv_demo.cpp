// Creates bags for scripts/demo and shows the results of the node.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/imgproc.hpp>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "data_sets/visible_in_both.h"
#include "evaluation/disparity_error.h"
#include "evaluation/rendered_scene.h"
#include "io/calibration.h"
#include "io/image_file.h"
#include "io/other_file.h"
#include "io/output_check.h"
#include "io/pfm.h"
#include "io/ply.h"
#include "io/preview.h"
#include "ros/conversions.h"
#include "tools/range_checks.h"
#include "tools/ros/raw_demo.h"
#include "tools/run_tool.h"

#include "cbmv_stereo/error.h"
#include <cbmv_stereo/Status.h>

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr int kRenderedWidth = 640;
constexpr int kRenderedHeight = 480;

struct MakeBagArguments {
  std::string left, right, calibration, output;
  int frames = 10;
  double rate_hz = 1.0;
};

void makeBag(const MakeBagArguments& arguments) {
  requireWritableFile(arguments.output);
  requireOtherFiles({arguments.left, arguments.right, arguments.calibration}, {arguments.output});
  const cv::Mat left = readColorImage(arguments.left);
  const cv::Mat right = readColorImage(arguments.right);
  const StereoCalibration calibration = readMiddleburyCalibration(arguments.calibration);
  if (left.size() != right.size()) {
    throw Error(arguments.left + " and " + arguments.right +
                " have different sizes, expected equal sizes. Give the images of one pair");
  }
  rosbag::Bag bag;
  bag.open(arguments.output, rosbag::bagmode::Write);
  std_msgs::Header header;
  header.frame_id = "left_camera";
  for (int frame = 0; frame < arguments.frames; ++frame) {
    header.seq = static_cast<std::uint32_t>(frame);
    header.stamp = ros::Time(1.0 + frame / arguments.rate_hz);
    const RecordedPair pair = toRecordedPair(left, right, calibration, header);
    bag.write("/stereo/left/image_rect", header.stamp, pair.left_gray);
    bag.write("/stereo/left/image_rect_color", header.stamp, pair.left_color);
    bag.write("/stereo/left/camera_info", header.stamp, pair.left_info);
    bag.write("/stereo/right/image_rect", header.stamp, pair.right_gray);
    bag.write("/stereo/right/camera_info", header.stamp, pair.right_info);
  }
  bag.close();
  std::printf("wrote %s: %d frames of %dx%d at %g Hz\n", arguments.output.c_str(), arguments.frames,
              left.cols, left.rows, arguments.rate_hz);
}

void render(const std::string& folder) {
  requireWritableFolder(folder);
  fs::create_directories(folder);
  const RenderedScene scene = renderScene(kRenderedWidth, kRenderedHeight, 1);
  writeImage(folder + "/left.png", scene.left);
  writeImage(folder + "/right.png", scene.right);
  writePfm(folder + "/truth.pfm", scene.truth);
  StereoCalibration calibration;
  calibration.focal_length_px = kRenderedWidth;
  calibration.cx_left = calibration.cx_right = (kRenderedWidth - 1) / 2.0;
  calibration.cy = (kRenderedHeight - 1) / 2.0;
  calibration.baseline_m = 0.1;
  calibration.width = kRenderedWidth;
  calibration.height = kRenderedHeight;
  calibration.disparities = 48;
  writeMiddleburyCalibration(folder + "/calib.txt", calibration);
}

/// The last message of each type in a bag recorded from the node, and all Status messages.
struct Recording {
  stereo_msgs::DisparityImageConstPtr disparity;
  sensor_msgs::ImageConstPtr confidence;
  sensor_msgs::PointCloud2ConstPtr points;
  std::vector<cbmv_stereo::Status> statuses;
  std::vector<ros::Time> times;  ///< recording time of each status
};

Recording readRecording(const std::string& path) {
  rosbag::Bag bag;
  bag.open(path, rosbag::bagmode::Read);
  Recording recording;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    const std::string& topic = message.getTopic();
    if (topic == "/stereo/disparity") {
      recording.disparity = message.instantiate<stereo_msgs::DisparityImage>();
    } else if (topic == "/stereo/confidence") {
      recording.confidence = message.instantiate<sensor_msgs::Image>();
    } else if (topic == "/stereo/points2") {
      recording.points = message.instantiate<sensor_msgs::PointCloud2>();
    } else if (topic == "/stereo/status") {
      recording.statuses.push_back(*message.instantiate<cbmv_stereo::Status>());
      recording.times.push_back(message.getTime());
    }
  }
  if (!recording.disparity || !recording.confidence || !recording.points ||
      recording.statuses.empty()) {
    throw Error("bag " + path +
                ": no message on one of /stereo/disparity, confidence, points2, status, expected "
                "all of them. The node published no complete frame; see its log");
  }
  return recording;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void printTimes(const Recording& recording) {
  using Field = double cbmv_stereo::Status::*;
  const std::vector<std::pair<const char*, Field>> fields = {
      {"rectification", &cbmv_stereo::Status::rectification_ms},
      {"volume", &cbmv_stereo::Status::volume_ms},
      {"aggregation", &cbmv_stereo::Status::aggregation_ms},
      {"semi-global", &cbmv_stereo::Status::sgm_ms},
      {"refinement", &cbmv_stereo::Status::refinement_ms},
      {"selection", &cbmv_stereo::Status::selection_ms},
      {"all stages", &cbmv_stereo::Status::total_ms}};
  std::printf("time of each stage (median of %zu frames):\n", recording.statuses.size());
  for (const auto& [name, field] : fields) {
    std::vector<double> values;
    for (const cbmv_stereo::Status& status : recording.statuses) {
      values.push_back(status.*field);
    }
    std::printf("  %-14s %8.1f ms\n", name, median(values));
  }
}

void printRate(const Recording& recording) {
  const cbmv_stereo::Status& last = recording.statuses.back();
  const double span_s = (recording.times.back() - recording.times.front()).toSec();
  std::printf("frames: %zu published, %lu dropped; ", recording.statuses.size(),
              static_cast<unsigned long>(last.frames_dropped));
  if (recording.times.size() > 1 && span_s > 0) {
    std::printf("rate %.2f Hz\n", static_cast<double>(recording.times.size() - 1) / span_s);
  } else {
    std::printf("rate unknown from one frame\n");
  }
  std::printf("forest %s, %d threads, vertical offset removed %.2f px\n", last.forest.c_str(),
              last.threads, last.vertical_offset_px);
}

void printError(const char* pixels, const DisparityError& error) {
  std::printf("  %-16s bad 0.5 %5.2f %%   bad 1 %5.2f %%   bad 2 %5.2f %%   average %.3f px\n",
              pixels, error.bad_05, error.bad_1, error.bad_2, error.average_px);
}

struct ReportArguments {
  std::string bag, left, truth, calibration, output;
};

/// Writes the images of a recording, and left image, disparity and confidence side by side at half
/// size.
void writePictures(const Recording& recording, const RecordedDisparity& disparity,
                   const ReportArguments& arguments) {
  const cv::Mat disparity_picture =
      colorizeDisparity(disparity.values, disparity.lowest, disparity.highest, disparity.invalid);
  const cv::Mat confidence_picture = colorizeConfidence(fromFloatImage(*recording.confidence));
  writeImage(arguments.output + "/disparity.png", disparity_picture);
  writeImage(arguments.output + "/confidence.png", confidence_picture);
  cv::Mat overview;
  cv::hconcat(
      std::vector<cv::Mat>{readColorImage(arguments.left), disparity_picture, confidence_picture},
      overview);
  cv::resize(overview, overview, {}, 0.5, 0.5, cv::INTER_AREA);
  writeImage(arguments.output + "/overview.png", overview);
}

void report(const ReportArguments& arguments) {
  requireWritableFolder(arguments.output);
  const Recording recording = readRecording(arguments.bag);
  const StereoCalibration calibration = readMiddleburyCalibration(arguments.calibration);
  const RecordedDisparity disparity =
      fromDisparityImage(*recording.disparity, -calibration.doffs());
  const cv::Mat truth = readPfm(arguments.truth);
  printRate(recording);
  printTimes(recording);
  std::printf("error of the last frame against the ground truth:\n");
  printError("non-occluded",
             evaluateDisparity(disparity.values, truth, visibleInBoth(truth), disparity.invalid));
  printError("all",
             evaluateDisparity(disparity.values, truth,
                               cv::Mat(truth.size(), CV_8UC1, cv::Scalar(255)), disparity.invalid));
  const std::string folder = arguments.output + "/";
  fs::create_directories(folder);
  writePfm(folder + "disparity.pfm", disparity.values);
  writePictures(recording, disparity, arguments);
  writePly(folder + "cloud.ply", fromPointCloud(*recording.points));
  std::printf("files:\n");
  for (const char* name :
       {"overview.png", "disparity.png", "confidence.png", "disparity.pfm", "cloud.ply"}) {
    std::printf("  %s%s\n", folder.c_str(), name);
  }
}

}  // namespace
}  // namespace cbmv

// NOLINTNEXTLINE(bugprone-exception-escape): only if an option is declared incorrectly
int main(int argc, char** argv) {
  CLI::App app{"Bags of one stereo pair for scripts/demo"};
  app.require_subcommand(1);

  std::string folder;
  CLI::App* render = app.add_subcommand("render", "Renders a scene with known disparities");
  render->add_option("--output", folder, "Folder for left.png, right.png, truth.pfm, calib.txt")
      ->required();

  cbmv::MakeBagArguments bag;
  CLI::App* make_bag = app.add_subcommand("make-bag", "Writes a bag that repeats the pair");
  make_bag->add_option("left", bag.left, "Left image file")->required();
  make_bag->add_option("right", bag.right, "Right image file")->required();
  make_bag->add_option("--calibration", bag.calibration, "calib.txt in Middlebury v3 format")
      ->required();
  make_bag->add_option("--output", bag.output, "The bag to write")->required();
  make_bag->add_option("--frames", bag.frames)
      ->check(cbmv::wholeNumber(1, 100000))
      ->capture_default_str();
  make_bag->add_option("--rate-hz", bag.rate_hz)
      ->check(cbmv::positiveNumber())
      ->capture_default_str();

  cbmv::ReportArguments recorded;
  CLI::App* report = app.add_subcommand("report", "Shows the results of a node for this bag");
  report->add_option("bag", recorded.bag, "Bag recorded from the node")->required();
  report->add_option("--left", recorded.left, "Left image file of the pair")->required();
  report->add_option("--truth", recorded.truth, "PFM file of the true left disparities")
      ->required();
  report->add_option("--calibration", recorded.calibration, "calib.txt of the pair")->required();
  report->add_option("--output", recorded.output, "Folder for the pictures and files")->required();

  cbmv::CalibrateArguments raw;
  CLI::App* calibrate = app.add_subcommand(
      "calibrate", "Calibrates a stereo rig from chessboard images and writes them to a bag");
  calibrate
      ->add_option("folder", raw.folder, "Folder with left01.jpg, right01.jpg and so on (or .png)")
      ->required();
  calibrate->add_option("--output", raw.output, "Folder for left.yaml, right.yaml, raw.bag")
      ->required();
  calibrate->add_option("--columns", raw.board.corners.width, "Inner corners of the board")
      ->check(cbmv::wholeNumber(3, 100))
      ->capture_default_str();
  calibrate->add_option("--rows", raw.board.corners.height, "Inner corners of the board")
      ->check(cbmv::wholeNumber(3, 100))
      ->capture_default_str();
  calibrate->add_option("--square-m", raw.board.square_m, "Side of a square; scales the baseline")
      ->check(cbmv::positiveNumber())
      ->capture_default_str();
  calibrate->add_option("--rate-hz", raw.rate_hz)
      ->check(cbmv::positiveNumber())
      ->capture_default_str();

  cbmv::ShowRawArguments shown;
  CLI::App* show_raw =
      app.add_subcommand("show-raw", "Rectified left images beside the disparities");
  show_raw->add_option("bag", shown.bag, "Bag recorded from the node")->required();
  show_raw->add_option("--output", shown.output, "The picture to write")->required();
  show_raw->add_option("--frames", shown.frames)
      ->check(cbmv::wholeNumber(1))
      ->capture_default_str();

  return cbmv::runTool(app, argc, argv, "cbmv_demo", [&] {
    if (*render) {
      cbmv::render(folder);
    } else if (*calibrate) {
      cbmv::calibrate(raw);
    } else if (*show_raw) {
      cbmv::showRaw(shown);
    } else if (*make_bag) {
      cbmv::makeBag(bag);
    } else {
      cbmv::report(recorded);
    }
  });
}
