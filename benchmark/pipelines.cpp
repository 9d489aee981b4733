#include "pipelines.h"

#include <fstream>
#include <memory>

#include <opencv2/calib3d.hpp>

#include "evaluation/opencv_baseline.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv::benchmarks {
namespace {

cv::Ptr<cv::StereoMatcher> createOpenCv(const std::string& name, int disparities) {
  if (name == "bm") {
    return cv::StereoBM::create(openCvDisparities(disparities));
  }
  if (name == "sgbm") {
    return makeStereoSgbm(disparities, cv::StereoSGBM::MODE_SGBM);
  }
  if (name == "sgbm_3way") {
    return makeStereoSgbm(disparities, cv::StereoSGBM::MODE_SGBM_3WAY);
  }
  if (name == "hh") {
    return makeStereoSgbm(disparities, cv::StereoSGBM::MODE_HH);
  }
  throw Error("OpenCV has no matcher " + name);
}

}  // namespace

Method makeCbmv(const StereoOptions& options, const std::string& preset, const Problem& problem,
                StageTimes& times) {
  const Pair sample = loadPair(problem);
  const VerticalOffset offset =
      estimateVerticalOffset(sample.left, sample.right, options.range, options.rectification);
  const auto matcher = std::make_shared<StereoMatcher>(presetForest(preset), options);
  return [matcher, offset, &times](const Pair& pair) {
    const StereoResult result = matcher->match(pair.left, pair.right, offset);
    times = result.times;
    return result.disparity;
  };
}

const std::vector<std::string>& openCvMethods() {
  static const std::vector<std::string> kMethods = {"bm", "sgbm", "sgbm_3way", "hh"};
  return kMethods;
}

Method makeOpenCv(const std::string& name, const Problem& problem) {
  const auto matcher = createOpenCv(name, problem.disparities);
  return [matcher](const Pair& pair) {
    cv::Mat disparity;
    matcher->compute(pair.left, pair.right, disparity);
    return disparity;
  };
}

double peakMemoryMib() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    if (word == "VmHWM:") {
      double kib = 0;
      status >> kib;
      return kib / 1024;
    }
  }
  throw Error("/proc/self/status does not tell the peak memory (VmHWM)");
}

}  // namespace cbmv::benchmarks
