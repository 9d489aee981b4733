#include "rectification/sparse_matches.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// Position in the right image relative to a corner of the left image.
struct Displacement {
  double disparity;  ///< px
  double dy;         ///< px
};

/// Finds corners in the right image at half resolution by zero-mean normalized cross-correlation.
class CoarseSearch {
 public:
  CoarseSearch(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
               double max_offset_px)
      : left_(half(left)),
        right_(half(right)),
        min_disparity_(static_cast<int>(std::floor(range.min / 2.0))),
        max_disparity_(static_cast<int>(std::ceil(range.max() / 2.0))),
        max_dy_(static_cast<int>(std::ceil(max_offset_px / 2.0))) {
    // Σ (value − mean)² over the window.
    const cv::Size window(kSide, kSide);
    cv::Mat mean;
    cv::boxFilter(right_, mean, CV_32F, window);
    cv::sqrBoxFilter(right_, right_energy_, CV_32F, window);
    right_energy_ = kSide * kSide * (right_energy_ - mean.mul(mean));
  }

  std::optional<Displacement> find(const cv::Point& corner) const {
    const cv::Point center(corner.x / 2, corner.y / 2);
    const int first = std::max(center.x - max_disparity_, kRadius);
    const int last = std::min(center.x - min_disparity_, right_.cols - 1 - kRadius);
    if (last < first || !isInside(center, left_)) {
      return std::nullopt;
    }
    const std::optional<cv::Matx<float, kSide, kSide>> patch = normalizedPatch(center);
    if (!patch) {
      return std::nullopt;
    }
    cv::Mat scores(2 * max_dy_ + 1, last - first + 1, CV_32FC1, cv::Scalar(-1.0));
    for (int i = 0; i < scores.rows; ++i) {
      const int y = center.y + i - max_dy_;
      if (y >= kRadius && y < right_.rows - kRadius) {
        correlate(*patch, y, first, scores.row(i));
      }
    }
    const std::optional<cv::Point> best = uniqueMaximum(scores);
    if (!best) {
      return std::nullopt;
    }
    return Displacement{2.0 * (center.x - first - best->x), 2.0 * (best->y - max_dy_)};
  }

 private:
  static constexpr int kRadius = 4;
  static constexpr int kSide = 2 * kRadius + 1;
  static constexpr float kMinCorrelation = 0.8F;
  // Lowest energy of a window: the standard deviation of the intensities is 2 gray levels.
  static constexpr float kMinEnergy = 4.0F * kSide * kSide;
  /// Largest ratio between the dissimilarity of the best position and that of any other.
  /// Dissimilarity is 1 − correlation plus a small constant, so that two perfect positions count as
  /// equal.
  static constexpr double kMaxRatio = 0.6;
  static constexpr double kDissimilarityFloor = 0.01;

  static cv::Mat half(const cv::Mat& image) {
    cv::Mat small;
    cv::pyrDown(image, small);
    small.convertTo(small, CV_32F);
    return small;
  }

  static bool isInside(const cv::Point& center, const cv::Mat& image) {
    return center.x >= kRadius && center.y >= kRadius && center.x < image.cols - kRadius &&
           center.y < image.rows - kRadius;
  }

  /// Window of the left image with zero mean and unit length. None if it has no texture.
  std::optional<cv::Matx<float, kSide, kSide>> normalizedPatch(const cv::Point& center) const {
    cv::Matx<float, kSide, kSide> patch;
    left_(cv::Rect(center.x - kRadius, center.y - kRadius, kSide, kSide)).copyTo(patch);
    patch = patch - cv::Matx<float, kSide, kSide>::all(static_cast<float>(cv::mean(patch)[0]));
    const double length = cv::norm(patch);
    if (length * length < kMinEnergy) {
      return std::nullopt;
    }
    return patch * (1.0 / length);
  }

  /// Correlates `patch` with the windows of row y whose center columns start at `first`.
  void correlate(const cv::Matx<float, kSide, kSide>& patch, int y, int first,
                 cv::Mat scores) const {
    float* const score = scores.ptr<float>();
    std::fill(score, score + scores.cols, 0.0F);
    for (int v = 0; v < kSide; ++v) {
      const float* const row = right_.ptr<float>(y + v - kRadius) + first - kRadius;
      for (int u = 0; u < kSide; ++u) {
        const float weight = patch(v, u);
        for (int i = 0; i < scores.cols; ++i) {
          score[i] += weight * row[i + u];
        }
      }
    }
    const float* const energy = right_energy_.ptr<float>(y) + first;
    for (int i = 0; i < scores.cols; ++i) {
      score[i] = energy[i] < kMinEnergy ? -1.0F : score[i] / std::sqrt(energy[i]);
    }
  }

  static std::optional<cv::Point> uniqueMaximum(cv::Mat& scores) {
    double best_score = 0.0;
    cv::Point best;
    cv::minMaxLoc(scores, nullptr, &best_score, nullptr, &best);
    if (best_score < kMinCorrelation) {
      return std::nullopt;
    }
    // The neighbors belong to the same peak.
    const cv::Rect peak(best.x - 2, best.y - 2, 5, 5);
    scores(peak & cv::Rect(0, 0, scores.cols, scores.rows)).setTo(-1.0);
    double second_score = 0.0;
    cv::minMaxLoc(scores, nullptr, &second_score);
    const double identical = 1.0 + kDissimilarityFloor;
    if (identical - best_score > kMaxRatio * (identical - second_score)) {
      return std::nullopt;
    }
    return best;
  }

  cv::Mat left_;
  cv::Mat right_;
  cv::Mat right_energy_;
  int min_disparity_;
  int max_disparity_;
  int max_dy_;
};

/// Bilinear interpolation at one position in several images of one size.
class Sampler {
 public:
  Sampler(float x, float y)
      : column_(static_cast<int>(x)), row_(static_cast<int>(y)), a_(x - column_), b_(y - row_) {}

  float operator()(const cv::Mat& image) const {
    const float* const top = image.ptr<float>(row_) + column_;
    const float* const bottom = image.ptr<float>(row_ + 1) + column_;
    const float upper = top[0] + a_ * (top[1] - top[0]);
    const float lower = bottom[0] + a_ * (bottom[1] - bottom[0]);
    return upper + b_ * (lower - upper);
  }

 private:
  int column_;
  int row_;
  float a_;
  float b_;
};

/// Aligns a patch of the left image with the right image by Gauss-Newton iterations.
///
/// Unknowns: change of column, change of column per column and per row (a slanted surface), change
/// of row, and gain and offset of the brightness. Without the slant, dy would be biased for oblique
/// texture.
class PatchAlignment {
 public:
  PatchAlignment(const cv::Mat& left, const cv::Mat& right)
      : left_(smoothed(left)), right_(smoothed(right)) {
    cv::Sobel(right_, right_dx_, CV_32F, 1, 0, 1, 0.5);
    cv::Sobel(right_, right_dy_, CV_32F, 0, 1, 1, 0.5);
  }

  std::optional<Displacement> align(const cv::Point& corner, const Displacement& start) const {
    if (!isInside(corner.x, corner.y, left_)) {
      return std::nullopt;
    }
    Vector6 unknowns;
    unknowns << 0.0, 0.0, 0.0, start.dy, 1.0, 0.0;
    Linearization linear;
    for (int i = 0; i < kMaxIterations; ++i) {
      if (!linearize(corner, start.disparity, unknowns, linear)) {
        return std::nullopt;
      }
      const Eigen::LDLT<Matrix6> solver(
          (linear.jacobian.transpose() * linear.jacobian).cast<double>());
      const Vector6 step =
          solver.solve((linear.jacobian.transpose() * linear.residuals).cast<double>());
      unknowns -= step;
      if (!isPlausible(unknowns, start)) {
        return std::nullopt;
      }
      if (std::abs(step[0]) < kConverged && std::abs(step[3]) < kConverged) {
        return isAccepted(linear, solver)
                   ? std::optional(Displacement{start.disparity - unknowns[0], unknowns[3]})
                   : std::nullopt;
      }
    }
    return std::nullopt;
  }

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  static constexpr int kRadius = 6;
  static constexpr int kPixels = (2 * kRadius + 1) * (2 * kRadius + 1);
  static constexpr double kSmoothing = 1.0;  // px; reduces aliasing and interpolation bias
  static constexpr int kMaxIterations = 15;
  static constexpr double kConverged = 0.005;  // px
  static constexpr double kMaxMove = 2.5;   // px, slightly more than one pixel of half resolution
  static constexpr double kMaxSlant = 0.5;  // px of disparity per column or per row
  static constexpr double kMaxUnexplained = 0.2;  // fraction of the variance of the patch
  static constexpr double kMaxSigma = 0.1;        // px

  struct Linearization {
    Eigen::Matrix<float, kPixels, 6> jacobian;
    Eigen::Matrix<float, kPixels, 1> residuals;
  };

  static cv::Mat smoothed(const cv::Mat& image) {
    cv::Mat real;
    image.convertTo(real, CV_32F);
    cv::GaussianBlur(real, real, cv::Size(), kSmoothing);
    return real;
  }

  /// Returns whether a window around (x, y) has a margin for interpolation.
  static bool isInside(double x, double y, const cv::Mat& image) {
    const double margin = kRadius + 1;
    return x >= margin && y >= margin && x < image.cols - 1 - margin && y < image.rows - 1 - margin;
  }

  /// Returns false for NaN, the result for a window without texture.
  static bool isPlausible(const Vector6& unknowns, const Displacement& start) {
    return std::abs(unknowns[0]) <= kMaxMove && std::abs(unknowns[3] - start.dy) <= kMaxMove &&
           std::abs(unknowns[1]) <= kMaxSlant && std::abs(unknowns[2]) <= kMaxSlant;
  }

  /// Returns false if the window leaves the right image.
  bool linearize(const cv::Point& corner, double disparity, const Vector6& unknowns,
                 Linearization& linear) const {
    const double slack = kRadius * (std::abs(unknowns[1]) + std::abs(unknowns[2]));
    const double center = corner.x - disparity + unknowns[0];
    const double row = corner.y + unknowns[3];
    if (!isInside(center - slack, row, right_) || !isInside(center + slack, row, right_)) {
      return false;
    }
    const Eigen::Matrix<float, 6, 1> p = unknowns.cast<float>();
    int i = 0;
    for (int v = -kRadius; v <= kRadius; ++v) {
      const float* const left = left_.ptr<float>(corner.y + v) + corner.x;
      for (int u = -kRadius; u <= kRadius; ++u, ++i) {
        const Sampler at(static_cast<float>(center) + u + p[1] * u + p[2] * v,
                         static_cast<float>(row) + v);
        const float dx = at(right_dx_);
        linear.jacobian.row(i) << dx, dx * u, dx * v, at(right_dy_), -left[u], -1.0F;
        linear.residuals[i] = at(right_) - p[4] * left[u] - p[5];
      }
    }
    return true;
  }

  /// Returns whether the right image explains the patch and determines its row.
  static bool isAccepted(const Linearization& linear, const Eigen::LDLT<Matrix6>& solver) {
    const auto brightness = linear.jacobian.col(4).cast<double>();
    const double energy = (brightness.array() - brightness.mean()).square().sum();
    const double unexplained = linear.residuals.squaredNorm();
    const double row_variance = solver.solve(Vector6::Unit(3))[3] * unexplained / (kPixels - 6);
    return unexplained < kMaxUnexplained * energy && row_variance < kMaxSigma * kMaxSigma;
  }

  cv::Mat left_;
  cv::Mat right_;
  cv::Mat right_dx_;
  cv::Mat right_dy_;
};

std::vector<cv::Point2f> spreadCorners(const cv::Mat& image, int count) {
  constexpr double quality = 0.002;  // relative to the strongest corner
  constexpr int window = 7;
  const double spacing = 0.6 * std::sqrt(static_cast<double>(image.total()) / count);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(image, corners, count, quality, spacing, cv::noArray(), window);
  return corners;
}

}  // namespace

void requireGrayPair(const cv::Mat& left, const cv::Mat& right) {
  if (left.type() != CV_8UC1 || right.type() != CV_8UC1 || left.size() != right.size()) {
    throw Error(
        "Cannot refine the rectification of this pair: both images must be gray with 8 bits and of "
        "one size.");
  }
}

std::vector<SparseMatch> findSparseMatches(const cv::Mat& left, const cv::Mat& right,
                                           const DisparityRange& range,
                                           const RectificationOptions& options) {
  const CoarseSearch search(left, right, range, options.max_offset_px);
  const PatchAlignment alignment(left, right);
  std::vector<SparseMatch> matches;
  for (const cv::Point corner : spreadCorners(left, options.max_features)) {
    const std::optional<Displacement> coarse = search.find(corner);
    if (!coarse) {
      continue;
    }
    const std::optional<Displacement> fine = alignment.align(corner, *coarse);
    if (fine && fine->disparity >= range.min && fine->disparity <= range.max() &&
        std::abs(fine->dy) <= options.max_offset_px) {
      matches.push_back({corner.x - fine->disparity, static_cast<double>(corner.y), fine->dy});
    }
  }
  return matches;
}

}  // namespace cbmv
