#pragma once

#include <algorithm>

#include <boost/make_shared.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "ros/conversions.h"

namespace cbmv {

/// A textured plane with a nearer rectangle in front of it, CV_8UC1.
struct StereoPair {
  cv::Mat left;
  cv::Mat right;
  cv::Mat disparity;  ///< CV_32SC1, px, left view
};

inline StereoPair renderPair(cv::Size size, int far_px, int near_px, std::uint64_t seed = 1) {
  StereoPair pair;
  cv::RNG random(seed);
  pair.right.create(size, CV_8UC1);
  random.fill(pair.right, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(pair.right, pair.right, {3, 3}, 0.8);
  pair.disparity = cv::Mat(size, CV_32SC1, cv::Scalar(far_px));
  pair.disparity(cv::Rect(size.width / 3, size.height / 3, size.width / 3, size.height / 3))
      .setTo(near_px);
  pair.left.create(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int matched = x - pair.disparity.at<int>(y, x);
      pair.left.at<uchar>(y, x) = pair.right.at<uchar>(y, std::clamp(matched, 0, size.width - 1));
    }
  }
  return pair;
}

/// The cameras of the pair; toed in if cx_left_px and cx_right_px differ.
struct Rig {
  double focal_length_px = 120;
  double baseline_m = 0.25;
  double cx_left_px = 62.5;
  double cx_right_px = 62.5;
  double cy_px = 40.25;
};

inline sensor_msgs::ImagePtr makeImage(const cv::Mat& image, const std::string& encoding,
                                       const std_msgs::Header& header) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->header = header;
  message->encoding = encoding;
  message->width = static_cast<std::uint32_t>(image.cols);
  message->height = static_cast<std::uint32_t>(image.rows);
  message->step = static_cast<std::uint32_t>(image.cols * image.elemSize());
  const cv::Mat packed = image.clone();
  message->data.assign(packed.data, packed.data + packed.total() * packed.elemSize());
  return message;
}

inline sensor_msgs::CameraInfoPtr makeInfo(const Rig& rig, bool right, cv::Size size,
                                           const std_msgs::Header& header) {
  auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->header = header;
  info->width = static_cast<std::uint32_t>(size.width);
  info->height = static_cast<std::uint32_t>(size.height);
  info->P = {rig.focal_length_px,
             0,
             right ? rig.cx_right_px : rig.cx_left_px,
             right ? -rig.focal_length_px * rig.baseline_m : 0,
             0,
             rig.focal_length_px,
             rig.cy_px,
             0,
             0,
             0,
             1,
             0};
  info->R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info->K = {info->P[0], 0, info->P[2], 0, info->P[5], info->P[6], 0, 0, 1};
  return info;
}

/// Modifiable messages of a synchronized pair.
struct PairMessages {
  sensor_msgs::ImagePtr left_image;
  sensor_msgs::CameraInfoPtr left_info;
  sensor_msgs::ImagePtr right_image;
  sensor_msgs::CameraInfoPtr right_info;

  StereoMessages asConst() const { return {left_image, left_info, right_image, right_info}; }
};

inline PairMessages makeMessages(const StereoPair& pair, const Rig& rig, ros::Time stamp) {
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = "left_camera";
  return {makeImage(pair.left, "mono8", header), makeInfo(rig, false, pair.left.size(), header),
          makeImage(pair.right, "mono8", header), makeInfo(rig, true, pair.right.size(), header)};
}

}  // namespace cbmv
