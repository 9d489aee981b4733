#pragma once

#include <optional>

#include "evaluation/confidence_profile.h"
#include "evaluation/sigma_coverage.h"

namespace cbmv {

/// Maps confidences by their log-odds to scale · log-odds + shift (Platt 1999). The values are
/// those of the parameters confidence_scale and confidence_shift.
struct Recalibration {
  double scale = 1.0;
  double shift = 0.0;
};

/// The maximum-likelihood map from the confidences to the shares of correct pixels: two numbers, so
/// some scenes with ground truth suffice, and the order of the pixels stays. Within the ranges of
/// the parameters. As trained (scale 1, shift 0) if the profile is unknown, has pixels of one
/// confidence only, or only correct or only wrong pixels.
Recalibration fitRecalibration(const ConfidenceProfile& profile);

/// The factor with which kOneSigmaShare of the inliers are within one sigma, as in training. Within
/// the range of the parameter sigma_scale. Nothing without inliers.
std::optional<double> fitSigmaScale(const SigmaCoverage& coverage);

/// The profile after the map: errors as before, at the new confidences. Each bin moves as a whole.
ConfidenceProfile recalibrate(const ConfidenceProfile& profile, const Recalibration& map);

}  // namespace cbmv
