#include "rectification/offset_fit.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

const cv::Size kSize(321, 241);
constexpr double kBiasPx = 0.015;  // from the header, at the image border

struct Truth {
  double offset = 0.7;
  double slope_x = 0.004;
  double slope_y = -0.003;
  double twist = 2e-5;
  double curvature_x = -1e-5;
  double curvature_y = 3e-5;

  double at(double x, double y) const {
    const double u = x - 0.5 * (kSize.width - 1);
    const double v = y - 0.5 * (kSize.height - 1);
    return offset + slope_x * u + slope_y * v + twist * u * v + curvature_x * u * u +
           curvature_y * v * v;
  }
};

/// Matches all over the image. dy has normally distributed errors; `wrong` matches are anywhere
/// within 4 px.
std::vector<SparseMatch> drawMatches(int count, int wrong, double sigma_px, cv::RNG& random) {
  std::vector<SparseMatch> matches;
  for (int i = 0; i < count; ++i) {
    SparseMatch match{random.uniform(0.0, kSize.width - 1.0),
                      random.uniform(0.0, kSize.height - 1.0), 0.0};
    match.dy = i < wrong ? random.uniform(-4.0, 4.0)
                         : Truth().at(match.x_right, match.y_left) + random.gaussian(sigma_px);
    matches.push_back(match);
  }
  return matches;
}

/// Errors of the parameters (at the image border) and the standard deviations of the fit, in px.
struct Errors {
  std::array<double, VerticalOffset::kParameters> error;
  std::array<double, VerticalOffset::kParameters> sigma;
};

Errors errorsOf(const VerticalOffset& model) {
  const double half_width = 0.5 * (kSize.width - 1);
  const double half_height = 0.5 * (kSize.height - 1);
  const Truth truth;
  return {{model.offset_px - truth.offset, half_width * (model.slope_x - truth.slope_x),
           half_height * (model.slope_y - truth.slope_y),
           half_width * half_height * (model.twist - truth.twist),
           half_width * half_width * (model.curvature_x - truth.curvature_x),
           half_height * half_height * (model.curvature_y - truth.curvature_y)},
          {model.offset_sigma_px, half_width * model.slope_x_sigma,
           half_height * model.slope_y_sigma, half_width * half_height * model.twist_sigma,
           half_width * half_width * model.curvature_x_sigma,
           half_height * half_height * model.curvature_y_sigma}};
}

/// Monte Carlo test: the errors have the standard deviation stated by the fit, and nearly all are
/// within 3 standard deviations.
void expectHonestSigmas(int count, int wrong, double sigma_px) {
  constexpr int trials = 400;
  cv::RNG random(7);
  std::array<double, VerticalOffset::kParameters> squares{};
  std::array<double, VerticalOffset::kParameters> stated{};
  int outside = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const auto measurement = fitVerticalOffset(drawMatches(count, wrong, sigma_px, random), kSize);
    const Errors errors = errorsOf(measurement.model);
    for (int i = 0; i < VerticalOffset::kParameters; ++i) {
      squares[i] += errors.error[i] * errors.error[i];
      stated[i] += errors.sigma[i] * errors.sigma[i] - kBiasPx * kBiasPx;
      outside += std::abs(errors.error[i]) > 3.0 * errors.sigma[i] ? 1 : 0;
    }
  }
  for (int i = 0; i < VerticalOffset::kParameters;
       ++i) {  // 400 errors determine a standard deviation to 3.5 %
    EXPECT_NEAR(std::sqrt(stated[i] / squares[i]), 1.0, 0.12) << "parameter " << i;
  }
  EXPECT_LE(outside, trials * VerticalOffset::kParameters / 100);
}

TEST(FitVerticalOffset, StandardDeviationsAreThoseOfAMonteCarlo) { expectHonestSigmas(80, 0, 0.3); }

TEST(FitVerticalOffset, StandardDeviationsHoldWithWrongMatches) {
  expectHonestSigmas(150, 30, 0.3);
}

TEST(FitVerticalOffset, StandardDeviationsFallWithTheSquareRootOfTheMatches) {
  cv::RNG random(3);
  const auto few = fitVerticalOffset(drawMatches(100, 0, 2.0, random), kSize).model;
  const auto many = fitVerticalOffset(drawMatches(1600, 0, 2.0, random), kSize).model;
  EXPECT_NEAR(few.offset_sigma_px / many.offset_sigma_px, 4.0, 1.0);
  EXPECT_NEAR(few.slope_x_sigma / many.slope_x_sigma, 4.0, 1.0);
}

TEST(FitVerticalOffset, PerfectMatchesGiveTheModel) {
  cv::RNG random(1);
  const auto measurement = fitVerticalOffset(drawMatches(60, 10, 0.0, random), kSize);
  for (const double error : errorsOf(measurement.model).error) {
    EXPECT_NEAR(error, 0.0, 1e-4);  // small slopes are more likely than large ones
  }
  EXPECT_EQ(measurement.model.matches, 50);
  EXPECT_NEAR(measurement.rms_after_px, 0.0, 1e-4);
  EXPECT_TRUE(measurement.is_significant);
}

TEST(FitVerticalOffset, RootMeanSquaresAreThoseOfTheMatches) {
  cv::RNG random(5);
  const auto matches = drawMatches(500, 0, 0.2, random);
  const auto measurement = fitVerticalOffset(matches, kSize);
  double before = 0.0;
  for (const SparseMatch& match : matches) {
    before += match.dy * match.dy / static_cast<double>(matches.size());
  }
  EXPECT_NEAR(measurement.rms_before_px, std::sqrt(before), 1e-9);
  EXPECT_NEAR(measurement.rms_after_px, 0.2, 0.02);
}

TEST(FitVerticalOffset, NoiseAloneIsNotSignificant) {
  cv::RNG random(9);
  std::vector<SparseMatch> matches = drawMatches(100, 0, 0.3, random);
  for (SparseMatch& match : matches) {
    match.dy -= Truth().at(match.x_right, match.y_left);
  }
  EXPECT_FALSE(fitVerticalOffset(matches, kSize).is_significant);
}

}  // namespace
}  // namespace cbmv
