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

// The one place, with the headers of this folder that it includes, in which ROS messages become the
// core's types and back.

namespace cbmv {

/// Conventions of stereo_image_proc: image 32FC1, f and T as in StereoGeometry, max_disparity the
/// largest that is tested. Published disparities, min_disparity and max_disparity are the matcher's
/// minus geometry.disparity_offset_px, so that Z = f T / d; pixels without a disparity hold
/// min_disparity − 1. valid_window: the columns in which at least one hypothesis exists, and what
/// lies to the left or right of them if disparities have been filled in there.
stereo_msgs::DisparityImage toDisparityImage(const StereoResult& result,
                                             const StereoGeometry& geometry, double delta_d,
                                             const std_msgs::Header& header);

/// The disparities as published, CV_32FC1, but NaN where there is none.
cv::Mat toValidDisparity(const StereoResult& result, const StereoGeometry& geometry);

/// The same from a message of any node: what is below min_disparity, or not finite, is none. Throws
/// InputError if the image is not a proper 32FC1 image.
cv::Mat toValidDisparity(const stereo_msgs::DisparityImage& message, const std::string& topic);

/// Z in metres along the left camera's optical axis, 32FC1 as REP 118 has it: NaN where there is no
/// disparity, or the point lies at or beyond infinity.
sensor_msgs::Image toDepthImage(const StereoResult& result, const StereoGeometry& geometry,
                                const std_msgs::Header& header);

/// Standard deviation of the Z of toDepthImage in metres, 32FC1: of inliers, see
/// StereoResult::disparity_sigma, which must not be empty. NaN where there is no depth.
sensor_msgs::Image toDepthSigmaImage(const StereoResult& result, const StereoGeometry& geometry,
                                     const std_msgs::Header& header);

/// The same as a map, CV_32FC1; empty if result.disparity_sigma is.
cv::Mat toDepthSigma(const StereoResult& result, const StereoGeometry& geometry);

/// Z in whole millimetres, 16UC1: 0 where there is none, or more than 65 535 mm.
sensor_msgs::Image toRawDepthImage(const StereoResult& result, const StereoGeometry& geometry,
                                   const std_msgs::Header& header);

/// mono8: 255 where there is a disparity, 0 where there is none.
sensor_msgs::Image toValidMask(const StereoResult& result, const std_msgs::Header& header);

/// 32FC1 in [0, 1], see StereoResult::confidence.
sensor_msgs::Image toConfidenceImage(const StereoResult& result, const std_msgs::Header& header);

/// rgb8 for viewers: from blue at the smallest disparity of the range to red at the largest; black
/// where there is none.
sensor_msgs::Image toDisparityColorImage(const StereoResult& result,
                                         const std_msgs::Header& header);

/// What became of the frames since the node came up.
struct FrameCounts {
  std::uint64_t processed = 0;
  std::uint64_t dropped_busy = 0;
  std::uint64_t dropped_bad_input = 0;
  std::uint64_t dropped_failed = 0;
};

/// What Status says about the node besides the frame.
struct NodeState {
  FrameCounts counts;
  std::string forest;  ///< file name
  int threads = 0;     ///< in use
  double age_ms = 0;   ///< from the frame's stamp to now
};

cbmv_stereo::Status toStatus(const StereoResult& result, const NodeState& state,
                             const std_msgs::Header& header);

cbmv_stereo::Rectification toRectification(const RectificationState& state,
                                           const StereoResult& result,
                                           const std_msgs::Header& header);

/// A pair as a driver and image_proc publish it.
struct RecordedPair {
  sensor_msgs::Image left_grey;   ///< mono8
  sensor_msgs::Image left_color;  ///< bgr8
  sensor_msgs::Image right_grey;  ///< mono8
  sensor_msgs::CameraInfo left_info;
  sensor_msgs::CameraInfo right_info;
};

/// `left` and `right` are CV_8UC3 in the order blue, green, red; both get the same header, as
/// stereo rigs have it after rectification.
RecordedPair toRecordedPair(const cv::Mat& left, const cv::Mat& right,
                            const StereoCalibration& calibration, const std_msgs::Header& header);

/// Disparities of a message, back in pixels of the images.
struct RecordedDisparity {
  cv::Mat values;  ///< CV_32FC1; `invalid` where there is none
  float lowest = 0;
  float highest = 0;
  float invalid = 0;
};

/// Takes back the offset that toDisparityImage took off.
RecordedDisparity fromDisparityImage(const stereo_msgs::DisparityImage& message,
                                     double disparity_offset_px);

}  // namespace cbmv
