#include "io/disparity_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "io/image_decoding.h"
#include "io/pfm.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kKittiFactor = 256.0;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Does not use OpenCV's conversions of colors and depths.
cv::Mat readIntegers(const std::string& path) {
  cv::Mat image = decodeImageFile(path, cv::IMREAD_UNCHANGED);
  if (image.empty() || (image.type() != CV_8UC1 && image.type() != CV_16UC1)) {
    throw Error("Cannot read " + path +
                ": it is not a disparity file, expected a .pfm file or a gray image with 8 or 16 "
                "bits. Convert it to PFM or PNG.");
  }
  return image;
}

}  // namespace

cv::Mat readDisparity(const std::string& path, double divisor) {
  const bool is_float = isPfmName(path);
  const cv::Mat values = is_float ? readPfm(path) : readIntegers(path);
  cv::Mat disparity;
  values.convertTo(disparity, CV_32F, 1.0 / divisor);
  for (auto value = disparity.begin<float>(); value != disparity.end<float>(); ++value) {
    if (!std::isfinite(*value) || (!is_float && *value == 0.0F)) {
      *value = kUnknown;
    }
  }
  return disparity;
}

cv::Mat toKittiDisparity(const cv::Mat& disparity) {
  cv::Mat image(disparity.size(), CV_16UC1);
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const double value = std::round(kKittiFactor * disparity.at<float>(y, x));
      image.at<std::uint16_t>(y, x) =
          std::isfinite(value) ? cv::saturate_cast<std::uint16_t>(std::max(value, 1.0)) : 0;
    }
  }
  return image;
}

}  // namespace cbmv
