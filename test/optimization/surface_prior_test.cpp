#include "optimization/surface_prior.h"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "support/random_images.h"

namespace cbmv::test {
namespace {

constexpr float kInvalid = -1.0F;
constexpr float kReachPx = 40.0F;

/// A disparity map of half the size of `size`, as a function of coarse coordinates.
cv::Mat makeCoarse(const cv::Size& size, const std::function<double(int, int)>& disparity) {
  cv::Mat coarse(size.height / 2, size.width / 2, CV_32FC1);
  for (int y = 0; y < coarse.rows; ++y) {
    for (int x = 0; x < coarse.cols; ++x) {
      coarse.at<float>(y, x) = static_cast<float>(disparity(x, y));
    }
  }
  return coarse;
}

cv::Mat surfaceOf(const cv::Mat& coarse, const cv::Size& size, float reach_px = kReachPx) {
  cv::Mat surface;
  SurfacePrior().estimate(coarse, kInvalid, reach_px, size, surface);
  return surface;
}

/// A plane in coarse coordinates, evaluated at pixel (x, y) of full size.
double planeAt(double slope_x, double slope_y, double offset, int x, int y) {
  return 2 * (offset + slope_x * 0.5 * (x - 0.5) + slope_y * 0.5 * (y - 0.5));
}

void expectPlane(const cv::Mat& surface, const cv::Size& size, double slope_x, double slope_y,
                 double offset, double tolerance_px) {
  ASSERT_EQ(surface.type(), CV_16SC1);
  ASSERT_EQ(surface.size(), size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      ASSERT_NEAR(surface.at<std::int16_t>(y, x), planeAt(slope_x, slope_y, offset, x, y),
                  0.5 + tolerance_px)
          << "x " << x << " y " << y;
    }
  }
}

TEST(SurfacePrior, FindsPlanesOfAllSizes) {
  for (const cv::Size size : {cv::Size(2, 2), cv::Size(9, 14), cv::Size(31, 2), cv::Size(2, 31),
                              cv::Size(160, 121), cv::Size(1201, 80)}) {
    const cv::Mat coarse = makeCoarse(size, [](int x, int y) { return 40 + 0.11 * x - 0.07 * y; });
    // Outside the valid pixels, the regularization changes planes that are supported by few pixels.
    expectPlane(surfaceOf(coarse, size), size, 0.11, -0.07, 40, 0.15);
  }
}

TEST(SurfacePrior, FindsPlanesBetweenOutliersAndHoles) {
  const cv::Size size(240, 180);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> outlier(0, 100);
  std::uniform_int_distribution<int> lottery(1, 10);
  const cv::Mat coarse = makeCoarse(size, [&](int x, int y) {
    const int ticket = lottery(random);
    return ticket <= 1 ? outlier(random) : ticket <= 5 ? kInvalid : 50 - 0.13 * x + 0.09 * y;
  });
  expectPlane(surfaceOf(coarse, size), size, -0.13, 0.09, 50, 1.0);
}

TEST(SurfacePrior, FindsNoneInNoiseOrNothing) {
  const cv::Size size(200, 150);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> noise(0, 60);
  const cv::Mat noisy = surfaceOf(makeCoarse(size, [&](int, int) { return noise(random); }), size);
  EXPECT_EQ(cv::countNonZero(noisy != kNoSurface), 0);
  const cv::Mat none = surfaceOf(makeCoarse(size, [](int, int) { return kInvalid; }), size);
  EXPECT_EQ(cv::countNonZero(none != kNoSurface), 0);
}

/// Two planes with a depth edge: both are found away from the edge, and no other surface in
/// between.
TEST(SurfacePrior, KeepsBothSidesOfAStep) {
  const cv::Size size(400, 200);
  const auto plane = [](bool left, double x, double y) {
    return left ? 60 + 0.05 * x + 0.02 * y : 20 - 0.04 * x + 0.05 * y;
  };
  const cv::Mat coarse =
      makeCoarse(size, [&](int x, int y) { return plane(x < size.width / 4, x, y); });
  const cv::Mat surface = surfaceOf(coarse, size, 20);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double expected = 2 * plane(x < size.width / 2, 0.5 * (x - 0.5), 0.5 * (y - 0.5));
      const std::int16_t found = surface.at<std::int16_t>(y, x);
      const bool near_step = std::abs(x - size.width / 2) < 60;
      ASSERT_TRUE(near_step || found != kNoSurface) << "x " << x << " y " << y;
      ASSERT_TRUE(near_step || std::abs(found - expected) < 1.0) << "x " << x << " y " << y;
    }
  }
}

TEST(SurfacePrior, DependsNeitherOnThreadsNorOnEarlierMaps) {
  const cv::Size size(407, 300);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.4);
  const cv::Mat coarse =
      makeCoarse(size, [&](int x, int y) { return 9 + 0.2 * std::abs(x - y) + noise(random); });
  SurfacePrior prior;
  cv::Mat first;
  prior.estimate(coarse, kInvalid, kReachPx, size, first);
  EXPECT_GT(cv::countNonZero(first != kNoSurface), 0);
  cv::Mat other;
  prior.estimate(makeDisparity({40, 30, {0, 9}}, Content::kNoise, 3, 1), kInvalid, 15, {60, 80},
                 other);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  cv::Mat again;
  prior.estimate(coarse, kInvalid, kReachPx, size, again);
  EXPECT_EQ(cv::norm(first, again, cv::NORM_INF), 0);
}

/// Computes the first plane of a cell as a sum over all pixels, with weights equivalent to the
/// recursive filters. With residuals within a pixel, the other planes are of the same kind.
class NaivePlanes {
 public:
  NaivePlanes(const cv::Mat& coarse, double reach_px)
      : coarse_(coarse),
        columns_(kernel((coarse.cols + 3) / 4, reach_px / 8)),
        rows_(kernel((coarse.rows + 3) / 4, reach_px / 8)) {}

  /// Weighted sums of f(x, y, d) at a cell.
  double sum(int row, int column, const std::function<double(double, double, double)>& f) const {
    double result = 0;
    for (int y = 0; y < coarse_.rows; ++y) {
      for (int x = 0; x < coarse_.cols; ++x) {
        result += rows_.at<double>(row, y / 4) * columns_.at<double>(column, x / 4) *
                  f(x, y, coarse_.at<float>(y, x));
      }
    }
    return result;
  }

 private:
  /// Two forward and backward passes of y[i] = a y[i−1] + (1 − a) x[i], starting with y[0] = x[0].
  static cv::Mat kernel(int cells, double reach_cells) {
    const double a = std::exp(-2.0 / reach_cells);
    cv::Mat forth = cv::Mat::zeros(cells, cells, CV_64FC1);
    for (int i = 0; i < cells; ++i) {
      for (int j = 0; j <= i; ++j) {
        forth.at<double>(i, j) = std::pow(a, i - j) * (j == 0 ? 1 : 1 - a);
      }
    }
    cv::Mat back;
    cv::flip(forth, back, -1);
    const cv::Mat run = back * forth;
    return run * run;
  }

  cv::Mat coarse_;
  cv::Mat columns_;
  cv::Mat rows_;
};

TEST(SurfacePrior, WeighsByDistance) {
  // Nearly a plane: robust weights are close to 1, so plain least squares must agree.
  const cv::Size size(120, 96);
  const cv::Mat coarse = makeCoarse(
      size, [](int x, int y) { return 30 + 0.1 * x + 0.05 * y + 0.0004 * (x - 30) * (x - 30); });
  const float reach_px = 24;
  const cv::Mat surface = surfaceOf(coarse, size, reach_px);
  const NaivePlanes planes(coarse, reach_px);
  for (const auto& [row, column] : {std::pair(0, 0), std::pair(5, 7), std::pair(11, 14)}) {
    cv::Matx33d a = cv::Matx33d::zeros();
    cv::Vec3d b(0, 0, 0);
    const auto term = [](int i, double x, double y) { return i == 0 ? 1.0 : i == 1 ? x : y; };
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        a(i, j) = planes.sum(
            row, column, [&](double x, double y, double) { return term(i, x, y) * term(j, x, y); });
      }
      b[i] =
          planes.sum(row, column, [&](double x, double y, double d) { return term(i, x, y) * d; });
    }
    const cv::Vec3d plane = a.solve(b, cv::DECOMP_SVD);
    const int x =
        8 * column + 4;  // near the center of the cell, where its own plane has the largest weight
    const int y = 8 * row + 4;
    EXPECT_NEAR(surface.at<std::int16_t>(y, x), planeAt(plane[1], plane[2], plane[0], x, y), 0.75);
  }
}

}  // namespace
}  // namespace cbmv::test
