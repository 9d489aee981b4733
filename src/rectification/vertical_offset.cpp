#include "cbmv_stereo/rectification/vertical_offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Dense>
#include <tbb/parallel_for.h>

#include "sparse_matches.h"

namespace cbmv {
namespace {

constexpr int kMinSide = 32;             // px; smaller images hold no matches worth a fit
constexpr double kMaxResidual = 0.5;     // px; matches that scatter more tell nothing
constexpr double kMinConsistent = 0.5;   // part of the matches that must agree with the model
constexpr double kMinScale = 0.02;       // px; keeps the weights finite on perfect matches
constexpr double kSlopePrior = 1.0;      // px at the border of the image, standard deviation
constexpr double kMinSpread = 0.2;       // determinant of three matches that fix a model
constexpr double kSignificance = 16.27;  // chi-square, 3 degrees of freedom, 99.9 %

/// Columns: 1, x and y in halves of the image, so that all parameters are in px.
struct LinearFit {
  Eigen::MatrixX3d design;
  Eigen::VectorXd dy;
  Eigen::VectorXd weights;
  Eigen::Vector3d parameters = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double scale = 0.0;  ///< robust standard deviation of the residuals, px

  Eigen::VectorXd residuals() const { return dy - design * parameters; }

  void solve() {
    Eigen::Matrix3d normal = design.transpose() * weights.asDiagonal() * design;
    // Matches in one corner must not send the opposite corner astray.
    const double prior =
        std::max(scale * scale, kMinScale * kMinScale) / (kSlopePrior * kSlopePrior);
    normal(1, 1) += prior;
    normal(2, 2) += prior;
    parameters = normal.ldlt().solve(design.transpose() * weights.asDiagonal() * dy);
    covariance = normal.inverse() * (scale * scale);
  }
};

LinearFit linearSystem(const std::vector<SparseMatch>& matches, const cv::Size& size) {
  const auto count = static_cast<Eigen::Index>(matches.size());
  LinearFit fit;
  fit.design.resize(count, 3);
  fit.dy.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SparseMatch& match = matches[static_cast<std::size_t>(i)];
    fit.design.row(i) << 1.0, 2.0 * match.x_right / (size.width - 1) - 1.0,
        2.0 * match.y_left / (size.height - 1) - 1.0;
    fit.dy[i] = match.dy;
  }
  fit.weights = Eigen::VectorXd::Ones(count);
  return fit;
}

/// Standard deviation of a normal distribution with this median of absolute values.
double robustScale(const Eigen::VectorXd& residuals) {
  std::vector<double> absolute(static_cast<std::size_t>(residuals.size()));
  Eigen::VectorXd::Map(absolute.data(), residuals.size()) = residuals.cwiseAbs();
  const auto middle = absolute.begin() + static_cast<std::ptrdiff_t>(absolute.size() / 2);
  std::nth_element(absolute.begin(), middle, absolute.end());
  return std::max(1.4826 * *middle, kMinScale);
}

/// Least median of squares: of the models through three matches, the one with the smallest scale.
/// Half of the matches may be wrong, and agree with each other, without moving it.
Eigen::Vector3d leastMedianModel(const LinearFit& fit) {
  constexpr int samples = 300;
  cv::RNG rng(1);  // always the same samples: the estimate is deterministic
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double best_scale = robustScale(fit.dy);
  for (int i = 0; i < samples; ++i) {
    Eigen::Matrix3d design;
    Eigen::Vector3d dy;
    for (int j = 0; j < 3; ++j) {
      const int match = rng.uniform(0, static_cast<int>(fit.dy.size()));
      design.row(j) = fit.design.row(match);
      dy[j] = fit.dy[match];
    }
    if (std::abs(design.determinant()) < kMinSpread) {
      continue;
    }
    const Eigen::Vector3d model = design.inverse() * dy;
    const double scale = robustScale(fit.dy - fit.design * model);
    if (scale < best_scale) {
      best = model;
      best_scale = scale;
    }
  }
  return best;
}

double tukeyWeight(double residual) {
  const double part = residual / 4.685;
  return std::abs(part) >= 1.0 ? 0.0 : (1.0 - part * part) * (1.0 - part * part);
}

void fitRobustly(LinearFit& fit) {
  constexpr int iterations = 10;
  fit.parameters = leastMedianModel(fit);
  for (int i = 0; i < iterations; ++i) {
    const Eigen::VectorXd residuals = fit.residuals();
    fit.scale = robustScale(residuals);
    fit.weights = (residuals / fit.scale).unaryExpr(&tukeyWeight);
    fit.solve();
  }
}

bool isSignificant(const LinearFit& fit) {
  return fit.parameters.dot(fit.covariance.ldlt().solve(fit.parameters)) > kSignificance;
}

constexpr int kSteps = 32;             // places between two rows
constexpr int kWeightUnits = 1 << 15;  // what the weights of a place add up to

/// Weights of the rows −1, 0, 1 and 2 from the one above, by place.
using CubicWeights = std::array<std::array<int, 4>, kSteps>;

CubicWeights cubicWeights() {
  constexpr double a = -0.75;
  const auto outer = [](double t) { return a * t * (t - 1) * (t - 1); };
  const auto inner = [](double t) { return ((a + 2) * t - (a + 3)) * t * t + 1; };
  const auto in_units = [](double weight) {
    return static_cast<int>(std::lround(kWeightUnits * weight));
  };
  CubicWeights weights{};
  for (int step = 0; step < kSteps; ++step) {
    const double t = static_cast<double>(step) / kSteps;
    weights[step] = {in_units(outer(t)), in_units(inner(t)), in_units(inner(1 - t)),
                     in_units(outer(1 - t))};
  }
  return weights;
}

/// Some columns of a row of the result, all from the same place in `image`: row place / kSteps.
void resampleColumns(const cv::Mat& image, const cv::Range& columns, int place,
                     const CubicWeights& weights, std::uint8_t* out) {
  const int step = place & (kSteps - 1);
  const int above = (place - step) / kSteps;
  const std::array<int, 4>& weight = weights[step];
  std::array<const std::uint8_t*, 4> rows{};
  for (int k = 0; k < 4; ++k) {
    rows[k] = image.ptr(std::clamp(above - 1 + k, 0, image.rows - 1));
  }
  for (int i = columns.start * image.channels(); i < columns.end * image.channels(); ++i) {
    const int sum = weight[0] * rows[0][i] + weight[1] * rows[1][i] + weight[2] * rows[2][i] +
                    weight[3] * rows[3][i] + kWeightUnits / 2;
    out[i] = static_cast<std::uint8_t>(std::clamp(sum / kWeightUnits, 0, 255));
  }
}

/// Row y of the aligned image: the offset changes slowly, so that runs of columns share a place.
void alignRow(const cv::Mat& right, int y, const VerticalOffset& model, const CubicWeights& weights,
              std::uint8_t* out) {
  const auto place_of = [&](int x) {
    return static_cast<int>(
        std::lrint(kSteps * static_cast<float>(y + model.at(x, y, right.size()))));
  };
  int place = place_of(0);
  for (int x = 0; x < right.cols;) {
    cv::Range columns(x, x + 1);
    int next = place;
    while (columns.end < right.cols && (next = place_of(columns.end)) == place) {
      ++columns.end;
    }
    resampleColumns(right, columns, place, weights, out);
    place = next;
    x = columns.end;
  }
}

VerticalOffset toModel(const LinearFit& fit, const cv::Size& size) {
  VerticalOffset model;
  model.offset_px = fit.parameters[0];
  model.slope_x = 2.0 * fit.parameters[1] / (size.width - 1);
  model.slope_y = 2.0 * fit.parameters[2] / (size.height - 1);
  model.offset_sigma_px = std::sqrt(fit.covariance(0, 0));
  model.residual_px = fit.scale;
  model.matches = static_cast<int>((fit.weights.array() > 0.0).count());
  return model;
}

}  // namespace

double VerticalOffset::at(double x, double y, cv::Size size) const {
  return offset_px + slope_x * (x - 0.5 * (size.width - 1)) +
         slope_y * (y - 0.5 * (size.height - 1));
}

double VerticalOffset::rootMeanSquare(cv::Size size) const {
  const double x = 0.5 * slope_x * (size.width - 1);
  const double y = 0.5 * slope_y * (size.height - 1);
  return std::sqrt(offset_px * offset_px + (x * x + y * y) / 3.0);
}

void VerticalOffset::clearCorrection() {
  offset_px = 0.0;
  slope_x = 0.0;
  slope_y = 0.0;
}

VerticalOffset estimateVerticalOffset(const cv::Mat& left, const cv::Mat& right,
                                      const DisparityRange& range,
                                      const RectificationOptions& options) {
  requireGreyPair(left, right);
  if (!options.enabled || std::min(left.cols, left.rows) < kMinSide) {
    return {};
  }
  const std::vector<SparseMatch> matches = findSparseMatches(left, right, range, options);
  const int min_matches = std::max(options.min_matches, 3);
  if (static_cast<int>(matches.size()) < min_matches) {
    return {};
  }
  LinearFit fit = linearSystem(matches, left.size());
  fitRobustly(fit);
  VerticalOffset model = toModel(fit, left.size());
  if (model.matches < min_matches || model.residual_px > kMaxResidual ||
      model.matches < kMinConsistent * static_cast<double>(matches.size())) {
    return {};
  }
  if (!isSignificant(fit) || model.rootMeanSquare(left.size()) < options.min_correction_px) {
    model.clearCorrection();
  }
  return model;
}

cv::Mat alignRightRows(const cv::Mat& right, const VerticalOffset& model, cv::Mat& aligned) {
  if (model.isZero()) {
    return right;
  }
  CV_Assert(right.depth() == CV_8U && right.data != aligned.data);
  aligned.create(right.size(), right.type());
  const CubicWeights weights = cubicWeights();
  tbb::parallel_for(0, right.rows, [&](int y) {
    alignRow(right, y, model, weights, aligned.ptr<std::uint8_t>(y));
  });
  return aligned;
}

cv::Mat alignRightRows(const cv::Mat& right, const VerticalOffset& model) {
  cv::Mat aligned;
  return alignRightRows(right, model, aligned);
}

}  // namespace cbmv
