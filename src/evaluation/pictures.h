#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "data_sets/stereo_scene.h"
#include "evaluation/scene_score.h"

namespace cbmv {

/// |d − truth| as a BGR image in OpenCV's color map TURBO. Blue: 0. Red: 4 px or more, or no
/// disparity. Black: unknown truth. Half brightness: not visible in the right image. Both maps have
/// the size of the scene.
cv::Mat errorPicture(const StereoScene& scene, const cv::Mat& disparity);

/// Writes SCENE_left.jpg and SCENE_disparity.jpg and, if known, SCENE_truth.jpg, SCENE_error.jpg
/// and SCENE_confidence.jpg. The color scale of disparities starts at 0 and ends at the highest
/// true disparity, or at the end of the scene's range if no truth is known. Throws Error with the
/// file that cannot be written.
void writePictures(const std::string& folder, const StereoScene& scene, const SceneMaps& maps);

}  // namespace cbmv
