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

/// A number of DisparityError, Sparsification, ConfidenceProfile or SigmaCoverage, as reports call
/// it.
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

/// The first of kMetrics are of the disparities alone; the others need a confidence or sigma.
inline constexpr std::size_t kErrorMetrics = 11;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// In the order of kMetrics; percent or px; kNotMeasured where there is no number.
using MetricValues = std::array<double, kMetrics.size()>;

/// What a method gives for one scene.
struct SceneMaps {
  cv::Mat disparity;        ///< CV_32FC1, px; not finite = none
  cv::Mat confidence;       ///< CV_32FC1, higher is better; empty: not known
  cv::Mat disparity_sigma;  ///< CV_32FC1, px, standard deviation of disparity; empty: not known
  double seconds = kNotMeasured;
};

/// Percents of the kept pixels at which SceneCurves has the sparsification curves.
inline constexpr std::array<int, 21> kKeptPercents = {1,  5,  10, 15, 20, 25, 30, 35, 40, 45, 50,
                                                      55, 60, 65, 70, 75, 80, 85, 90, 95, 100};

/// What charts show, over the pixels that both cameras see, percent; empty where it is not known.
struct SceneCurves {
  std::vector<double> sparsification;          ///< Sparsification::bad at kKeptPercents
  std::vector<double> sparsification_optimal;  ///< bad_optimal there
  std::vector<double> error_histogram;         ///< DisparityError::histogram
};

/// What is measured over the pixels of all scenes together, as sums.
struct PixelSums {
  ConfidenceProfile confidence;
  SigmaCoverage sigma;
};

struct SceneScore {
  std::string scene;
  double weight = 1.0;  ///< in the weighted mean
  MetricValues noc{};   ///< over the pixels that both cameras see
  MetricValues all{};   ///< over all pixels whose truth is known: where a data set knows it for
                        ///< visible pixels only, the same as noc
  PixelSums noc_sums;   ///< over the same pixels
  PixelSums all_sums;
  double density = 0.0;  ///< percent of all pixels with truth that have a disparity
  double seconds = kNotMeasured;
  double ns_per_hypothesis = kNotMeasured;
  SceneCurves curves;
};

/// How errors become numbers.
struct ScoreOptions {
  /// Largest |d − truth| of a correct disparity, px of the images: what `auc`, `ece`, `brier` and
  /// operating points call wrong is above it. An inlier of sigma has an error up to 1 px.
  double correct_px = 1.0;
  /// Factor of disparities, truth, sigma, correct_px and the 1 px of inliers, but not of the other
  /// thresholds: 2 gives the errors of images of half resolution at full-resolution scale.
  double scale = 1.0;
};

bool operator==(const ScoreOptions& a, const ScoreOptions& b);

/// Throws Error when sizes disagree or the scene has no visible pixel with a known disparity.
SceneScore scoreScene(const StereoScene& scene, const SceneMaps& maps,
                      const ScoreOptions& options = {});

/// Means of all numbers, without curves, of scores that are not empty; `ece` and `sigma_…` are
/// those of the pixels of all scenes together, which get the weight of their scene. `weighted`:
/// with the weights of the scenes, else 1 each.
SceneScore meanScore(const std::vector<SceneScore>& scores, bool weighted);

}  // namespace cbmv
