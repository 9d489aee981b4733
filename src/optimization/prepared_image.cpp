#include "optimization/prepared_image.h"

#include "optimization/grey_deviation.h"
#include "optimization/support_arms.h"

namespace cbmv {

void PreparedImage::prepare(const cv::Mat& image, const AggregationOptions& options) {
  gray = image;
  deviation = greyDeviation(image);
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
