#pragma once

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "problem.h"

#include "cbmv_stereo/stereo_result.h"

namespace cbmv::benchmarks {

/// A complete method: takes a pair, returns a disparity map.
using Method = std::function<cv::Mat(const Pair&)>;

/// CBMV with the forest of a preset. `times` receives the stage times of the last frame. The
/// vertical offset of the pair is estimated beforehand, because with a live stream this runs in
/// parallel to the frames.
Method makeCbmv(const StereoOptions& options, const std::string& preset, const Problem& problem,
                StageTimes& times);

/// OpenCV's matchers: bm, sgbm, sgbm_3way, hh.
const std::vector<std::string>& openCvMethods();

/// One of openCvMethods, over the problem's number of disparities rounded up to a multiple of 16,
/// which OpenCV requires. StereoBM has its defaults; the others use the settings of
/// evaluation/opencv_baseline.h.
Method makeOpenCv(const std::string& name, const Problem& problem);

/// Peak resident memory of this process, MiB.
double peakMemoryMib();

}  // namespace cbmv::benchmarks
