#pragma once

#include <array>
#include <optional>
#include <vector>

#include "evaluation/confidence_profile.h"
#include "evaluation/recalibration.h"
#include "evaluation/scene_score.h"

namespace cbmv {

/// Thresholds of the reported operating points.
inline constexpr std::array<double, 5> kMinConfidences = {0.0, 0.3, 0.5, 0.7, 0.9};

/// Confidence quality over the pixels of all scenes of a data set. Each scene contributes with its
/// weight.
struct ConfidenceSummary {
  std::array<CalibrationBin, kCalibrationBins> reliability;
  std::array<OperatingPoint, kMinConfidences.size()> operating_points;  ///< at kMinConfidences
  double calibration_error = 0.0;            ///< of the pixels of all scenes
  Recalibration recalibration;               ///< fitted to these pixels
  double recalibrated_error = 0.0;           ///< calibration error with it, on the same pixels
  std::optional<double> sigma_scale;         ///< fitted to these pixels
  std::optional<OperatingPoint> at_density;  ///< with one threshold for all scenes
  /// Mean over the scenes, each with its own threshold; min_confidence is NaN.
  std::optional<OperatingPoint> at_density_each_scene;
};

/// `sums`: non-occluded pixels or all pixels. `weighted`: use the weights of the scenes, else 1
/// each. `density`: percent of the counted pixels, above 0, for at_density and
/// at_density_each_scene. Returns nothing if there is no scene, or if the confidence of a scene is
/// unknown or not a probability.
std::optional<ConfidenceSummary> summarizeConfidence(const std::vector<SceneScore>& scores,
                                                     PixelSums SceneScore::*sums, bool weighted,
                                                     const std::optional<double>& density);

}  // namespace cbmv
