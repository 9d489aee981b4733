#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/evaluation/rendered_scene.h"
#include "cbmv_stereo/io/stereo_scene.h"

namespace cbmv {

inline StereoScene makeScene(int seed) {
  const RenderedScene rendered = renderScene(64, 32, seed);
  StereoScene scene;
  scene.name = "Scene";
  scene.left = rendered.left;
  scene.right = rendered.right;
  scene.truth = rendered.truth;
  scene.visible = rendered.visible;
  scene.calibration.width = 64;
  scene.calibration.height = 32;
  scene.calibration.disparities = 20;
  return scene;
}

inline bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::countNonZero(a != b) == 0;
}

}  // namespace cbmv
