#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Memory in MB (2^20 bytes) that a StereoMatcher holds for images of that size, its result
/// included; the images, the forest and the program itself are not. With W × H pixels, D
/// disparities and T threads, these are the bytes:
///
///   volumes   W H D (1 + 2 v)   the matching volume and v 16-bit ones: 2, or 1 if optimization has
///                               one step at most (cbca_iterations_before + sgm_iterations +
///                               cbca_iterations_after)
///   maps      about 147 W H     what the four matchers, the estimate of the vertical offset, the
///                               optimization, the refinement and the result hold of a pixel;
///                               fewer with parts of the method switched off
///   selection 35 W H + 70 T W   of the second forest, with second_forest, whether the file has one
///                               or not; 18 W H + 40 T W without replace_improbable
///   rows      T W (11 D + 130)  costs, terms and codes of the row that a thread works on, fewer
///                               with forests that ask for some of the matchers only
///   paths     4 W D             of semi-global matching
///   surfaces  about W H (D / 8) (1 + 2 v) + 30 W H, with surface_prior
///   sums      of one tile of cost aggregation for each thread
///
/// With a coarse-to-fine search it depends on the pair, and this is searchMemoryMb of what is
/// expected (expectedHypotheses).
double requiredMemoryMb(const cv::Size& image_size, const StereoOptions& options);

/// Disparities that a coarse-to-fine search is expected to list for a pixel, at every level but the
/// coarsest. Measured on 101 pairs (Middlebury v3, KITTI 2012, RealSense) with the default
/// neighborhood and margin: 8 to 26 at full size, 14 in the median; fewer at the levels below.
constexpr double kListedDisparities = 16;

/// Hypotheses that a coarse-to-fine search is expected to match at each level, the full size first:
/// all at the coarsest level, kListedDisparities a pixel at the others. More where the parameters
/// of the search make longer lists.
std::vector<double> expectedHypotheses(const cv::Size& image_size, const StereoOptions& options);

/// Memory in MB (2^20 bytes) of a coarse-to-fine search that matches so many hypotheses at each
/// level, the full size first. The volumes take 1 + 2 v bytes of each, as in requiredMemoryMb, and
/// 1 more if the right view is optimized; every level has the maps and rows of requiredMemoryMb.
double searchMemoryMb(const cv::Size& image_size, const StereoOptions& options,
                      const std::vector<double>& hypotheses);

/// One sentence if requiredMemoryMb is more than options.max_memory_mb, with both numbers and what
/// would help; empty if the memory suffices or is not bounded.
std::string memoryError(const cv::Size& image_size, const StereoOptions& options);

/// The same for the hypotheses of a pair, when its lists are known.
std::string searchMemoryError(const cv::Size& image_size, const StereoOptions& options,
                              const std::vector<double>& hypotheses);

}  // namespace cbmv
