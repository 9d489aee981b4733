#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/io/stereo_scene.h"

namespace cbmv {

/// A number of DisparityError or Sparsification, as reports call it.
struct Metric {
  const char* name;
  int decimals;  ///< in tables
};

inline constexpr std::array<Metric, 13> kMetrics = {{
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
}};

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// In the order of kMetrics; percent or px; kNotMeasured where there is no number.
using MetricValues = std::array<double, kMetrics.size()>;

/// What a method gives for one scene.
struct SceneMaps {
  cv::Mat disparity;   ///< CV_32FC1, px; not finite = none
  cv::Mat confidence;  ///< CV_32FC1, higher is better; empty: not known
  double seconds = kNotMeasured;
};

/// Percents of the kept pixels at which SceneCurves has the sparsification curves.
inline constexpr std::array<int, 21> kKeptPercents = {1,  5,  10, 15, 20, 25, 30, 35, 40, 45, 50,
                                                      55, 60, 65, 70, 75, 80, 85, 90, 95, 100};

/// What charts show, over the pixels that both cameras see, percent; empty where it is not known.
struct SceneCurves {
  std::vector<double> sparsification;          ///< Sparsification::bad_1 at kKeptPercents
  std::vector<double> sparsification_optimal;  ///< bad_1_optimal there
  std::vector<double> error_histogram;         ///< DisparityError::histogram
};

struct SceneScore {
  std::string scene;
  double weight = 1.0;   ///< in the weighted mean
  MetricValues noc{};    ///< over the pixels that both cameras see
  MetricValues all{};    ///< over all pixels whose truth is known: where a data set knows it for
                         ///< visible pixels only, the same as noc
  double density = 0.0;  ///< percent of the latter that have a disparity
  double seconds = kNotMeasured;
  double ns_per_hypothesis = kNotMeasured;
  SceneCurves curves;
};

/// Throws Error when sizes disagree or the scene has no visible pixel with a known disparity.
SceneScore scoreScene(const StereoScene& scene, const SceneMaps& maps);

/// Means of all numbers, without curves, of scores that are not empty. `weighted`: with the weights
/// of the scenes.
SceneScore meanScore(const std::vector<SceneScore>& scores, bool weighted);

}  // namespace cbmv
