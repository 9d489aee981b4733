#include "cbmv_stereo/gray_pair.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace cbmv {
namespace {

constexpr double kOutlierShare =
    0.001;  // keeps hot pixels and lamps from compressing the other levels
constexpr int kLevels8 = 256;
constexpr int kLevels16 = 1 << 16;

/// Linear map from 16 bits to 8 bits.
struct Stretch {
  double scale;
  double shift;

  cv::Mat apply(const cv::Mat& image) const {
    cv::Mat stretched;
    image.convertTo(stretched, CV_8U, scale, shift);
    return stretched;
  }
};

using Histogram = std::vector<std::size_t>;

/// The level that a fraction `share` of all values does not exceed.
int quantile(const Histogram& counts, double share) {
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

bool fitsEightBits(const Histogram& counts) {
  for (std::size_t level = kLevels8; level < counts.size(); ++level) {
    if (counts[level] > 0) {
      return false;
    }
  }
  return true;
}

Stretch findStretch(const std::vector<cv::Mat>& images) {
  Histogram counts(kLevels16, 0);
  for (const cv::Mat& image : images) {
    const cv::Mat_<std::uint16_t> values = image.reshape(1);
    for (const std::uint16_t value : values) {
      ++counts[value];
    }
  }
  if (fitsEightBits(counts)) {
    return {1.0, 0.0};
  }
  const int black = quantile(counts, kOutlierShare);
  const int white = quantile(counts, 1 - kOutlierShare);
  const double scale = white > black ? (kLevels8 - 1.0) / (white - black) : 0.0;
  return {scale, -scale * black};
}

bool isDeep(const cv::Mat& image) { return image.depth() == CV_16U; }

}  // namespace

cv::Mat toGray(const cv::Mat& image) {
  CV_Assert(image.depth() == CV_8U || image.depth() == CV_16U);
  if (image.channels() == 1) {
    return image;
  }
  cv::Mat gray;
  cv::cvtColor(image, gray, image.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  return gray;
}

cv::Mat toColor(const cv::Mat& image) {
  if (image.channels() == 3) {
    return image;
  }
  cv::Mat color;
  cv::cvtColor(image, color, image.channels() == 4 ? cv::COLOR_BGRA2BGR : cv::COLOR_GRAY2BGR);
  return color;
}

GrayPair toGrayPair(const cv::Mat& left, const cv::Mat& right) {
  const GrayPair gray{toGray(left), toGray(right)};
  if (isDeep(gray.left) && isDeep(gray.right)) {
    const Stretch stretch = findStretch({gray.left, gray.right});
    return {stretch.apply(gray.left), stretch.apply(gray.right)};
  }
  const auto toEightBits = [](const cv::Mat& image) {
    return isDeep(image) ? findStretch({image}).apply(image) : image;
  };
  return {toEightBits(gray.left), toEightBits(gray.right)};
}

cv::Mat toColor8(const cv::Mat& image) {
  const cv::Mat color = toColor(image);
  return isDeep(color) ? findStretch({color}).apply(color) : color;
}

}  // namespace cbmv
