#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "rectification/offset_fit.h"

namespace cbmv {

/// Throws Error unless the images have one size and are CV_8UC1.
void requireGreyPair(const cv::Mat& left, const cv::Mat& right);

/// Matches of corners that are spread over the left image; most of them right, some wrong.
std::vector<SparseMatch> findSparseMatches(const cv::Mat& left, const cv::Mat& right,
                                           const DisparityRange& range,
                                           const RectificationOptions& options);

}  // namespace cbmv
