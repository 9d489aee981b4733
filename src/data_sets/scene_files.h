#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "data_sets/stereo_scene.h"

namespace cbmv {

/// Throws Error with `file`, the source of the calibration, when there are more disparities than
/// columns.
void requireDisparitiesFit(const std::string& file, const StereoCalibration& calibration);

/// Reads both images into `scene`.
void readPair(const std::filesystem::path& left_file, const std::filesystem::path& right_file,
              StereoScene& scene);

/// Reads disparities (disparity_file.h). Throws Error when their size differs from the left image.
cv::Mat readMatchingDisparity(const std::filesystem::path& file, double divisor,
                              const std::filesystem::path& left_file, const cv::Mat& left);

/// Calibration for a data set without calibration files: only the size and the number of
/// disparities, which is limited to the width.
StereoCalibration searchRange(const cv::Size& size, int disparities);

/// Names of the entries of `folder` whose path passes `accept`, sorted. Throws Error when `folder`
/// is not a folder.
std::vector<std::string> listEntries(
    const std::filesystem::path& folder,
    const std::function<bool(const std::filesystem::path&)>& accept);

}  // namespace cbmv
