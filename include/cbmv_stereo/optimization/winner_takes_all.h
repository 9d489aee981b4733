#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/volume/disparity_range.h"
#include "cbmv_stereo/volume/per_thread.h"
#include "cbmv_stereo/volume/volume.h"

namespace cbmv {

/// Cheapest disparity of every pixel among the hypotheses whose match lies inside of the other
/// image; the smallest such disparity on ties. `disparity` becomes CV_32FC1 of whole pixels;
/// range.invalid() where no hypothesis has its match inside. Parallel over rows by oneTBB.
void winnerTakesAll(const OptimizedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity);

/// Memory for the winners of a row of the right image, from right to left.
struct RowAcross {
  std::vector<std::uint16_t> lowest;  ///< costs
  std::vector<std::uint16_t> winners;
};

/// The same for the pixels of the right image, from the costs of the left view: the winner of
/// (x, y) is the smallest d that minimizes left_costs(x + d, y, d). With the matching volume this
/// would be the right view's own; optimized costs differ a little between the views.
void winnerTakesAllAcross(const OptimizedVolume& left_costs, const DisparityRange& range,
                          PerThread<RowAcross>& scratch, cv::Mat& right_disparity);

}  // namespace cbmv
