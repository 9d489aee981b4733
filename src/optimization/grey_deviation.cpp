#include "optimization/grey_deviation.h"

namespace cbmv {

float greyDeviation(const cv::Mat& grey) {
  CV_Assert(grey.type() == CV_8UC1 && !grey.empty());
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(grey, mean, deviation);
  return static_cast<float>(deviation[0]);
}

}  // namespace cbmv
