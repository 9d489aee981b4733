#include "ros/image_conversion.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <limits>
#include <optional>

#include <boost/make_shared.hpp>
#include <cv_bridge/cv_bridge.h>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "input/camera_properties.h"
#include "ros/camera_info.h"

#include "cbmv_stereo/gray_pair.h"

namespace cbmv {
namespace {

namespace encodings = sensor_msgs::image_encodings;

const std::string kKnownEncodings =
    "Expected mono8, mono16, bgr8, rgb8, a Bayer or a YUV 4:2:2 encoding. Set the encoding in the "
    "driver.";

/// Byte order of YUV 4:2:2.
enum class Yuv { kUyvy, kYuyv };

/// Knows all names used by drivers and later ROS releases; none for other encodings.
std::optional<Yuv> yuvOrder(std::string encoding) {
  std::transform(encoding.begin(), encoding.end(), encoding.begin(),
                 [](unsigned char letter) { return std::tolower(letter); });
  for (const char* name : {"yuv422", "uyvy", "yuv422_uyvy", "uyvy422"}) {
    if (encoding == name) {
      return Yuv::kUyvy;
    }
  }
  for (const char* name : {"yuyv", "yuy2", "yuv422_yuy2", "yuv422_yuyv", "yuyv422"}) {
    if (encoding == name) {
      return Yuv::kYuyv;
    }
  }
  return std::nullopt;
}

std::size_t bytesPerPixel(const sensor_msgs::Image& message, const std::string& topic) {
  if (yuvOrder(message.encoding)) {
    return 2;
  }
  try {
    return static_cast<std::size_t>(encodings::bitDepth(message.encoding)) / 8 *
           static_cast<std::size_t>(encodings::numChannels(message.encoding));
  } catch (const std::runtime_error&) {
    throw InputError(
        InputFault::kUnsupportedEncoding,
        topic + " has an unknown encoding " + quoted(message.encoding) + ". " + kKnownEncodings);
  }
}

void checkImage(const sensor_msgs::Image& message, const std::string& topic) {
  if (message.width == 0 || message.height == 0) {
    throw InputError(InputFault::kEmptyImage,
                     topic + " has an empty image (" + sizeText(imageSize(message)) +
                         "), expected at least 1 x 1 px. Check the driver");
  }
  const std::size_t row_bytes = bytesPerPixel(message, topic) * message.width;
  if (message.step < row_bytes) {
    throw InputError(InputFault::kTruncatedImage,
                     topic + " has a step of " + std::to_string(message.step) +
                         " bytes, expected at least " + std::to_string(row_bytes) +
                         " for a row of " + std::to_string(message.width) + " px with encoding " +
                         quoted(message.encoding) + ". Correct step or encoding in the driver");
  }
  const std::size_t image_bytes = static_cast<std::size_t>(message.step) * message.height;
  if (message.data.size() != image_bytes) {
    throw InputError(
        InputFault::kTruncatedImage,
        topic + " has " + std::to_string(message.data.size()) + " bytes of data, expected " +
            std::to_string(image_bytes) + " (" + std::to_string(message.height) + " rows of " +
            std::to_string(message.step) + " bytes). Correct height, step or data in the driver");
  }
}

/// Swaps the bytes of each value, because cv_bridge expects other types for big-endian data. The
/// message must have passed checkImage.
boost::shared_ptr<sensor_msgs::Image> toLittleEndian(const sensor_msgs::Image& message) {
  auto swapped = boost::make_shared<sensor_msgs::Image>(message);
  swapped->is_bigendian = 0;
  const int value_bytes = encodings::bitDepth(message.encoding) / 8;
  const int row_values = static_cast<int>(message.width) * encodings::numChannels(message.encoding);
  for (std::size_t row = 0; row < message.height; ++row) {
    std::uint8_t* value = swapped->data.data() + row * message.step;
    for (int i = 0; i < row_values; ++i, value += value_bytes) {
      std::reverse(value, value + value_bytes);
    }
  }
  return swapped;
}

/// Encodings of plain channels, which cv_bridge does not convert to colors. Some drivers set them.
bool isPlain(const std::string& encoding) {
  for (const std::string& plain :
       {encodings::TYPE_8UC1, encodings::TYPE_16UC1, encodings::TYPE_8UC3, encodings::TYPE_16UC3,
        encodings::TYPE_8UC4, encodings::TYPE_16UC4}) {
    if (encoding == plain) {
      return true;
    }
  }
  return false;
}

cv::Mat decodeYuv(const sensor_msgs::Image& message, Yuv order, bool color) {
  const cv::Mat yuv(static_cast<int>(message.height), static_cast<int>(message.width), CV_8UC2,
                    const_cast<std::uint8_t*>(message.data.data()), message.step);
  cv::Mat decoded;
  if (color) {
    cv::cvtColor(yuv, decoded,
                 order == Yuv::kUyvy ? cv::COLOR_YUV2BGR_UYVY : cv::COLOR_YUV2BGR_YUY2);
  } else {
    cv::extractChannel(yuv, decoded, order == Yuv::kUyvy ? 1 : 0);
  }
  return decoded;
}

/// Encoding requested from cv_bridge. Bayer images are converted directly to gray if no color is
/// needed.
std::string targetEncoding(const std::string& encoding, bool color) {
  const bool deep = encodings::bitDepth(encoding) == 16;
  return color || encodings::isColor(encoding) ? (deep ? encodings::BGR16 : encodings::BGR8)
                                               : (deep ? encodings::MONO16 : encodings::MONO8);
}

cv::Mat decodeChecked(const sensor_msgs::Image& message, const boost::shared_ptr<const void>& owner,
                      bool color) {
  if (const std::optional<Yuv> order = yuvOrder(message.encoding)) {
    return decodeYuv(message, *order, color);
  }
  if (message.is_bigendian != 0 && encodings::bitDepth(message.encoding) == 16) {
    const auto swapped = toLittleEndian(message);
    return decodeChecked(*swapped, swapped, color).clone();
  }
  if (isPlain(message.encoding)) {
    return cv_bridge::toCvShare(message, owner)->image;
  }
  return cv_bridge::toCvShare(message, owner, targetEncoding(message.encoding, color))->image;
}

void checkFrameIds(const StereoMessages& messages, const std::string& both) {
  const std::string& left = messages.left_image->header.frame_id;
  const std::string& right = messages.right_image->header.frame_id;
  if (left != right) {
    throw InputError(InputFault::kDifferentFrameIds,
                     both + " have different frame_ids (" + quoted(left) + " and " + quoted(right) +
                         "), expected equal ones. Correct them in the driver, or set the parameter "
                         "allow_different_frame_ids to true");
  }
}

}  // namespace

std::string quoted(const std::string& text) {
  constexpr std::size_t kLongest = 60;
  std::string shown = text.substr(0, kLongest);
  std::replace_if(
      shown.begin(), shown.end(),
      [](char letter) { return std::isprint(static_cast<unsigned char>(letter)) == 0; }, '?');
  return "'" + shown + (text.size() > kLongest ? "...'" : "'");
}

cv::Size toSize(std::uint32_t width, std::uint32_t height) {
  constexpr std::uint32_t kLargest = std::numeric_limits<int>::max();
  return {static_cast<int>(std::min(width, kLargest)),
          static_cast<int>(std::min(height, kLargest))};
}

cv::Size imageSize(const sensor_msgs::Image& message) {
  return toSize(message.width, message.height);
}

cv::Mat decodeImage(const sensor_msgs::Image& message, const boost::shared_ptr<const void>& owner,
                    bool color, const std::string& topic) {
  checkImage(message, topic);
  try {
    return decodeChecked(message, owner, color);
  } catch (const cv_bridge::Exception&) {
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " has the encoding " + quoted(message.encoding) +
                         ", which is not an encoding of camera images. " + kKnownEncodings);
  } catch (const std::exception& error) {  // thrown by OpenCV
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " with encoding " + quoted(message.encoding) +
                         " cannot be converted to " + (color ? "color" : "gray") + ": " +
                         error.what() + ". " + kKnownEncodings);
  }
}

std::string encodingWarning(const std::string& encoding, const std::string& topic) {
  if (!isPlain(encoding) || encodings::numChannels(encoding) == 1) {
    return {};
  }
  return topic + " has the encoding " + quoted(encoding) +
         ", which does not define the color order. BGR is assumed. Set the encoding bgr8 or rgb8 "
         "in the driver.";
}

StereoInput toStereoInput(const StereoMessages& messages, const StereoTopics& topics,
                          bool allow_different_frame_ids) {
  const sensor_msgs::Image& left = *messages.left_image;
  const sensor_msgs::Image& right = *messages.right_image;
  StereoInput input;
  input.names = topics;
  input.left = decodeImage(left, messages.left_image, false, topics.left_image);
  input.right = decodeImage(right, messages.right_image, false, topics.right_image);
  if (!allow_different_frame_ids) {
    checkFrameIds(messages, topics.left_image + " and " + topics.right_image);
  }
  input.cameras = {toCameraCalibration(*messages.left_info),
                   toCameraCalibration(*messages.right_info)};
  for (const std::string& warning : {encodingWarning(left.encoding, topics.left_image),
                                     encodingWarning(right.encoding, topics.right_image)}) {
    if (!warning.empty()) {
      input.warnings.push_back(warning);
    }
  }
  return input;
}

cv::Mat toColor(const sensor_msgs::Image& message, const std::string& topic, cv::Size size) {
  const cv::Mat color = decodeImage(message, nullptr, true, topic);
  if (imageSize(message) != size) {
    throw InputError(InputFault::kDifferentSizes,
                     topic + " has " + sizeText(imageSize(message)) + ", expected " +
                         sizeText(size) +
                         ", the size of the rectified pair. Use the color image of the same camera "
                         "and resolution");
  }
  return toColor8(color).clone();
}

cv::Mat toCloudColor(const sensor_msgs::ImageConstPtr& image, const std::string& topic,
                     const cv::Mat& left_gray,
                     const std::function<void(const std::string&)>& report) {
  if (image) {
    try {
      return toColor(*image, topic, left_gray.size());
    } catch (const InputError& error) {
      if (report) {
        report(error.what());
      }
    }
  }
  return toColor8(left_gray);
}

cv::Mat toFloats(const sensor_msgs::Image& message, const std::string& topic) {
  if (message.encoding != encodings::TYPE_32FC1) {
    throw InputError(
        InputFault::kUnsupportedEncoding,
        topic + " has the encoding " + quoted(message.encoding) +
            ", expected 32FC1. Remap the input to a topic of disparities or of depth in meters");
  }
  checkImage(message, topic);
  if (message.is_bigendian != 0) {
    return cv_bridge::toCvShare(toLittleEndian(message), message.encoding)->image.clone();
  }
  return cv_bridge::toCvShare(message, nullptr)->image;
}

cv::Mat fromFloatImage(const sensor_msgs::Image& message) {
  return cv_bridge::toCvCopy(message, encodings::TYPE_32FC1)->image;
}

sensor_msgs::Image toMessage(const cv::Mat& image, const std::string& encoding,
                             const std_msgs::Header& header) {
  sensor_msgs::Image message;
  cv_bridge::CvImage(header, encoding, image).toImageMsg(message);
  return message;
}

}  // namespace cbmv
