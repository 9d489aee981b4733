#include "optimization/prepared_image.h"

#include "optimization/support_arms.h"

namespace cbmv {

float grayDeviation(const cv::Mat& gray) {
  CV_Assert(gray.type() == CV_8UC1 && !gray.empty());
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(gray, mean, deviation);
  return static_cast<float>(deviation[0]);
}

void PreparedImage::prepare(const cv::Mat& image, const AggregationOptions& options) {
  gray = image;
  deviation = grayDeviation(image);
  if (options.iterations_before + options.iterations_after > 0) {
    computeSupportArms(image, options.arm_length_px, options.intensity_threshold * deviation, arms);
  }
}

SupportArms supportArmsOf(const PreparedImage& reference, const PreparedImage& other,
                          const AggregationOptions& options) {
  return {reference.arms, other.arms, options.arm_length_px - 1};
}

EdgeImages edgeImagesOf(const PreparedImage& reference, const PreparedImage& other,
                        const SgmOptions& options) {
  return {reference.gray, other.gray, options.edge_threshold * reference.deviation,
          options.edge_threshold * other.deviation};
}

}  // namespace cbmv
