#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>
#include <sensor_msgs/Image.h>

#include "ros/input_messages.h"

// Images of messages as matrices and back.

namespace cbmv {

/// The pair as CV_8UC1. May share the messages' memory: they have to live as long.
struct GreyPair {
  cv::Mat left;
  cv::Mat right;
};

/// Checks both images and converts them to grey, from mono, colour, Bayer and YUV 4:2:2 images of 8
/// or 16 bits; both need not have the same encoding. 16-bit images are stretched to 8 bits: all
/// levels between the darkest and the brightest 0.1 % of the pixels (of both images where both have
/// 16 bits) are kept apart as far as 256 levels can. Throws InputError.
GreyPair toGreyPair(const StereoMessages& messages, const StereoTopics& topics,
                    bool allow_different_frame_ids);

/// Image in colour, CV_8UC3 in the order blue, green, red, from the encodings of toGreyPair. Throws
/// InputError for other encodings, and for other sizes than `size`.
cv::Mat toColor(const sensor_msgs::Image& message, const std::string& topic, cv::Size size);

/// A 32FC1 image as CV_32FC1. May share the message's memory. Throws InputError for other encodings
/// and malformed images.
cv::Mat toFloats(const sensor_msgs::Image& message, const std::string& topic);

/// Copy of a 32FC1 image.
cv::Mat fromFloatImage(const sensor_msgs::Image& message);

sensor_msgs::Image toMessage(const cv::Mat& image, const std::string& encoding,
                             const std_msgs::Header& header);

/// Text that somebody else wrote, for people: in quotes, without control characters, not too long.
std::string quoted(const std::string& text);

std::string sizeText(cv::Size size);
/// Numbers beyond the range of int are its largest.
cv::Size toSize(std::uint32_t width, std::uint32_t height);
cv::Size imageSize(const sensor_msgs::Image& message);

}  // namespace cbmv
