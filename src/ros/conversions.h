#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <stereo_msgs/DisparityImage.h>

#include "io/calibration.h"
#include "rectification/offset_source.h"
#include "ros/camera_info.h"
#include "ros/image_conversion.h"
#include "ros/input_messages.h"
#include "ros/point_cloud.h"

#include "cbmv_stereo/stereo_matcher.h"
#include <cbmv_stereo/Rectification.h>
#include <cbmv_stereo/Status.h>

// Only this header and the headers of this folder that it includes convert between ROS messages and
// core types.

namespace cbmv {

/// Conventions of stereo_image_proc: image 32FC1, f and T as in StereoGeometry, max_disparity is
/// the end of the disparity range. Published disparities, min_disparity and max_disparity are the
/// matcher's values minus geometry.disparity_offset_px, so Z = f T / d. Pixels without a disparity
/// are min_disparity − 1. valid_window: the columns with at least one hypothesis, extended by the
/// columns left or right of them if these have been filled.
stereo_msgs::DisparityImage toDisparityImage(const StereoResult& result,
                                             const StereoGeometry& geometry, double delta_d,
                                             const std_msgs::Header& header);

/// Disparities as published, CV_32FC1; NaN where there is none.
cv::Mat toValidDisparity(const StereoResult& result, const StereoGeometry& geometry);

/// The same from a message of any node. Values below min_disparity and values that are not finite
/// mean no disparity. Throws InputError if the image is not a valid 32FC1 image.
cv::Mat toValidDisparity(const stereo_msgs::DisparityImage& message, const std::string& topic);

/// Z in meters along the left camera's optical axis, 32FC1 as in REP 118. NaN where there is no
/// disparity or the point is at or beyond infinity.
sensor_msgs::Image toDepthImage(const StereoResult& result, const StereoGeometry& geometry,
                                const std_msgs::Header& header);

/// Standard deviation of toDepthImage's Z in meters, 32FC1; valid for inliers, see
/// StereoResult::disparity_sigma, which must not be empty. NaN where there is no depth.
sensor_msgs::Image toDepthSigmaImage(const StereoResult& result, const StereoGeometry& geometry,
                                     const std_msgs::Header& header);

/// The same as a matrix, CV_32FC1; empty if result.disparity_sigma is empty.
cv::Mat toDepthSigma(const StereoResult& result, const StereoGeometry& geometry);

/// Z in whole millimeters, 16UC1; 0 where there is none or Z is above 65 535 mm.
sensor_msgs::Image toRawDepthImage(const StereoResult& result, const StereoGeometry& geometry,
                                   const std_msgs::Header& header);

/// mono8: 255 where there is a disparity, 0 where there is none.
sensor_msgs::Image toValidMask(const StereoResult& result, const std_msgs::Header& header);

/// 32FC1 in [0, 1], see StereoResult::confidence.
sensor_msgs::Image toConfidenceImage(const StereoResult& result, const std_msgs::Header& header);

/// rgb8 for viewers: blue at the smallest disparity of the range, red at the largest, black where
/// there is none.
sensor_msgs::Image toDisparityColorImage(const StereoResult& result,
                                         const std_msgs::Header& header);

/// Frames since the node was started, by outcome.
struct FrameCounts {
  std::uint64_t processed = 0;
  std::uint64_t dropped_busy = 0;
  std::uint64_t dropped_bad_input = 0;
  std::uint64_t dropped_failed = 0;
};

/// State of the node in the Status message.
struct NodeState {
  FrameCounts counts;
  std::string forest;  ///< file name
  int threads = 0;     ///< threads in use
  double age_ms = 0;   ///< time since the frame's stamp
};

cbmv_stereo::Status toStatus(const StereoResult& result, const NodeState& state,
                             const std_msgs::Header& header);

cbmv_stereo::Rectification toRectification(const RectificationState& state,
                                           const StereoResult& result,
                                           const std_msgs::Header& header);

/// A pair as published by a driver and image_proc.
struct RecordedPair {
  sensor_msgs::Image left_gray;   ///< mono8
  sensor_msgs::Image left_color;  ///< bgr8
  sensor_msgs::Image right_gray;  ///< mono8
  sensor_msgs::CameraInfo left_info;
  sensor_msgs::CameraInfo right_info;
};

/// `left` and `right` are CV_8UC3, BGR. All messages get the same header, which is the convention
/// after rectification.
RecordedPair toRecordedPair(const cv::Mat& left, const cv::Mat& right,
                            const StereoCalibration& calibration, const std_msgs::Header& header);

/// Disparities of a message, converted to pixels of the images.
struct RecordedDisparity {
  cv::Mat values;  ///< CV_32FC1; `invalid` where there is none
  float lowest = 0;
  float highest = 0;
  float invalid = 0;
};

/// Adds the offset that toDisparityImage subtracts.
RecordedDisparity fromDisparityImage(const stereo_msgs::DisparityImage& message,
                                     double disparity_offset_px);

}  // namespace cbmv
