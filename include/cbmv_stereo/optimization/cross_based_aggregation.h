#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/volume/disparity_range.h"
#include "cbmv_stereo/volume/volume.h"

namespace cbmv {

/// One iteration of cross-based cost aggregation (Žbontar & LeCun 2016, section 4.1): every cost is
/// replaced by the mean, rounded to the nearest integer (halves up), over the combined support
/// region of its two pixels.
///
/// The combined arm of hypothesis (x, y, d) is, in each of the four directions, the shorter of the
/// arm at (x, y) in the reference image and the arm at (matchingColumn(view, x, d), y) in the other
/// one. The region is the union of the combined horizontal arms of all pixels on the combined
/// vertical arm. Hypotheses whose match lies outside of the other image are copied; a region never
/// reaches such a hypothesis.
///
/// `costs` and `aggregated` are different volumes; `aggregated` is resized. Arms are CV_8UC4 from
/// computeSupportArms, `reference_arms` of the image that `view` names. No cost is above
/// `max_cost`, which is at most 16383; the lower it is and the shorter the arms, the faster the
/// sums (16-bit ones up to arms of 5 pixels and costs of 10922). Vectors by Highway, parallel by
/// oneTBB; the result depends neither on the instruction set nor on the number of threads.
void aggregateCosts(const OptimizedVolume& costs, int max_cost, const cv::Mat& reference_arms,
                    const cv::Mat& other_arms, View view, const DisparityRange& range,
                    OptimizedVolume& aggregated);

/// The same on matching costs as they come.
void aggregateCosts(const MatchingVolume& costs, int max_cost, const cv::Mat& reference_arms,
                    const cv::Mat& other_arms, View view, const DisparityRange& range,
                    OptimizedVolume& aggregated);

}  // namespace cbmv
