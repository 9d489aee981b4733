#include "ros/image_conversion.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <limits>
#include <vector>

#include <boost/make_shared.hpp>
#include <cv_bridge/cv_bridge.h>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

namespace cbmv {
namespace {

namespace encodings = sensor_msgs::image_encodings;

std::size_t bytesPerPixel(const sensor_msgs::Image& message, const std::string& topic) {
  try {
    return static_cast<std::size_t>(encodings::bitDepth(message.encoding)) / 8 *
           static_cast<std::size_t>(encodings::numChannels(message.encoding));
  } catch (const std::runtime_error&) {
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " has the encoding " + quoted(message.encoding) +
                         ", which is unknown; mono8 or a colour encoding would be right");
  }
}

void checkImage(const sensor_msgs::Image& message, const std::string& topic) {
  if (message.width == 0 || message.height == 0) {
    throw InputError(InputFault::kEmptyImage,
                     topic + " is an empty image (" + sizeText(imageSize(message)) + ")");
  }
  const std::size_t row_bytes = bytesPerPixel(message, topic) * message.width;
  if (message.step < row_bytes) {
    throw InputError(InputFault::kTruncatedImage,
                     topic + " has a step of " + std::to_string(message.step) +
                         " bytes, a row of " + std::to_string(message.width) + " px " +
                         quoted(message.encoding) + " needs " + std::to_string(row_bytes));
  }
  const std::size_t image_bytes = static_cast<std::size_t>(message.step) * message.height;
  if (message.data.size() != image_bytes) {
    throw InputError(InputFault::kTruncatedImage, topic + " holds " +
                                                      std::to_string(message.data.size()) +
                                                      " bytes, " + std::to_string(message.height) +
                                                      " rows of " + std::to_string(message.step) +
                                                      " bytes are " + std::to_string(image_bytes));
  }
}

/// The message with its bytes the other way round; cv_bridge gets other types of it. It has to be
/// checked (checkImage).
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

bool isPlainGrey(const std::string& encoding) {
  return encoding == encodings::TYPE_8UC1 || encoding == encodings::TYPE_16UC1;
}

/// The pixels as grey or as blue, green, red, with the 8 or 16 bits that they have. Exceptions of
/// cv_bridge are made InputError. `owner` keeps memory that is shared.
cv::Mat decode(const sensor_msgs::Image& message, const boost::shared_ptr<const void>& owner,
               bool color, const std::string& topic) {
  checkImage(message, topic);
  const bool deep = encodings::bitDepth(message.encoding) == 16;
  if (message.is_bigendian != 0 && deep) {
    const auto swapped = toLittleEndian(message);
    return decode(*swapped, swapped, color, topic).clone();
  }
  const std::string encoding = color ? (deep ? encodings::BGR16 : encodings::BGR8)
                                     : (deep ? encodings::MONO16 : encodings::MONO8);
  try {
    if (isPlainGrey(message.encoding)) {  // cv_bridge takes them for no image of light
      const cv::Mat grey = cv_bridge::toCvShare(message, owner)->image;
      cv::Mat bgr;
      if (color) {
        cv::cvtColor(grey, bgr, cv::COLOR_GRAY2BGR);
      }
      return color ? bgr : grey;
    }
    return cv_bridge::toCvShare(message, owner, encoding)->image;
  } catch (const std::exception& error) {  // cv_bridge's own and OpenCV's
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " has the encoding " + quoted(message.encoding) +
                         ", which cannot be converted to " + encoding + ": " + error.what());
  }
}

/// Linear map from 16 bits to 8.
struct Stretch {
  double scale;
  double shift;

  cv::Mat apply(const cv::Mat& image) const {
    cv::Mat stretched;
    image.convertTo(stretched, CV_8U, scale, shift);
    return stretched;
  }
};

/// The level that `share` of all values in `counts` do not exceed.
int quantile(const std::vector<std::size_t>& counts, double share) {
  std::size_t all = 0;
  for (const std::size_t count : counts) {
    all += count;
  }
  std::size_t below = 0;
  std::size_t level = 0;
  while (level + 1 < counts.size() &&
         static_cast<double>(below += counts[level]) <= share * static_cast<double>(all)) {
    ++level;
  }
  return static_cast<int>(level);
}

/// Outliers (hot pixels, lamps) must not take the levels of the rest.
Stretch findStretch(const std::vector<cv::Mat>& images) {
  const double outlier_share = 0.001;
  std::vector<std::size_t> counts(1 << 16, 0);
  for (const cv::Mat& image : images) {
    const cv::Mat_<std::uint16_t> values = image.reshape(1);
    for (const std::uint16_t value : values) {
      ++counts[value];
    }
  }
  const int black = quantile(counts, outlier_share);
  const int white = quantile(counts, 1 - outlier_share);
  const double scale = white > black ? 255.0 / (white - black) : 0.0;
  return {scale, -scale * black};
}

bool isDeep(const cv::Mat& image) { return image.depth() == CV_16U; }

GreyPair toEightBits(const cv::Mat& left, const cv::Mat& right) {
  if (isDeep(left) && isDeep(right)) {
    const Stretch stretch = findStretch({left, right});
    return {stretch.apply(left), stretch.apply(right)};
  }
  return {isDeep(left) ? findStretch({left}).apply(left) : left,
          isDeep(right) ? findStretch({right}).apply(right) : right};
}

void checkFrameIds(const StereoMessages& messages, const std::string& both) {
  const std::string& left = messages.left_image->header.frame_id;
  const std::string& right = messages.right_image->header.frame_id;
  if (left != right) {
    throw InputError(InputFault::kDifferentFrameIds,
                     both + " differ in frame_id (" + quoted(left) + " and " + quoted(right) +
                         "); equal ones would be right, or true for the parameter "
                         "allow_different_frame_ids");
  }
}

}  // namespace

std::string sizeText(cv::Size size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height) + " px";
}

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

GreyPair toGreyPair(const StereoMessages& messages, const StereoTopics& topics,
                    bool allow_different_frame_ids) {
  const sensor_msgs::Image& left = *messages.left_image;
  const sensor_msgs::Image& right = *messages.right_image;
  const cv::Mat left_grey = decode(left, messages.left_image, false, topics.left_image);
  const cv::Mat right_grey = decode(right, messages.right_image, false, topics.right_image);
  const std::string both = topics.left_image + " and " + topics.right_image;
  if (imageSize(left) != imageSize(right)) {
    throw InputError(InputFault::kDifferentSizes,
                     both + " differ in size (" + sizeText(imageSize(left)) + " and " +
                         sizeText(imageSize(right)) + "); a rectified pair has one size");
  }
  if (!allow_different_frame_ids) {
    checkFrameIds(messages, both);
  }
  return toEightBits(left_grey, right_grey);
}

cv::Mat toColor(const sensor_msgs::Image& message, const std::string& topic, cv::Size size) {
  const cv::Mat color = decode(message, nullptr, true, topic);
  if (imageSize(message) != size) {
    throw InputError(InputFault::kDifferentSizes, topic + " has " + sizeText(imageSize(message)) +
                                                      ", the rectified pair " + sizeText(size) +
                                                      "; they have to be the same");
  }
  return isDeep(color) ? findStretch({color}).apply(color) : color.clone();
}

cv::Mat toFloats(const sensor_msgs::Image& message, const std::string& topic) {
  if (message.encoding != encodings::TYPE_32FC1) {
    throw InputError(
        InputFault::kUnsupportedEncoding,
        topic + " has the encoding " + quoted(message.encoding) + "; 32FC1 would be right");
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
