#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <ros/ros.h>

#include "ros/stereo_pair.h"

// A stereo rig before rectification: lenses with distortion and rotated cameras.

namespace cbmv {

/// Both cameras before rectification, in their namespaces.
class RawCameras {
 public:
  RawCameras(const std::string& name_space, const std::string& left, const std::string& right)
      : nh_(name_space) {
    left_image_ = nh_.advertise<sensor_msgs::Image>(left + "/image_raw", 5);
    left_info_ = nh_.advertise<sensor_msgs::CameraInfo>(left + "/camera_info", 5);
    right_image_ = nh_.advertise<sensor_msgs::Image>(right + "/image_raw", 5);
    right_info_ = nh_.advertise<sensor_msgs::CameraInfo>(right + "/camera_info", 5);
  }

  void publish(const PairMessages& messages) {
    left_info_.publish(messages.left_info);
    right_info_.publish(messages.right_info);
    left_image_.publish(messages.left_image);
    right_image_.publish(messages.right_image);
  }

 private:
  ros::NodeHandle nh_;
  ros::Publisher left_image_;
  ros::Publisher left_info_;
  ros::Publisher right_image_;
  ros::Publisher right_info_;
};

/// A camera before rectification.
struct Lens {
  cv::Matx33d matrix;
  std::vector<double> distortion;
  cv::Vec3d rotation;  ///< to the rectified camera, Rodrigues

  /// Image of this camera if the rectified camera sees `rectified`. Each raw pixel is looked up
  /// along its ray.
  cv::Mat view(const cv::Mat& rectified, const sensor_msgs::CameraInfo& info) const {
    std::vector<cv::Point2f> raw;
    for (int y = 0; y < rectified.rows; ++y) {
      for (int x = 0; x < rectified.cols; ++x) {
        raw.emplace_back(static_cast<float>(x), static_cast<float>(y));
      }
    }
    std::vector<cv::Point2f> seen;
    cv::undistortPoints(raw, seen, matrix, distortion, turn(), cv::Matx34d(info.P.data()));
    cv::Mat image;
    cv::remap(rectified, image, cv::Mat(seen).reshape(2, rectified.rows), cv::noArray(),
              cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    return image;
  }

  void describe(sensor_msgs::CameraInfo& info) const {
    info.distortion_model = "plumb_bob";
    info.D = distortion;
    std::copy_n(matrix.val, 9, info.K.begin());
    std::copy_n(turn().val, 9, info.R.begin());
  }

  cv::Matx33d turn() const {
    cv::Matx33d turned;
    cv::Rodrigues(rotation, turned);
    return turned;
  }
};

// For images of 220 x 160 px. Distortion as strong as that of a real rig (scripts/demo --raw),
// larger rotation.
inline const Lens kLeftLens{{185, 0, 113, 0, 184.5, 77, 0, 0, 1},
                            {-0.29, 0.11, -0.001, 0.0005, -0.02},
                            {0.01, -0.02, 0.008}};
inline const Lens kRightLens{
    {187, 0, 108, 0, 187, 82, 0, 0, 1}, {-0.27, 0.09, 0.0008, -0.0003, 0}, {-0.012, 0.015, -0.009}};

/// Replaces the rectified images of `messages` (mono8) by raw ones, and sets their calibration.
inline void makeRaw(const Lens& left, const Lens& right, PairMessages& messages) {
  const auto distort = [](const Lens& lens, sensor_msgs::Image& image,
                          sensor_msgs::CameraInfo& info) {
    const cv::Mat rectified(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
                            image.data.data());
    image = *makeImage(lens.view(rectified, info), "mono8", image.header);
    lens.describe(info);
  };
  distort(left, *messages.left_image, *messages.left_info);
  distort(right, *messages.right_image, *messages.right_info);
}

}  // namespace cbmv
