#pragma once

#include <string>

#include "evaluation/evaluation_report.h"

namespace cbmv {

/// Writes the report as JSON: version, forest, preset, fingerprint, correct_px and error_scale
/// (ScoreOptions), scenes (scene; noc and all, each an object with all metrics; density, seconds,
/// ns_per_hypothesis), mean and weighted_mean (noc, all; null when there is no scene). Unknown
/// values are null. The following are written only if they are not empty:
/// - curves of a scene (sparsification, sparsification_optimal, error_histogram; percent of the
///   non-occluded pixels, three decimals). Their abscissae are in axes: kept_percent, and error_px,
///   the upper limits of all bins but the last.
/// - sums of a scene (noc, all): PixelSums as confidence (five arrays with kConfidenceBins numbers
///   each) and sigma.
/// - noc_confidence and all_confidence of the means: ConfidenceSummary.
/// - unscored: the names of scenes without ground truth.
///
/// Replaces the file atomically. Throws Error with the file when it cannot be written.
void writeJsonReport(const EvaluationReport& report, const std::string& path);

/// Reads a file written by writeJsonReport. All weights are 1; density is not set. Throws Error
/// with the file when it is missing, is no report or has another version.
EvaluationReport readJsonReport(const std::string& path);

}  // namespace cbmv
