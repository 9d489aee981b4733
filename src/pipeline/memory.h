#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Memory in MB (2^20 bytes) of a StereoMatcher for images of this size. It includes the result,
/// but not the images, the forest or the program. With W × H pixels, D disparities and T threads,
/// the bytes are:
///
///   volumes   W H D (1 + 2 v)   the matching cost volume and v aggregated cost volumes (16 bits):
///                               v = 2, or v = 1 with at most one step (cbca_iterations_before +
///                               sgm_iterations + cbca_iterations_after)
///   maps      about 147 W H     memory per pixel of the four matchers, the estimate of the
///                               residual vertical offset, cost aggregation, SGM, refinement and
///                               the result; less if parts of the method are disabled
///   selection 35 W H + 70 T W   with second_forest, whether or not the file has a second forest;
///                               18 W H + 40 T W without replace_improbable
///   rows      T W (11 D + 200)  costs, terms and codes of the row of a thread; less with forests
///                               that use only some of the matchers
///   paths     4 W D             of SGM
///   surfaces  about W H (D / 8) (1 + 2 v) + 30 W H, with surface_prior
///   sums      one tile of cost aggregation per thread
///
/// For a coarse-to-fine search, the memory depends on the pair. Then the result is searchMemoryMb
/// of the expected hypotheses (expectedHypotheses).
double requiredMemoryMb(const cv::Size& image_size, const StereoOptions& options);

/// Expected number of disparities per pixel in a coarse-to-fine search, at every level except the
/// coarsest. Measured on 101 pairs (Middlebury v3, KITTI 2012, RealSense) with the default
/// neighborhood and margin: 8 to 26 at full size, median 14; fewer at the coarser levels.
constexpr double kListedDisparities = 16;

/// Expected number of hypotheses of a coarse-to-fine search at each level, full size first: all
/// hypotheses at the coarsest level, kListedDisparities per pixel at the others. More if the search
/// parameters make longer lists.
std::vector<double> expectedHypotheses(const cv::Size& image_size, const StereoOptions& options);

/// Memory in MB (2^20 bytes) of a coarse-to-fine search with this number of hypotheses per level,
/// full size first. The volumes take 1 + 2 v bytes per hypothesis, as in requiredMemoryMb, and 1
/// more if SGM runs on the right view. Every level has the maps and rows of requiredMemoryMb.
double searchMemoryMb(const cv::Size& image_size, const StereoOptions& options,
                      const std::vector<double>& hypotheses);

/// Returns one message, with both numbers and what to do, if requiredMemoryMb exceeds
/// options.max_memory_mb. Empty if it does not, or if there is no limit.
std::string memoryError(const cv::Size& image_size, const StereoOptions& options);

/// The same for the hypotheses of a pair, when its lists are known.
std::string searchMemoryError(const cv::Size& image_size, const StereoOptions& options,
                              const std::vector<double>& hypotheses);

}  // namespace cbmv
