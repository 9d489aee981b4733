#pragma once

#include <opencv2/core.hpp>

#include "data_sets/stereo_scene.h"
#include "evaluation/rendered_scene.h"

namespace cbmv {

inline StereoScene makeScene(int seed, const cv::Size& size = {64, 32}, int disparities = 20) {
  const RenderedScene rendered = renderScene(size.width, size.height, seed);
  StereoScene scene;
  scene.name = "Scene";
  scene.left = rendered.left;
  scene.right = rendered.right;
  scene.truth = rendered.truth;
  scene.visible = rendered.visible;
  scene.calibration.width = size.width;
  scene.calibration.height = size.height;
  scene.calibration.disparities = disparities;
  return scene;
}

inline bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::countNonZero(a != b) == 0;
}

}  // namespace cbmv
