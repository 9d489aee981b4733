#pragma once

#include <string>

#include "evaluation/evaluation_report.h"

namespace cbmv {

/// A score with all metrics, without sums.
inline SceneScore makeScore(const std::string& name, double first, double weight) {
  SceneScore score;
  score.scene = name;
  score.weight = weight;
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    score.noc[m] = first + static_cast<double>(m) / 7.0;
    score.all[m] = 2.0 * score.noc[m];
  }
  score.density = 99.5;
  score.seconds = 1.25;
  score.ns_per_hypothesis = 40.0;
  return score;
}

/// A report with two scenes, one with half the weight.
inline EvaluationReport makeReport() {
  EvaluationReport report;
  report.forest = "my.forest";
  report.preset = "my.yaml";
  report.fingerprint = "01234567";
  report.insert(makeScore("Vintage", 4.0, 0.5));
  report.insert(makeScore("Teddy", 1.0, 1.0));
  return report;
}

/// Half of the pixels have confidence 0.95 and are correct; the others have 0.45 and an error of 2
/// px.
inline ConfidenceProfile halfWrongProfile(double pixels) {
  ConfidenceProfile profile;
  profile.pixels = pixels;
  profile.bins.resize(kConfidenceBins);
  const double half = pixels / 2.0;
  profile.bins[90] = {half, 0.45 * half, half, half, 0.0};
  profile.bins[190] = {half, 0.95 * half, 0.0, 0.0, 0.0};
  return profile;
}

}  // namespace cbmv
