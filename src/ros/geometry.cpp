#include "ros/geometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>

#include "ros/image_conversion.h"

namespace cbmv {
namespace {

/// In px or m: beyond, products and quotients of such numbers may not fit a float.
constexpr double kLargest = 1e9;
constexpr double kSmallest = 1e-9;

/// The part of a projection matrix that is used, in pixels of the image as it is sent.
struct Projection {
  double fx;
  double fy;
  double cx;
  double cy;
  double tx;  ///< P[3]: −fx times the camera's place on the baseline, px m
};

/// Size of the images that belong to `info`.
cv::Size describedSize(const sensor_msgs::CameraInfo& info) {
  const bool whole = info.roi.width == 0 || info.roi.height == 0;
  const std::uint32_t width = whole ? info.width : info.roi.width;
  const std::uint32_t height = whole ? info.height : info.roi.height;
  return toSize(width / std::max(1U, info.binning_x), height / std::max(1U, info.binning_y));
}

void checkInfo(const sensor_msgs::CameraInfo& info, const std::string& topic, cv::Size image_size) {
  if (describedSize(info) != image_size) {
    throw InputError(InputFault::kCameraInfoSize, topic + " describes images of " +
                                                      sizeText(describedSize(info)) +
                                                      ", the image has " + sizeText(image_size));
  }
  const auto unusable = std::find_if_not(info.P.begin(), info.P.end(), [](double value) {
    return std::abs(value) <= kLargest;  // NaN is not
  });
  if (unusable != info.P.end() || info.P[0] < kSmallest || info.P[5] < kSmallest) {
    const auto entry = [&](std::ptrdiff_t index) {
      std::ostringstream text;
      text << "P[" << index << "] = " << info.P[static_cast<std::size_t>(index)];
      return text.str();
    };
    const std::string entries =
        unusable != info.P.end() ? entry(unusable - info.P.begin()) : entry(0) + ", " + entry(5);
    throw InputError(
        InputFault::kUncalibrated,
        topic + " has no usable projection matrix (" + entries +
            "; P[0] and P[5] have to be > 0, all entries finite): calibrate the cameras");
  }
}

/// P refers to the whole sensor without binning.
Projection toProjection(const sensor_msgs::CameraInfo& info) {
  const double binning_x = std::max(1U, info.binning_x);
  const double binning_y = std::max(1U, info.binning_y);
  return {info.P[0] / binning_x, info.P[5] / binning_y, (info.P[2] - info.roi.x_offset) / binning_x,
          (info.P[6] - info.roi.y_offset) / binning_y, info.P[3] / binning_x};
}

/// Entries of P that are of a reasonable size each can still give a baseline that is not.
void checkGeometry(const StereoGeometry& geometry, const StereoTopics& topics) {
  for (const double number :
       {geometry.focal_length_px, geometry.baseline_m, geometry.disparity_offset_px,
        geometry.left_fx_px, geometry.left_fy_px, geometry.left_cx_px, geometry.left_cy_px}) {
    if (!(std::abs(number) <= kLargest)) {
      throw InputError(InputFault::kUncalibrated,
                       topics.left_info + " and " + topics.right_info +
                           " have projection matrices with numbers of no reasonable size, which "
                           "give a focal length of " +
                           std::to_string(geometry.focal_length_px) + " px and a baseline of " +
                           std::to_string(geometry.baseline_m) + " m: calibrate the cameras");
    }
  }
}

}  // namespace

StereoGeometry toGeometry(const sensor_msgs::CameraInfo& left_info,
                          const sensor_msgs::CameraInfo& right_info, cv::Size image_size,
                          const StereoTopics& topics) {
  checkInfo(left_info, topics.left_info, image_size);
  checkInfo(right_info, topics.right_info, image_size);
  const Projection left = toProjection(left_info);
  const Projection right = toProjection(right_info);
  if (right.tx > -kSmallest) {
    throw InputError(InputFault::kUncalibrated,
                     topics.right_info + " has P[3] = " + std::to_string(right.tx) +
                         ", which has to be negative (-fx * baseline): the cameras are swapped, or "
                         "calibrated one by one");
  }
  StereoGeometry geometry;
  geometry.focal_length_px = right.fx;
  geometry.baseline_m = -right.tx / right.fx;
  geometry.disparity_offset_px = left.cx - right.cx;
  geometry.left_fx_px = left.fx;
  geometry.left_fy_px = left.fy;
  geometry.left_cx_px = left.cx;
  geometry.left_cy_px = left.cy;
  checkGeometry(geometry, topics);
  return geometry;
}

sensor_msgs::CameraInfo toRectifiedInfo(const StereoGeometry& geometry, cv::Size size,
                                        const std_msgs::Header& header) {
  const double fx = geometry.left_fx_px;
  const double fy = geometry.left_fy_px;
  const double cx = geometry.left_cx_px;
  const double cy = geometry.left_cy_px;
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(size.width);
  info.height = static_cast<std::uint32_t>(size.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace cbmv
