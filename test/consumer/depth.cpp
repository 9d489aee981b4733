// Depth of a rectified pair in C++, without ROS: depth LEFT RIGHT FOREST CLOUD
#include <fstream>
#include <iostream>

#include <opencv2/imgcodecs.hpp>

#include <cbmv_stereo/forest.h>
#include <cbmv_stereo/gray_pair.h>
#include <cbmv_stereo/points.h>
#include <cbmv_stereo/stereo_matcher.h>

int main(int /*argc*/, char** argv) try {
  const cv::Mat left = cv::imread(argv[1]);
  const cbmv::GrayPair pair = cbmv::toGrayPair(left, cv::imread(argv[2]));

  cbmv::StereoOptions options;
  options.range.count = 64;
  cbmv::StereoMatcher matcher(cbmv::loadForest(argv[3]),
                              options);  // keep it, because it holds the buffers
  const cbmv::StereoResult result = matcher.match(pair.left, pair.right);

  cbmv::StereoGeometry camera;  // from a calibration: checkCalibration
  camera.focal_length_px = camera.left_fx_px = camera.left_fy_px = 500;
  camera.left_cx_px = 0.5 * left.cols;
  camera.left_cy_px = 0.5 * left.rows;
  camera.baseline_m = 0.12;
  const cv::Mat disparity = cbmv::toValidDisparity(result.disparity, result.range.invalid(), 0);
  std::ofstream cloud(argv[4]);
  for (const cbmv::ColoredPoint& point : cbmv::toPoints(disparity, left, camera)) {
    cloud << point.x << ' ' << point.y << ' ' << point.z << '\n';
  }
} catch (const cbmv::Error& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
