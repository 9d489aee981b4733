#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/per_thread.h"
#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Cheapest disparity of every pixel among the hypotheses whose match lies inside of the other
/// image; the smallest such disparity on ties. `disparity` becomes CV_32FC1 of whole pixels;
/// range.invalid() where no hypothesis has its match inside. Parallel over rows by oneTBB.
void winnerTakesAll(const OptimizedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity);

/// The margin of pixels that have no hypothesis to compare the winner with.
constexpr std::uint16_t kNoMargin = 0xffff;

/// By how much the winner of each pixel beats the disparities that differ from it by more than 1:
/// the lowest of their costs minus its own, in the unit of the costs, among the hypotheses whose
/// match lies inside of the right image. `winners` are those of winnerTakesAll for the left view.
/// `margin` becomes CV_16UC1; kNoMargin where there is no winner or nothing to compare it with. A
/// cost of 65535 counts as none, which is above all that the optimization gives. Parallel over rows
/// by oneTBB.
void winnerMargins(const OptimizedVolume& costs, const DisparityRange& range,
                   const cv::Mat& winners, cv::Mat& margin);

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
