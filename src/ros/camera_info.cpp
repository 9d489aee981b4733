#include "ros/camera_info.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace cbmv {
namespace {

int toInt(std::uint32_t value) {
  constexpr std::uint32_t kLargest = std::numeric_limits<int>::max();
  return static_cast<int>(std::min(value, kLargest));
}

std::uint32_t toUnsigned(int value) { return static_cast<std::uint32_t>(std::max(value, 0)); }

}  // namespace

CameraCalibration toCameraCalibration(const sensor_msgs::CameraInfo& info) {
  CameraCalibration camera;
  camera.width = toInt(info.width);
  camera.height = toInt(info.height);
  std::copy(info.K.begin(), info.K.end(), camera.camera_matrix.begin());
  camera.distortion_model = info.distortion_model;
  camera.distortion = info.D;
  std::copy(info.R.begin(), info.R.end(), camera.rectification.begin());
  std::copy(info.P.begin(), info.P.end(), camera.projection.begin());
  camera.binning_x = std::max(1, toInt(info.binning_x));
  camera.binning_y = std::max(1, toInt(info.binning_y));
  camera.roi = {toInt(info.roi.x_offset), toInt(info.roi.y_offset), toInt(info.roi.width),
                toInt(info.roi.height)};
  return camera;
}

sensor_msgs::CameraInfo toCameraInfo(const CameraCalibration& camera,
                                     const std_msgs::Header& header) {
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = toUnsigned(camera.width);
  info.height = toUnsigned(camera.height);
  info.distortion_model = camera.distortion_model;
  info.D = camera.distortion;
  std::copy(camera.camera_matrix.begin(), camera.camera_matrix.end(), info.K.begin());
  std::copy(camera.rectification.begin(), camera.rectification.end(), info.R.begin());
  std::copy(camera.projection.begin(), camera.projection.end(), info.P.begin());
  info.binning_x = camera.binning_x > 1 ? toUnsigned(camera.binning_x) : 0;  // 0: none
  info.binning_y = camera.binning_y > 1 ? toUnsigned(camera.binning_y) : 0;
  info.roi.x_offset = toUnsigned(camera.roi.x);
  info.roi.y_offset = toUnsigned(camera.roi.y);
  info.roi.width = toUnsigned(camera.roi.width);
  info.roi.height = toUnsigned(camera.roi.height);
  return info;
}

StereoGeometry toGeometry(const sensor_msgs::CameraInfo& left_info,
                          const sensor_msgs::CameraInfo& right_info, cv::Size image_size,
                          const InputNames& topics) {
  const StereoCameras cameras{toCameraCalibration(left_info), toCameraCalibration(right_info)};
  return requireUsable(checkCalibration(cameras, image_size, topics, RectifiedBy::kOthers));
}

sensor_msgs::CameraInfo toRectifiedInfo(const StereoGeometry& geometry, cv::Size size,
                                        const std_msgs::Header& header) {
  const double fx = geometry.left_fx_px;
  const double fy = geometry.left_fy_px;
  const double cx = geometry.left_cx_px;
  const double cy = geometry.left_cy_px;
  CameraCalibration camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.distortion_model = "plumb_bob";
  camera.distortion.assign(5, 0.0);
  camera.camera_matrix = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
  camera.rectification = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.projection = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
  return toCameraInfo(camera, header);
}

}  // namespace cbmv
