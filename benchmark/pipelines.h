#pragma once

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "problem.h"

#include "cbmv_stereo/stereo_result.h"

namespace cbmv::benchmarks {

/// A whole method: a pair in, a disparity map out.
using Method = std::function<cv::Mat(const Pair&)>;

/// CBMV with the forest of a preset; the times of its stages are those of the last frame. The
/// vertical offset of the pair is estimated beforehand: on a stream, that happens beside the
/// frames.
Method makeCbmv(const StereoOptions& options, const std::string& preset, const Problem& problem,
                StageTimes& times);

/// OpenCV's matchers: bm, sgbm, sgbm_3way, hh.
const std::vector<std::string>& openCvMethods();

/// One of them, over the problem's disparities rounded up to a multiple of 16, as OpenCV wants
/// them: StereoBM with its defaults, the others as evaluation/opencv_baseline.h has them.
Method makeOpenCv(const std::string& name, const Problem& problem);

/// Largest resident memory of this process so far, in MiB.
double peakMemoryMib();

}  // namespace cbmv::benchmarks
