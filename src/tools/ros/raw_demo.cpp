#include "tools/ros/raw_demo.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <regex>
#include <utility>
#include <vector>

#include <camera_calibration_parsers/parse.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "io/image_file.h"
#include "io/other_file.h"
#include "io/output_check.h"
#include "ros/conversions.h"

#include "cbmv_stereo/error.h"
#include <cbmv_stereo/Rectification.h>

namespace cbmv {
namespace {

namespace fs = std::filesystem;

/// File names of the pairs in a folder, leftNUMBER and rightNUMBER, sorted by name.
std::vector<std::pair<std::string, std::string>> pairsIn(const std::string& folder) {
  std::vector<std::pair<std::string, std::string>> pairs;
  const std::regex left_name("left([0-9]+\\.(jpg|png))");
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    std::smatch found;
    if (std::regex_match(name, found, left_name)) {
      const fs::path right = fs::path(folder) / ("right" + found[1].str());
      if (fs::exists(right)) {
        pairs.emplace_back(entry.path().string(), right.string());
      }
    }
  }
  if (pairs.empty()) {
    throw Error(folder +
                " has no image pairs, expected files such as left01.jpg and right01.jpg (or .png). "
                "Check the folder");
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

sensor_msgs::CameraInfo toCameraInfo(const CalibratedCamera& camera, cv::Size size) {
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(size.width);
  info.height = static_cast<std::uint32_t>(size.height);
  info.distortion_model = "plumb_bob";
  info.D = camera.distortion;
  std::copy_n(camera.matrix.val, 9, info.K.begin());
  std::copy_n(camera.rotation.val, 9, info.R.begin());
  std::copy_n(camera.projection.val, 12, info.P.begin());
  return info;
}

void writeCameraFile(const std::string& path, const std::string& name,
                     const sensor_msgs::CameraInfo& info) {
  if (!camera_calibration_parsers::writeCalibration(path, name, info)) {
    throw Error("cannot write " + path +
                ". Check that the folder exists, is writable and has free space");
  }
}

/// A bag as recorded from the driver of a stereo camera.
class RawBag {
 public:
  RawBag(const std::string& path, const CalibratedRig& rig)
      : left_info_(toCameraInfo(rig.left, rig.image_size)),
        right_info_(toCameraInfo(rig.right, rig.image_size)) {
    bag_.open(path, rosbag::bagmode::Write);
  }

  void write(ros::Time stamp, const cv::Mat& left, const cv::Mat& right) {
    writeCamera("/stereo/left", "left_camera", stamp, left, left_info_);
    writeCamera("/stereo/right", "right_camera", stamp, right, right_info_);
  }

 private:
  void writeCamera(const std::string& topics, const std::string& frame_id, ros::Time stamp,
                   const cv::Mat& image, sensor_msgs::CameraInfo& info) {
    info.header.stamp = stamp;
    info.header.frame_id = frame_id;
    bag_.write(topics + "/camera_info", stamp, info);
    bag_.write(topics + "/image_raw", stamp, toMessage(image, "mono8", info.header));
  }

  rosbag::Bag bag_;
  sensor_msgs::CameraInfo left_info_, right_info_;
};

CalibratedRig calibratePairs(const std::vector<std::pair<cv::Mat, cv::Mat>>& pairs,
                             const Chessboard& board) {
  std::vector<BoardView> views;
  for (const auto& [left, right] : pairs) {
    const auto in_left = findBoard(left, board);
    const auto in_right = findBoard(right, board);
    if (in_left && in_right) {
      views.push_back({*in_left, *in_right});
    }
  }
  CalibratedRig rig = calibrateRig(views, board, pairs.front().first.size());
  std::printf("whole board in %zu of %zu pairs\n", views.size(), pairs.size());
  std::printf("reprojection error %.3f px, epipolar error %.3f px (root mean square)\n",
              rig.reprojection_error_px, rig.epipolar_error_px);
  std::printf("focal length %.1f px, baseline %.4f m\n", rig.left.projection(0, 0),
              rig.baselineM());
  return rig;
}

/// Messages recorded from the node, by stamp.
struct RawRecording {
  std::map<ros::Time, sensor_msgs::ImageConstPtr> lefts, disparities;
  cbmv_stereo::Rectification rectification;  ///< the newest
};

RawRecording readRawRecording(const std::string& path) {
  RawRecording recording;
  rosbag::Bag bag;
  bag.open(path, rosbag::bagmode::Read);
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    if (const auto image = message.instantiate<sensor_msgs::Image>()) {
      const bool is_left = message.getTopic() == "/stereo/left/image_rect";
      (is_left ? recording.lefts : recording.disparities)[image->header.stamp] = image;
    } else if (const auto rows = message.instantiate<cbmv_stereo::Rectification>()) {
      recording.rectification = *rows;
    }
  }
  return recording;
}

}  // namespace

void calibrate(const CalibrateArguments& arguments) {
  requireWritableFolder(arguments.output);
  std::vector<std::pair<cv::Mat, cv::Mat>> pairs;
  for (const auto& [left, right] : pairsIn(arguments.folder)) {
    pairs.emplace_back(readGrayImage(left), readGrayImage(right));
    if (pairs.back().first.size() != pairs.front().first.size() ||
        pairs.back().second.size() != pairs.front().first.size()) {
      throw Error("the images of pair " + left +
                  " have another size than the first pair, expected equal sizes. Remove this pair");
    }
  }
  const CalibratedRig rig = calibratePairs(pairs, arguments.board);
  fs::create_directories(arguments.output);
  writeCameraFile(arguments.output + "/left.yaml", "left", toCameraInfo(rig.left, rig.image_size));
  writeCameraFile(arguments.output + "/right.yaml", "right",
                  toCameraInfo(rig.right, rig.image_size));
  RawBag bag(arguments.output + "/raw.bag", rig);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    bag.write(ros::Time(1.0 + static_cast<double>(i) / arguments.rate_hz), pairs[i].first,
              pairs[i].second);
  }
  std::printf("wrote left.yaml, right.yaml and raw.bag in %s\n", arguments.output.c_str());
}

void showRaw(const ShowRawArguments& arguments) {
  requireWritableFile(arguments.output);
  requireOtherFile(arguments.bag, arguments.output);
  const RawRecording recording = readRawRecording(arguments.bag);
  std::vector<cv::Mat> rows;
  for (const auto& [stamp, disparity] : recording.disparities) {
    const auto left = recording.lefts.find(stamp);
    if (left != recording.lefts.end() && rows.size() < arguments.frames) {
      const cv::Size size = imageSize(*disparity);
      rows.emplace_back();
      cv::hconcat(toColor(*left->second, "left/image_rect", size),
                  toColor(*disparity, "disparity_color", size), rows.back());
    }
  }
  if (rows.empty()) {
    throw Error("bag " + arguments.bag +
                ": no disparity has the stamp of a left image. Record both from the same run");
  }
  cv::Mat picture;
  cv::vconcat(rows, picture);
  writeImage(arguments.output, picture);
  const auto& measured = recording.rectification;
  std::printf("%zu frames; vertical offset measured by the node: %.3f px (RMS of %d matches)\n",
              recording.disparities.size(), measured.rms_before_px, measured.matches);
  std::printf("wrote %s\n", arguments.output.c_str());
}

}  // namespace cbmv
