#include "refinement/disparity_refiner.h"

#include <cstdint>

#include <tbb/parallel_for.h>

#include "refinement/bilateral_filter.h"
#include "refinement/interpolation.h"
#include "refinement/left_border.h"
#include "refinement/left_right_check.h"
#include "refinement/median_filter.h"

namespace cbmv {
namespace {

/// Invalidates the pixels that failed the check and halves their confidence.
void markUnmatched(const RefinedMaps& maps, float invalid) {
  tbb::parallel_for(0, maps.labels.rows, [&](int y) {
    const auto* labels = maps.labels.ptr<std::uint8_t>(y);
    auto* disparity = maps.disparity.ptr<float>(y);
    auto* confidence = maps.confidence.ptr<float>(y);
    for (int x = firstUnmatched(labels, 0, maps.labels.cols); x < maps.labels.cols;
         x = firstUnmatched(labels, x + 1, maps.labels.cols)) {
      disparity[x] = invalid;
      confidence[x] *= 0.5F;
    }
  });
}

}  // namespace

void DisparityRefiner::refine(const cv::Mat& winners, const DisparityRange& range,
                              const RefinementOptions& options, const RefinedMaps& maps) {
  if (options.left_right_check) {
    leftRightCheck(winners, maps.right_disparity, range, options.max_left_right_difference_px,
                   maps.labels);
    occludeLeftBorder(winners, maps.right_disparity, range, maps.labels);
    replaceUnmatched(range, options, maps);
  } else {
    maps.right_disparity.release();
    maps.labels.create(winners.size(), CV_8UC1);
    maps.labels.setTo(kMatch);
  }
  medianFilter(maps.disparity, range, options.median_size_px, median_padded_, filtered_);
  bilateralFilter(filtered_, range, options.bilateral_sigma_px, options.bilateral_threshold_px,
                  bilateral_padded_, maps.disparity);
}

void DisparityRefiner::replaceUnmatched(const DisparityRange& range,
                                        const RefinementOptions& options, const RefinedMaps& maps) {
  markUnmatched(maps, range.invalid());
  if (options.fill_occlusions) {
    fillOcclusions(maps.labels, range, maps.disparity);
  }
  if (options.fill_mismatches) {
    maps.disparity.copyTo(filtered_);
    fillMismatches(maps.labels, range, filtered_, maps.disparity);
  }
}

}  // namespace cbmv
