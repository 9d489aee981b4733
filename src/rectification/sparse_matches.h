#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "rectification/offset_fit.h"

namespace cbmv {

/// Memory of the measurement of the vertical offset (both images, their halves and OpenCV's
/// corners).
constexpr double kMeasurementBytesPerPixel = 30;

/// Throws Error unless both images have the same size and are CV_8UC1.
void requireGrayPair(const cv::Mat& left, const cv::Mat& right);

/// Matches corners that are spread over the left image. Most matches are right, some are wrong.
std::vector<SparseMatch> findSparseMatches(const cv::Mat& left, const cv::Mat& right,
                                           const DisparityRange& range,
                                           const RectificationOptions& options);

}  // namespace cbmv
