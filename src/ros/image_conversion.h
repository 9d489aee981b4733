#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <opencv2/core.hpp>
#include <sensor_msgs/Image.h>

#include "input/stereo_input.h"
#include "ros/input_messages.h"

#include "cbmv_stereo/calibration_check.h"

// Images of messages as matrices and back.

namespace cbmv {

/// The pixels with the 8 or 16 bits that they have: CV_8U or CV_16U, with one channel (gray), three
/// (blue, green, red) or four (and alpha). From mono, color, Bayer, YUV 4:2:2 (UYVY and YUYV) and
/// plain (8UC1, 16UC1, 8UC3, …) encodings. Bayer and YUV images become color where `color` is set,
/// else gray. May share the memory of the message, which `owner` keeps. Throws InputError.
cv::Mat decodeImage(const sensor_msgs::Image& message, const boost::shared_ptr<const void>& owner,
                    bool color, const std::string& topic);

/// One sentence if the encoding does not tell the order of the colors (8UC3); else empty.
std::string encodingWarning(const std::string& encoding, const std::string& topic);

/// What the method takes, from messages. May share the messages' memory: they have to live as long.
/// Throws InputError if an image is malformed or its encoding unknown, or if frame_ids differ and
/// must not.
StereoInput toStereoInput(const StereoMessages& messages, const StereoTopics& topics,
                          bool allow_different_frame_ids);

/// Image in color, CV_8UC3 in the order blue, green, red; a copy. Throws InputError for encodings
/// that decodeImage does not take, and for other sizes than `size`.
cv::Mat toColor(const sensor_msgs::Image& message, const std::string& topic, cv::Size size);

/// Colors of the cloud: those of `image`, or of `left_gray` (CV_8UC1) where that is null or cannot
/// be used, which `report` (may be empty) is told.
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

/// Text that somebody else wrote, for people: in quotes, without control characters, not too long.
std::string quoted(const std::string& text);

/// Numbers beyond the range of int are its largest.
cv::Size toSize(std::uint32_t width, std::uint32_t height);
cv::Size imageSize(const sensor_msgs::Image& message);

}  // namespace cbmv
