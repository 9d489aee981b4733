#pragma once

#include <string>
#include <vector>

#include "data_sets/stereo_scene.h"

namespace cbmv {

/// Reads a folder in the layout of Middlebury v3: im0.png (left), im1.png (right), disp0GT.pfm,
/// mask0nocc.png and calib.txt. The data sets of 2014 as they are downloaded have disp0.pfm in
/// place of disp0GT.pfm, and no mask. Where the mask is absent, `visible` is visibleInBoth(truth).
/// `default_disparities` is readMiddleburyCalibration's; `truth_required` false: a scene without
/// disp0GT.pfm or disp0.pfm has neither truth nor mask.
/// Throws Error naming the file that is missing or malformed, both files and sizes when sizes
/// disagree, or calib.txt when it has more disparities than the image has columns.
StereoScene readMiddleburyScene(const std::string& folder, int default_disparities = 0,
                                bool truth_required = true);

/// Names of the subfolders of `folder` that hold im0.png and calib.txt, sorted.
/// Throws Error when `folder` is not a folder.
std::vector<std::string> listMiddleburyScenes(const std::string& folder);

}  // namespace cbmv
