#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "data_sets/stereo_scene.h"
#include "evaluation/scene_score.h"

namespace cbmv {

/// |d − truth| as a BGR picture in OpenCV's colour map TURBO: 0 blue, 4 px and more, or no
/// disparity, red; black where the truth is unknown; half as bright where the right camera does not
/// see the point. Both maps have the size of the scene.
cv::Mat errorPicture(const StereoScene& scene, const cv::Mat& disparity);

/// Writes SCENE_left.jpg, SCENE_disparity.jpg and, where they are known, SCENE_truth.jpg and
/// SCENE_error.jpg, and SCENE_confidence.jpg. Disparities are coloured from 0 to the highest true
/// one, or over the scene's range where none is known. Throws Error naming the file that cannot be
/// written.
void writePictures(const std::string& folder, const StereoScene& scene, const SceneMaps& maps);

}  // namespace cbmv
