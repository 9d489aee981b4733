#include "evaluation/rendered_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace cbmv {
namespace {

/// Band-limited brightness: a sum of waves with random directions, wavelength 4 to 30 px.
class Texture {
 public:
  explicit Texture(cv::RNG& rng) {
    for (Wave& wave : waves_) {
      const double length = 4.0 * std::pow(7.5, rng.uniform(0.0, 1.0));
      const double direction = rng.uniform(0.0, 2.0 * CV_PI);
      wave.x = 2.0 * CV_PI / length * std::cos(direction);
      wave.y = 2.0 * CV_PI / length * std::sin(direction);
      wave.phase = rng.uniform(0.0, 2.0 * CV_PI);
    }
    mean_ = rng.uniform(100.0, 150.0);
  }

  double at(double x, double y) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) {
      sum += std::sin(wave.x * x + wave.y * y + wave.phase);
    }
    return mean_ + 9.0 * sum;
  }

 private:
  struct Wave {
    double x, y, phase;
  };
  std::array<Wave, 16> waves_;
  double mean_ = 0.0;
};

/// A textured part of a plane. Shape, disparity and texture are functions of left image
/// coordinates.
struct Surface {
  enum class Shape { kEverywhere, kRectangle, kDisc };

  Shape shape;
  cv::Point2d center;    ///< px
  cv::Size2d half_size;  ///< px; for a disc, the width is the radius
  double disparity;      ///< at the center, px
  double slope_x;        ///< px of disparity per column, below 1
  double slope_y;        ///< px of disparity per row
  Texture texture;

  double disparityAt(double x, double y) const {
    return disparity + slope_x * (x - center.x) + slope_y * (y - center.y);
  }

  bool contains(double x, double y) const {
    const double u = std::abs(x - center.x);
    const double v = std::abs(y - center.y);
    switch (shape) {
      case Shape::kRectangle:
        return u <= half_size.width && v <= half_size.height;
      case Shape::kDisc:
        return std::hypot(u, v) <= half_size.width;
      default:
        return true;
    }
  }

  /// Left column that is projected to column `x_right`, on a row of the left image.
  double leftColumn(double x_right, double y) const {
    const double at_center_column = disparity - slope_x * center.x + slope_y * (y - center.y);
    return (x_right + at_center_column) / (1.0 - slope_x);
  }
};

/// A slanted background of about 2 to 5 px of disparity and six objects in front of it, up to 25
/// px.
std::vector<Surface> surfaces(int width, int height, int seed) {
  cv::RNG rng(static_cast<uint64_t>(seed) + 1);
  const cv::Point2d middle(0.5 * (width - 1), 0.5 * (height - 1));
  std::vector<Surface> all = {
      {Surface::Shape::kEverywhere, middle, {}, 3.5, 1.5 / width, 1.5 / height, Texture(rng)}};
  constexpr int kObjects = 6;
  for (int i = 0; i < kObjects; ++i) {
    const bool slanted = i % 3 == 2;
    const double size = rng.uniform(0.08, 0.18) * std::min(width, height);
    // Two statements: compilers evaluate arguments in different orders.
    const double center_y = rng.uniform(0.15, 0.85) * height;
    const cv::Point2d center(rng.uniform(0.15, 0.85) * width, center_y);
    const double slope_x = slanted ? rng.uniform(-1.5, 1.5) / size : 0.0;
    const double slope_y = slanted ? rng.uniform(-1.5, 1.5) / size : 0.0;
    all.push_back({i % 2 == 0 ? Surface::Shape::kRectangle : Surface::Shape::kDisc, center,
                   cv::Size2d(size, size * rng.uniform(0.6, 1.4)), rng.uniform(8.0, 22.0), slope_x,
                   slope_y, Texture(rng)});
  }
  return all;
}

/// The nearest surface. `column(surface)` is the left column where the ray meets the surface.
template <typename Column>
const Surface& nearest(const std::vector<Surface>& all, double y, Column column) {
  const Surface* best = &all.front();
  for (const Surface& surface : all) {
    const double x = column(surface);
    if (surface.contains(x, y) &&
        surface.disparityAt(x, y) >= best->disparityAt(column(*best), y)) {
      best = &surface;
    }
  }
  return *best;
}

const Surface& seenByRight(const std::vector<Surface>& all, double x_right, double y) {
  return nearest(all, y, [&](const Surface& surface) { return surface.leftColumn(x_right, y); });
}

void addNoise(cv::Mat& image, double sigma, int seed) {
  cv::Mat noise(image.size(), CV_64FC1);
  cv::RNG(static_cast<uint64_t>(seed)).fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  image += noise;
}

/// Row of the left image that is projected to (x, y) in the right one: solves y_left + dy(x,
/// y_left) = y. dy changes slowly with the row, so each iteration reduces the error at least 100
/// times.
double leftRow(const RenderOptions& options, double x, double y, const cv::Size& size) {
  constexpr int steps = 6;
  const double u = x - 0.5 * (size.width - 1);
  double y_left = y;
  for (int i = 0; i < steps; ++i) {
    const double v = y_left - 0.5 * (size.height - 1);
    y_left = y - (options.vertical_offset +
                  (options.vertical_slope_x + options.vertical_curvature_x * u) * u +
                  (options.vertical_slope_y + options.vertical_curvature_y * v) * v +
                  options.vertical_twist * u * v);
  }
  return y_left;
}

cv::Mat rightImage(const std::vector<Surface>& all, const cv::Size& size,
                   const RenderOptions& options) {
  cv::Mat image(size, CV_64FC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double y_left = leftRow(options, x, y, size);
      const Surface& surface = seenByRight(all, x, y_left);
      const double brightness = surface.texture.at(surface.leftColumn(x, y_left), y_left);
      image.at<double>(y, x) = options.right_gain * brightness + options.right_offset;
    }
  }
  return image;
}

}  // namespace

RenderedScene renderScene(int width, int height, int seed, const RenderOptions& options) {
  const cv::Size size(width, height);
  const std::vector<Surface> all = surfaces(width, height, seed);
  cv::Mat left(size, CV_64FC1);
  RenderedScene scene;
  scene.truth.create(size, CV_32FC1);
  scene.visible.create(size, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Surface& surface = nearest(all, y, [&](const Surface&) { return double(x); });
      const double disparity = surface.disparityAt(x, y);
      const double x_right = x - disparity;
      const bool visible =
          x_right >= 0.0 && x_right <= width - 1 && &seenByRight(all, x_right, y) == &surface;
      left.at<double>(y, x) = surface.texture.at(x, y);
      scene.truth.at<float>(y, x) = static_cast<float>(disparity);
      scene.visible.at<uchar>(y, x) = visible ? 255 : 0;
    }
  }
  cv::Mat right = rightImage(all, size, options);
  addNoise(left, options.noise_sigma, 2 * seed + 1);
  addNoise(right, options.noise_sigma, 2 * seed + 2);
  left.convertTo(scene.left, CV_8U);
  right.convertTo(scene.right, CV_8U);
  return scene;
}

}  // namespace cbmv
