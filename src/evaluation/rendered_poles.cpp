#include "evaluation/rendered_poles.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace cbmv {
namespace {

constexpr int kRows = 480;
constexpr int kColumns = 640;
constexpr int kFirstColumn = 80;
constexpr int kPitchPx = 68;  ///< distance between poles

cv::Mat makeTexture(int columns, double mean, double contrast, cv::RNG& random) {
  cv::Mat noise(kRows, columns, CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(noise, noise, {}, 1.2);
  cv::Scalar average, deviation;
  cv::meanStdDev(noise, average, deviation);
  return (noise - average[0]) * (contrast / deviation[0]) + mean;
}

cv::Mat toImage(const cv::Mat& brightness, cv::RNG& random) {
  cv::Mat noise(brightness.size(), CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0, 2);
  cv::Mat image;
  cv::Mat(brightness + noise).convertTo(image, CV_8U);
  return image;
}

}  // namespace

const std::vector<int>& poleWidths() {
  static const std::vector<int> kWidths = {2, 3, 5, 8};
  return kWidths;
}

RenderedPoles renderPoles(int far_px, int near_px, int seed) {
  CV_Assert(1 <= far_px && far_px < near_px && near_px <= 60);
  cv::RNG random(static_cast<uint64_t>(seed) + 1);
  const cv::Mat background = makeTexture(kColumns + far_px, 120, 25, random);
  cv::Mat left = background.colRange(0, kColumns).clone();
  cv::Mat right = background.colRange(far_px, far_px + kColumns).clone();
  RenderedPoles poles{{}, {}, cv::Mat(kRows, kColumns, CV_8UC1, cv::Scalar(0)), near_px};
  int x = kFirstColumn;
  for (const double mean : {175.0, 65.0}) {
    for (const int width : poleWidths()) {
      const cv::Mat pole = makeTexture(width, mean, 15, random);
      pole.copyTo(left.colRange(x, x + width));
      pole.copyTo(right.colRange(x - near_px, x - near_px + width));
      poles.pole_width.colRange(x, x + width) = width;
      x += kPitchPx;
    }
  }
  poles.left = toImage(left, random);
  poles.right = toImage(right, random);
  return poles;
}

double poleRecall(const RenderedPoles& poles, int width_px, const cv::Mat& disparity) {
  const cv::Mat pole = poles.pole_width == width_px;
  const cv::Mat found = (cv::abs(disparity - poles.near_px) <= 1) & pole;
  return static_cast<double>(cv::countNonZero(found)) / cv::countNonZero(pole);
}

}  // namespace cbmv
