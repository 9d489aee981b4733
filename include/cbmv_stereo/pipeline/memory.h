#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "cbmv_stereo/pipeline/options.h"

namespace cbmv {

/// Memory in MB (2^20 bytes) that a StereoMatcher holds for images of that size, its result
/// included; the images, the forest and the program itself are not. With W × H pixels, D
/// disparities and T threads, these are the bytes:
///
///   volumes   W H D (1 + 2 v)   the matching volume and v 16-bit ones: 2, or 1 if optimization has
///                               one step at most (cbca_iterations_before + sgm_iterations +
///                               cbca_iterations_after)
///   maps      about 145 W H     what the four matchers, the estimate of the vertical offset, the
///                               optimization, the refinement and the result hold of a pixel;
///                               fewer with parts of the method switched off
///   rows      T W (11 D + 130)  costs, terms and codes of the row that a thread works on, fewer
///                               with forests that ask for some of the matchers only
///   paths     4 W D             of semi-global matching
///   surfaces  about W H (D / 8) (1 + 2 v) + 30 W H, with surface_prior
///   sums      of one tile of cost aggregation for each thread
double requiredMemoryMb(const cv::Size& image_size, const StereoOptions& options);

/// One sentence if more than options.max_memory_mb is required, with both numbers and what would
/// help; empty if the memory suffices or is not bounded.
std::string memoryRefusal(const cv::Size& image_size, const StereoOptions& options);

}  // namespace cbmv
