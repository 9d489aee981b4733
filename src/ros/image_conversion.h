#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <opencv2/core.hpp>
#include <sensor_msgs/Image.h>

#include "input/stereo_input.h"
#include "ros/input_messages.h"

#include "cbmv_stereo/calibration_check.h"

// Converts image messages to matrices and back.

namespace cbmv {

/// Returns the pixels with their 8 or 16 bits, CV_8U or CV_16U, with one channel (gray), three
/// (BGR) or four (BGRA). Supports mono, color, Bayer, YUV 4:2:2 (UYVY and YUYV) and plain (8UC1,
/// 16UC1, 8UC3, …) encodings. Bayer and YUV images are converted to color if `color` is set, else
/// to gray. The result may share the memory of the message, which `owner` keeps alive. Throws
/// InputError.
cv::Mat decodeImage(const sensor_msgs::Image& message, const boost::shared_ptr<const void>& owner,
                    bool color, const std::string& topic);

/// A warning if the encoding does not define the color order (8UC3); else empty.
std::string encodingWarning(const std::string& encoding, const std::string& topic);

/// Builds the matcher's input. It may share the memory of the messages, which must outlive it.
/// Throws InputError if an image is malformed, its encoding is unknown, or the frame_ids differ and
/// `allow_different_frame_ids` is false.
StereoInput toStereoInput(const StereoMessages& messages, const StereoTopics& topics,
                          bool allow_different_frame_ids);

/// Copy of the image in color, CV_8UC3, BGR. Throws InputError if decodeImage does not support the
/// encoding or the size is not `size`.
cv::Mat toColor(const sensor_msgs::Image& message, const std::string& topic, cv::Size size);

/// Colors of the point cloud: `image`, or `left_gray` (CV_8UC1) if `image` is null or unusable. In
/// the latter case the error is passed to `report` (may be empty).
cv::Mat toCloudColor(const sensor_msgs::ImageConstPtr& image, const std::string& topic,
                     const cv::Mat& left_gray,
                     const std::function<void(const std::string&)>& report);

/// A 32FC1 image as CV_32FC1. May share the message's memory. Throws InputError for other encodings
/// and malformed images.
cv::Mat toFloats(const sensor_msgs::Image& message, const std::string& topic);

/// Copy of a 32FC1 image.
cv::Mat fromFloatImage(const sensor_msgs::Image& message);

sensor_msgs::Image toMessage(const cv::Mat& image, const std::string& encoding,
                             const std_msgs::Header& header);

/// Quotes text from outside for messages: no control characters, limited length.
std::string quoted(const std::string& text);

/// Values above the range of int become its maximum.
cv::Size toSize(std::uint32_t width, std::uint32_t height);
cv::Size imageSize(const sensor_msgs::Image& message);

}  // namespace cbmv
