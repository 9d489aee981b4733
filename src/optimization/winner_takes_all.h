#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/per_thread.h"
#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Finds the disparity of lowest cost for every pixel among the hypotheses whose match is inside of
/// the other image. The smallest disparity wins ties. `disparity` becomes CV_32FC1 with whole
/// pixels. It is range.invalid() where all matches are outside. Parallel over rows by oneTBB.
void winnerTakesAll(const AggregatedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity);

/// The margin of pixels without a hypothesis to compare with the winner.
constexpr std::uint16_t kNoMargin = 0xffff;

/// Computes the margin of the winner of each pixel: the lowest cost among disparities that differ
/// by more than 1 from the winner, minus the cost of the winner, in the unit of the costs. Only
/// hypotheses whose match is inside of the right image count. `winners` is from winnerTakesAll for
/// the left view. `margin` becomes CV_16UC1. It is kNoMargin where there is no winner or no
/// hypothesis to compare. A cost of 65535 counts as no hypothesis; it is above all costs from CBCA
/// and SGM. Parallel over rows by oneTBB.
void winnerMargins(const AggregatedVolume& costs, const DisparityRange& range,
                   const cv::Mat& winners, cv::Mat& margin);

/// Memory for the winners of a row of the right image, from right to left.
struct RightWinnersRow {
  std::vector<std::uint16_t> lowest;  ///< costs
  std::vector<std::uint16_t> winners;
};

/// Winner-takes-all for the right image, from the costs of the left view. The winner of (x, y) is
/// the smallest d that minimizes left_costs(x + d, y, d). With the matching cost volume, the result
/// equals that of the right view. Aggregated costs differ slightly between the views.
void rightWinners(const AggregatedVolume& left_costs, const DisparityRange& range,
                  PerThread<RightWinnersRow>& scratch, cv::Mat& right_disparity);

}  // namespace cbmv
