#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "data_sets/stereo_scene.h"

namespace cbmv {

/// Throws Error naming `file`, which gives the number of disparities, when there are more than
/// columns.
void requireDisparitiesFit(const std::string& file, const StereoCalibration& calibration);

/// Reads both images into the scene.
void readPair(const std::filesystem::path& left_file, const std::filesystem::path& right_file,
              StereoScene& scene);

/// Reads disparities (disparity_file.h) that must have the size of the left image.
cv::Mat readMatchingDisparity(const std::filesystem::path& file, double divisor,
                              const std::filesystem::path& left_file, const cv::Mat& left);

/// Of a data set without calibration files: the size, and so many disparities, at most the width.
StereoCalibration searchRange(const cv::Size& size, int disparities);

/// Names of the entries of `folder` whose path `accept` takes, sorted. Throws Error when `folder`
/// is not a folder.
std::vector<std::string> listEntries(
    const std::filesystem::path& folder,
    const std::function<bool(const std::filesystem::path&)>& accept);

}  // namespace cbmv
