#include "cbmv_stereo/optimization/prepared_image.h"

#include "cbmv_stereo/optimization/grey_deviation.h"
#include "cbmv_stereo/optimization/support_arms.h"

namespace cbmv {

void PreparedImage::prepare(const cv::Mat& image, const AggregationOptions& options) {
  gray = image;
  deviation = greyDeviation(image);
  if (options.iterations_before + options.iterations_after > 0) {
    computeSupportArms(image, options.arm_length_px, options.intensity_threshold * deviation, arms);
  }
}

}  // namespace cbmv
