#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "data_sets/stereo_scene.h"
#include "evaluation/confidence_profile.h"
#include "evaluation/sigma_coverage.h"

namespace cbmv {

/// A value of DisparityError, Sparsification, ConfidenceProfile or SigmaCoverage, with its name in
/// reports.
struct Metric {
  const char* name;
  int decimals;  ///< in tables
};

inline constexpr std::array<Metric, 18> kMetrics = {{
    {"bad_0.5", 2},
    {"bad_1", 2},
    {"bad_2", 2},
    {"bad_3", 2},
    {"bad_4", 2},
    {"d1", 2},
    {"avg", 3},
    {"rms", 3},
    {"a50", 3},
    {"a90", 3},
    {"a99", 3},
    {"auc", 2},
    {"auc_optimal", 2},
    {"ece", 3},
    {"brier", 3},
    {"sigma_1", 2},
    {"sigma_2", 2},
    {"sigma_rms", 3},
}};

/// The first kErrorMetrics of kMetrics depend on the disparities only. The others need confidence
/// or sigma.
inline constexpr std::size_t kErrorMetrics = 11;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// In the order of kMetrics; percent or px; kNotMeasured: unknown.
using MetricValues = std::array<double, kMetrics.size()>;

/// Output of a method for one scene.
struct SceneMaps {
  cv::Mat disparity;        ///< CV_32FC1, px; not finite = none
  cv::Mat confidence;       ///< CV_32FC1, higher is better; empty: unknown
  cv::Mat disparity_sigma;  ///< CV_32FC1, px, standard deviation of disparity; empty: unknown
  double seconds = kNotMeasured;
};

/// Densities at which SceneCurves samples the sparsification curves, percent.
inline constexpr std::array<int, 21> kKeptPercents = {1,  5,  10, 15, 20, 25, 30, 35, 40, 45, 50,
                                                      55, 60, 65, 70, 75, 80, 85, 90, 95, 100};

/// Data for charts, over the pixels that both cameras see, percent; empty: unknown.
struct SceneCurves {
  std::vector<double> sparsification;          ///< Sparsification::bad at kKeptPercents
  std::vector<double> sparsification_optimal;  ///< Sparsification::bad_optimal at kKeptPercents
  std::vector<double> error_histogram;         ///< DisparityError::histogram
};

/// Sums for the metrics that are computed over the pixels of all scenes together.
struct PixelSums {
  ConfidenceProfile confidence;
  SigmaCoverage sigma;
};

/// Adds the sums of a scene, with the given weight independent of its number of pixels.
void addSums(const PixelSums& scene, double weight, PixelSums& sum);

struct SceneScore {
  std::string scene;
  double weight = 1.0;  ///< in the weighted mean
  MetricValues noc{};   ///< over the pixels that both cameras see
  MetricValues all{};   ///< over all pixels with known truth; same as noc if the truth covers
                        ///< visible pixels only
  PixelSums noc_sums;   ///< over the pixels of noc
  PixelSums all_sums;
  double density = 0.0;  ///< percent of all pixels with truth that have a disparity
  double seconds = kNotMeasured;
  double ns_per_hypothesis = kNotMeasured;
  SceneCurves curves;
};

/// Settings of scoreScene.
struct ScoreOptions {
  /// Largest |d − truth| of a correct disparity, px of the images. `auc`, `ece`, `brier` and the
  /// operating points count larger errors as wrong. It is also the largest error of an inlier
  /// (sigma_coverage.h).
  double correct_px = 1.0;
  /// Factor for disparities, truth, sigma and correct_px; the other thresholds are not scaled. With
  /// 2, images of half resolution give errors at full-resolution scale.
  double scale = 1.0;
};

bool operator==(const ScoreOptions& a, const ScoreOptions& b);

/// Throws Error when sizes differ or the scene has no visible pixel with a known disparity.
SceneScore scoreScene(const StereoScene& scene, const SceneMaps& maps,
                      const ScoreOptions& options = {});

/// Means of all metrics, without curves; `scores` must not be empty. `ece` and `sigma_…` are
/// computed over the pixels of all scenes together, each scene with its weight. `weighted`: use the
/// weights of the scenes, else 1 each.
SceneScore meanScore(const std::vector<SceneScore>& scores, bool weighted);

}  // namespace cbmv
