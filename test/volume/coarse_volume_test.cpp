#include "volume/coarse_volume.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random_images.h"

namespace cbmv::test {
namespace {

TEST(HalveRange, HoldsTheHalvesOfAllDisparities) {
  for (int min = -9; min <= 9; ++min) {
    for (int count = 1; count <= 12; ++count) {
      const DisparityRange range{min, count};
      const DisparityRange half = halveRange(range);
      EXPECT_EQ(half.min, static_cast<int>(std::floor(range.min / 2.0)));
      EXPECT_EQ(half.max(), static_cast<int>(std::floor(range.max() / 2.0)));
    }
  }
}

TEST(HalveImage, IsTheMeanOfFourPixels) {
  for (const cv::Size size : {cv::Size(2, 2), cv::Size(31, 18), cv::Size(40, 23)}) {
    const cv::Mat gray = makeGray(size, Content::kNoise, 3);
    cv::Mat half;
    halveImage(gray, half);
    expectMap<std::uint8_t>(half, {size.width / 2, size.height / 2}, [&](int y, int x) {
      const double sum = cv::sum(gray(cv::Rect(2 * x, 2 * y, 2, 2)))[0];
      return std::floor(sum / 4 + 0.5);
    });
  }
}

class HalveVolume : public testing::TestWithParam<Shape> {};

TEST_P(HalveVolume, EqualsNaiveOne) {
  const Shape shape = GetParam();
  if (shape.width < 2 || shape.height < 2) {
    GTEST_SKIP() << "nothing to halve";
  }
  const AggregatedVolume words = makeCosts(shape, Content::kNoise, 255, 7);
  MatchingVolume costs(shape.height, shape.width, shape.range.count);
  std::copy_n(words.row(0), words.size(), costs.row(0));
  MatchingVolume half;
  halveVolume(costs, shape.range, half);

  const DisparityRange half_range = halveRange(shape.range);
  ASSERT_EQ(half.height(), shape.height / 2);
  ASSERT_EQ(half.width(), shape.width / 2);
  ASSERT_EQ(half.disparities(), half_range.count);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      for (int i = 0; i < half_range.count; ++i) {
        double lowest = 256;
        for (int d = 2 * (half_range.min + i); d <= 2 * (half_range.min + i) + 1; ++d) {
          if (d < shape.range.min || d > shape.range.max()) {
            continue;
          }
          double sum = 0;
          for (const int row : {2 * y, 2 * y + 1}) {
            for (const int column : {2 * x, 2 * x + 1}) {
              sum += costs.pixel(row, column)[d - shape.range.min];
            }
          }
          lowest = std::min(lowest, std::floor(sum / 4 + 0.5));
        }
        ASSERT_EQ(half.pixel(y, x)[i], lowest) << "y " << y << " x " << x << " i " << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, HalveVolume, testing::ValuesIn(awkwardShapes()));

}  // namespace
}  // namespace cbmv::test
