#include "matching/padded_image.h"

#include <opencv2/core.hpp>

namespace cbmv {

void padImage(const cv::Mat& image, cv::Mat& padded) {
  cv::copyMakeBorder(image, padded, kMatchingBorderPx, kMatchingBorderPx, kMatchingBorderPx,
                     kMatchingBorderPx, cv::BORDER_REPLICATE);
}

}  // namespace cbmv
