#pragma once

#include <string>
#include <vector>

#include "data_sets/stereo_scene.h"

namespace cbmv {

/// Reads a folder in Middlebury v3 layout: im0.png (left), im1.png (right), disp0GT.pfm,
/// mask0nocc.png and calib.txt. The 2014 data sets as downloaded have disp0.pfm instead of
/// disp0GT.pfm and no mask. Without a mask, `visible` is visibleInBoth(truth).
/// `default_disparities`: see readMiddleburyCalibration. With `truth_required` false, a scene
/// without disp0GT.pfm and disp0.pfm is read without truth and mask.
/// Throws Error with the file that is missing or malformed, with both files and sizes when sizes
/// differ, or with calib.txt when it has more disparities than the image has columns.
StereoScene readMiddleburyScene(const std::string& folder, int default_disparities = 0,
                                bool truth_required = true);

/// Names of the subfolders of `folder` that hold im0.png and calib.txt, sorted. Throws Error when
/// `folder` is not a folder.
std::vector<std::string> listMiddleburyScenes(const std::string& folder);

}  // namespace cbmv
