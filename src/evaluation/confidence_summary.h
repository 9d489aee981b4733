#pragma once

#include <array>
#include <optional>
#include <vector>

#include "evaluation/confidence_profile.h"
#include "evaluation/scene_score.h"

namespace cbmv {

/// Thresholds whose operating points are reported.
inline constexpr std::array<double, 5> kMinConfidences = {0.0, 0.3, 0.5, 0.7, 0.9};

/// What a user of the confidence wants to know of a data set: over the pixels of all scenes
/// together, which get the weight of their scene.
struct ConfidenceSummary {
  std::array<CalibrationBin, kCalibrationBins> reliability;
  std::array<OperatingPoint, kMinConfidences.size()> operating_points;  ///< at kMinConfidences
  std::optional<OperatingPoint> at_density;  ///< with one threshold for all scenes
  /// Means over the scenes, each with a threshold of its own; min_confidence is NaN.
  std::optional<OperatingPoint> at_density_each_scene;
};

/// `sums`: of the non-occluded or of all pixels. `weighted`: with the weights of the scenes, else 1
/// each. `density`: percent of the counted pixels, above 0, at which the last two are wanted.
/// Nothing unless the confidence of every scene, at least one, is known and a probability.
std::optional<ConfidenceSummary> summarizeConfidence(const std::vector<SceneScore>& scores,
                                                     PixelSums SceneScore::*sums, bool weighted,
                                                     const std::optional<double>& density);

}  // namespace cbmv
