#include "offline/message_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "io/camera_yaml.h"
#include "io/disparity_file.h"
#include "io/image_file.h"
#include "io/pfm.h"
#include "io/ply.h"
#include "ros/conversions.h"

namespace cbmv {
namespace {

namespace encodings = sensor_msgs::image_encodings;

constexpr float kNone = std::numeric_limits<float>::infinity();

/// The pixels of an image from this program: without padding, native byte order.
cv::Mat pixelsOf(const sensor_msgs::Image& message, int type) {
  return cv::Mat(static_cast<int>(message.height), static_cast<int>(message.width), type,
                 const_cast<std::uint8_t*>(message.data.data()));
}

}  // namespace

void writeMessageFile(const std::string& path, const stereo_msgs::DisparityImage& message) {
  cv::Mat_<float> disparity = toValidDisparity(message, path);
  std::replace_if(
      disparity.begin(), disparity.end(), [](float value) { return std::isnan(value); }, kNone);
  if (std::filesystem::path(path).extension() == ".png") {
    writeImage(path, toKittiDisparity(disparity));
  } else {
    writePfm(path, disparity);
  }
}

void writeMessageFile(const std::string& path, const sensor_msgs::Image& message) {
  if (message.encoding == encodings::TYPE_32FC1) {
    writePfm(path, pixelsOf(message, CV_32FC1));
  } else if (message.encoding == encodings::RGB8) {
    cv::Mat bgr;
    cv::cvtColor(pixelsOf(message, CV_8UC3), bgr, cv::COLOR_RGB2BGR);
    writeImage(path, bgr);
  } else {
    writeImage(path,
               pixelsOf(message, message.encoding == encodings::TYPE_16UC1 ? CV_16UC1 : CV_8UC1));
  }
}

void writeMessageFile(const std::string& path, const sensor_msgs::PointCloud2& message) {
  writePly(path, fromPointCloud(message));
}

void writeMessageFile(const std::string& path, const sensor_msgs::CameraInfo& message) {
  CameraCalibration camera = toCameraCalibration(message);
  camera.name = message.header.frame_id;
  writeCameraYaml(path, camera);
}

}  // namespace cbmv
