#pragma once

#include <cstdint>
#include <random>

#include <opencv2/core.hpp>

#include "optimization/winner_takes_all.h"
#include "selection/map_planes.h"
#include "support/random_images.h"

namespace cbmv::test {

/// Random maps in place of the output of a first forest.
struct RandomMaps {
  cv::Mat disparity;
  cv::Mat right_disparity;
  cv::Mat labels;
  cv::Mat probability;
  cv::Mat margin;
  DisparityRange range;

  JudgedMaps judged() const {
    return {disparity, right_disparity, labels, probability, margin, range};
  }
};

/// Shifts valid disparities by up to half a pixel in steps of 1/16 px. Every second one is halfway
/// between two values of a plane.
inline void addFractions(float invalid, std::mt19937& random, cv::Mat& disparity) {
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      float& value = disparity.at<float>(y, x);
      if (value != invalid) {
        value += static_cast<float>(static_cast<int>(random() % 17) - 8) / 16.0F;
      }
    }
  }
}

inline RandomMaps makeJudgedMaps(const Shape& shape, Content content, std::uint32_t seed) {
  std::mt19937 random(seed);
  RandomMaps maps;
  maps.range = shape.range;
  maps.disparity = makeDisparity(shape, content, 12, seed);
  addFractions(shape.range.invalid(), random, maps.disparity);
  maps.right_disparity = makeDisparity(shape, content, 5, seed + 1);
  addFractions(shape.range.invalid(), random, maps.right_disparity);
  maps.labels = cv::Mat(shape.size(), CV_8UC1);
  maps.probability = cv::Mat(shape.size(), CV_32FC1);
  maps.margin = cv::Mat(shape.size(), CV_16UC1);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const auto halved = random() % 2 == 0 ? 0.5F : 1.0F;
      maps.labels.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random() % 3);
      maps.probability.at<float>(y, x) = halved * static_cast<float>(random() % 256) / 255.0F;
      maps.margin.at<std::uint16_t>(y, x) =
          random() % 6 == 0 ? kNoMargin : static_cast<std::uint16_t>(random() % 2300);
    }
  }
  return maps;
}

/// Confidences in patches above and below the limit of confident pixels.
inline cv::Mat makeConfidence(const cv::Size& size, Content content, std::uint32_t seed) {
  return makeGray(size, content, seed);
}

}  // namespace cbmv::test
