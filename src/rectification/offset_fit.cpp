#include "rectification/offset_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace cbmv {
namespace {

constexpr double kMinScale = 0.02;       // px; keeps the weights finite for perfect matches
constexpr double kSlopePrior = 1.0;      // px at the image border, standard deviation
constexpr double kMinSpread = 0.2;       // smallest determinant of a minimal sample
constexpr double kSignificance = 22.46;  // chi-square, 6 degrees of freedom, 99.9 %
constexpr double kBiasPx = 0.015;        // px; common error of the subpixel matches of a pair
constexpr double kTukey = 4.685;  // residuals from this multiple of the scale on have weight 0

constexpr int kParameters = VerticalOffset::kParameters;
constexpr int kBilinear = 4;  // parameters of the model without curvatures
using Parameters = Eigen::Matrix<double, kParameters, 1>;
using ParameterMatrix = Eigen::Matrix<double, kParameters, kParameters>;

/// Linear model dy = design · parameters. Columns of the design: 1, x, y, xy, x² and y². x and y
/// are in units of half the image size, so that all parameters are in px.
struct LinearFit {
  Eigen::Matrix<double, Eigen::Dynamic, kParameters> design;
  Eigen::VectorXd dy;
  Eigen::VectorXd weights;
  Parameters parameters = Parameters::Zero();
  double scale = 0.0;  ///< robust standard deviation of the residuals, px

  Eigen::VectorXd residuals() const { return dy - design * parameters; }

  /// Σ w a aᵀ plus a prior on all parameters except the offset. Without the prior, matches in one
  /// corner could give wrong values in the opposite corner.
  ParameterMatrix normalMatrix(const Eigen::VectorXd& match_weights) const {
    ParameterMatrix normal = design.transpose() * match_weights.asDiagonal() * design;
    normal.diagonal().tail<kParameters - 1>().array() +=
        scale * scale / (kSlopePrior * kSlopePrior);
    return normal;
  }

  void solve() {
    parameters = normalMatrix(weights).ldlt().solve(design.transpose() * weights.asDiagonal() * dy);
  }
};

LinearFit linearSystem(const std::vector<SparseMatch>& matches, const cv::Size& size) {
  const auto count = static_cast<Eigen::Index>(matches.size());
  LinearFit fit;
  fit.design.resize(count, kParameters);
  fit.dy.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SparseMatch& match = matches[static_cast<std::size_t>(i)];
    const double x = 2.0 * match.x_right / (size.width - 1) - 1.0;
    const double y = 2.0 * match.y_left / (size.height - 1) - 1.0;
    fit.design.row(i) << 1.0, x, y, x * y, x * x, y * y;
    fit.dy[i] = match.dy;
  }
  fit.weights = Eigen::VectorXd::Ones(count);
  return fit;
}

/// Standard deviation of a normal distribution with the same median of absolute values.
double robustScale(const Eigen::VectorXd& residuals) {
  std::vector<double> absolute(static_cast<std::size_t>(residuals.size()));
  Eigen::VectorXd::Map(absolute.data(), residuals.size()) = residuals.cwiseAbs();
  const auto middle = absolute.begin() + static_cast<std::ptrdiff_t>(absolute.size() / 2);
  std::nth_element(absolute.begin(), middle, absolute.end());
  return std::max(1.4826 * *middle, kMinScale);
}

/// Least median of squares: fits bilinear models to samples of four matches and returns the model
/// with the smallest scale. The result is robust against up to half of the matches being wrong,
/// even if the wrong ones agree with each other.
Parameters leastMedianModel(const LinearFit& fit) {
  constexpr int samples = 600;
  cv::RNG rng(1);  // fixed seed: the estimate is deterministic
  Parameters best = Parameters::Zero();
  double best_scale = robustScale(fit.dy);
  for (int i = 0; i < samples; ++i) {
    Eigen::Matrix<double, kBilinear, kBilinear> design;
    Eigen::Matrix<double, kBilinear, 1> dy;
    for (int j = 0; j < kBilinear; ++j) {
      const int match = rng.uniform(0, static_cast<int>(fit.dy.size()));
      design.row(j) = fit.design.row(match).head<kBilinear>();
      dy[j] = fit.dy[match];
    }
    if (std::abs(design.determinant()) < kMinSpread) {
      continue;
    }
    Parameters model = Parameters::Zero();
    model.head<kBilinear>() = design.inverse() * dy;
    const double scale = robustScale(fit.dy - fit.design * model);
    if (scale < best_scale) {
      best = model;
      best_scale = scale;
    }
  }
  return best;
}

double tukeyWeight(double residual) {
  const double part = residual / kTukey;
  return std::abs(part) >= 1.0 ? 0.0 : (1.0 - part * part) * (1.0 - part * part);
}

/// Derivative of ψ(u) = u tukeyWeight(u).
double tukeySlope(double residual) {
  const double square = residual * residual / (kTukey * kTukey);
  return square >= 1.0 ? 0.0 : (1.0 - square) * (1.0 - 5.0 * square);
}

/// Covariance of the parameters, see fitVerticalOffset.
ParameterMatrix covarianceOf(const LinearFit& fit) {
  const Eigen::VectorXd scaled = fit.residuals() / fit.scale;
  const Eigen::VectorXd influence = fit.scale * scaled.cwiseProduct(scaled.unaryExpr(&tukeyWeight));
  const ParameterMatrix inverse = fit.normalMatrix(scaled.unaryExpr(&tukeySlope)).inverse();
  const ParameterMatrix spread =
      fit.design.transpose() * influence.cwiseAbs2().asDiagonal() * fit.design;
  const double count = (fit.weights.array() > 0.0).count();
  return inverse * spread * inverse * (count / std::max(count - kParameters, 1.0)) +
         kBiasPx * kBiasPx * ParameterMatrix::Identity();
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

VerticalOffset toModel(const LinearFit& fit, const ParameterMatrix& covariance,
                       const cv::Size& size) {
  const double per_column = 2.0 / (size.width - 1);
  const double per_row = 2.0 / (size.height - 1);
  VerticalOffset model;
  model.offset_px = fit.parameters[0];
  model.slope_x = per_column * fit.parameters[1];
  model.slope_y = per_row * fit.parameters[2];
  model.twist = per_column * per_row * fit.parameters[3];
  model.curvature_x = per_column * per_column * fit.parameters[4];
  model.curvature_y = per_row * per_row * fit.parameters[5];
  model.offset_sigma_px = std::sqrt(covariance(0, 0));
  model.slope_x_sigma = per_column * std::sqrt(covariance(1, 1));
  model.slope_y_sigma = per_row * std::sqrt(covariance(2, 2));
  model.twist_sigma = per_column * per_row * std::sqrt(covariance(3, 3));
  model.curvature_x_sigma = per_column * per_column * std::sqrt(covariance(4, 4));
  model.curvature_y_sigma = per_row * per_row * std::sqrt(covariance(5, 5));
  model.residual_px = fit.scale;
  model.matches = static_cast<int>((fit.weights.array() > 0.0).count());
  return model;
}

/// Over the matches that agree with the model.
double rootMeanSquare(const LinearFit& fit, const Eigen::VectorXd& values) {
  const Eigen::VectorXd agrees = (fit.weights.array() > 0.0).cast<double>();
  return std::sqrt(values.cwiseAbs2().dot(agrees) / std::max(agrees.sum(), 1.0));
}

}  // namespace

VerticalOffsetMeasurement fitVerticalOffset(const std::vector<SparseMatch>& matches,
                                            cv::Size size) {
  LinearFit fit = linearSystem(matches, size);
  fitRobustly(fit);
  const ParameterMatrix covariance = covarianceOf(fit);
  VerticalOffsetMeasurement measurement;
  measurement.model = toModel(fit, covariance, size);
  measurement.is_significant =
      fit.parameters.dot(covariance.ldlt().solve(fit.parameters)) > kSignificance;
  measurement.rms_before_px = rootMeanSquare(fit, fit.dy);
  measurement.rms_after_px = rootMeanSquare(fit, fit.residuals());
  return measurement;
}

}  // namespace cbmv
