#pragma once

#include <string>

#include "evaluation/evaluation_report.h"

namespace cbmv {

/// Writes the report as JSON: version, forest, preset, fingerprint, correct_px and error_scale
/// (ScoreOptions), scenes (scene, noc, all: an object of all metrics; density, seconds,
/// ns_per_hypothesis), mean and weighted_mean (noc, all; null when there is no scene). What is not
/// known is null. Only where there is something to say:
/// - curves of a scene (sparsification, sparsification_optimal, error_histogram; percent of the
///   non-occluded pixels, three decimals), whose abscissae are in axes (kept_percent; error_px, the
///   upper ends of the bins but the last);
/// - sums of a scene (noc, all): PixelSums, as confidence (the five arrays of bins have
///   kConfidenceBins numbers) and sigma;
/// - noc_confidence and all_confidence of the means: ConfidenceSummary;
/// - unscored, the names of scenes without ground truth.
/// The file is replaced as a whole, so that an interruption leaves the old one. Throws Error naming
/// the file when it cannot be written.
void writeJsonReport(const EvaluationReport& report, const std::string& path);

/// Reads what writeJsonReport wrote; weights are 1, there is no density. Throws Error naming the
/// file when it is missing, no such report or of another version.
EvaluationReport readJsonReport(const std::string& path);

}  // namespace cbmv
