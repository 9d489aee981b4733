#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <ostream>
#include <random>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

inline std::ostream& operator<<(std::ostream& out, View view) {
  return out << (view == View::kLeft ? "left view" : "right view");
}

}  // namespace cbmv

namespace cbmv::test {

/// Size and disparity range of a volume.
struct Shape {
  int height = 0;
  int width = 0;
  DisparityRange range;

  cv::Size size() const { return {width, height}; }
};

inline std::ostream& operator<<(std::ostream& out, const Shape& shape) {
  return out << shape.height << "x" << shape.width << ", " << shape.range.count
             << " disparities from " << shape.range.min;
}

/// Corner cases: single pixels, rows and columns; ranges wider than the image, beyond it or below
/// zero; sizes that are not multiples of any block size.
inline std::vector<Shape> awkwardShapes() {
  return {{1, 1, {0, 1}},     {1, 1, {-1, 3}},   {1, 43, {0, 7}},   {37, 1, {-2, 5}},
          {9, 11, {0, 29}},   {8, 10, {12, 4}},  {23, 71, {3, 40}}, {19, 67, {-9, 33}},
          {14, 33, {-20, 8}}, {41, 30, {0, 64}}, {5, 100, {2, 97}}, {70, 35, {-3, 17}}};
}

enum class Content { kNoise, kPatches };

inline std::ostream& operator<<(std::ostream& out, Content content) {
  return out << (content == Content::kNoise ? "noise" : "patches");
}

using Case = std::tuple<Shape, View, Content>;

inline auto allCases() {
  return testing::Combine(testing::ValuesIn(awkwardShapes()),
                          testing::Values(View::kLeft, View::kRight),
                          testing::Values(Content::kNoise, Content::kPatches));
}

/// Random value per cell of a coarse grid plus noise of a few units: constant regions with sharp
/// borders. Values are in [0, max].
inline int patchValue(int y, int x, int max, std::uint32_t seed, std::mt19937& random) {
  std::mt19937 cell(seed + 7919U * static_cast<unsigned>(y / 6) + static_cast<unsigned>(x / 9));
  const int value = std::uniform_int_distribution<int>(0, max)(cell);
  return std::clamp(value + std::uniform_int_distribution<int>(-2, 2)(random), 0, max);
}

inline cv::Mat makeGray(const cv::Size& size, Content content, std::uint32_t seed) {
  std::mt19937 random(seed);
  cv::Mat gray(size, CV_8UC1);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      gray.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(
          content == Content::kNoise ? std::uniform_int_distribution<int>(0, 255)(random)
                                     : patchValue(y, x, 255, seed, random));
    }
  }
  return gray;
}

/// Costs in [0, max_cost]: noise, or low along patches of constant disparity.
inline AggregatedVolume makeCosts(const Shape& shape, Content content, int max_cost,
                                  std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> noise(0, content == Content::kNoise ? max_cost : max_cost / 8);
  AggregatedVolume costs(shape.height, shape.width, shape.range.count);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const int truth = patchValue(y, x, shape.range.count - 1, seed, random);
      for (int i = 0; i < shape.range.count; ++i) {
        const int distance = content == Content::kNoise ? 0 : std::abs(i - truth) * max_cost / 5;
        costs.pixel(y, x)[i] =
            static_cast<std::uint16_t>(std::min(max_cost, distance + noise(random)));
      }
    }
  }
  return costs;
}

/// Integer disparities of the range; one in `invalid_every` is invalid.
inline cv::Mat makeDisparity(const Shape& shape, Content content, int invalid_every,
                             std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> noise(0, shape.range.count - 1);
  std::uniform_int_distribution<int> lottery(1, invalid_every);
  cv::Mat disparity(shape.size(), CV_32FC1);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const int i = content == Content::kNoise
                        ? noise(random)
                        : patchValue(y, x, shape.range.count - 1, seed, random);
      disparity.at<float>(y, x) =
          lottery(random) == 1 ? shape.range.invalid() : static_cast<float>(shape.range.min + i);
    }
  }
  return disparity;
}

inline bool isInside(const cv::Mat& image, int y, int x) {
  return x >= 0 && x < image.cols && y >= 0 && y < image.rows;
}

/// Compares volume(y, x)[i] with expected(y, x, i); stops at the first difference.
template <typename Expected>
void expectVolume(const AggregatedVolume& volume, const Shape& shape, const Expected& expected) {
  ASSERT_EQ(volume.height(), shape.height);
  ASSERT_EQ(volume.width(), shape.width);
  ASSERT_EQ(volume.disparities(), shape.range.count);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      for (int i = 0; i < shape.range.count; ++i) {
        ASSERT_EQ(volume.pixel(y, x)[i], expected(y, x, i))
            << "y " << y << " x " << x << " i " << i;
      }
    }
  }
}

/// Compares map(y, x) with expected(y, x) up to `tolerance`; stops at the first difference.
template <typename Value, typename Expected>
void expectMap(const cv::Mat& map, const cv::Size& size, const Expected& expected,
               double tolerance = 0) {
  ASSERT_EQ(map.type(), cv::DataType<Value>::type);
  ASSERT_EQ(map.size(), size);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      ASSERT_NEAR(map.at<Value>(y, x), expected(y, x), tolerance) << "y " << y << " x " << x;
    }
  }
}

}  // namespace cbmv::test
