#pragma once

#include <set>
#include <string>
#include <vector>

#include "cbmv_stereo/evaluation/scene_score.h"

namespace cbmv {

/// Scores of one method on one data set.
struct EvaluationReport {
  std::string forest;       ///< for people; empty: none
  std::string preset;       ///< for people; empty: none
  std::string fingerprint;  ///< equal where the scores can be compared and mixed; empty: unknown
  std::vector<SceneScore> scenes;  ///< by name
  std::set<std::string> unscored;  ///< matched, but without ground truth

  const SceneScore* find(const std::string& scene) const;  ///< nullptr: not there
  bool has(const std::string& scene) const;                ///< scored or unscored
  void insert(const SceneScore& score);                    ///< in place of one of the same name
  bool isWeighted() const;                                 ///< a weight is not 1
};

/// Eight digits, different for different texts (CRC-32).
std::string fingerprintOf(const std::string& text);

/// Writes the report as JSON: forest, preset, fingerprint, scenes (scene, noc, all: an object of
/// all metrics; density, seconds, ns_per_hypothesis), mean and weighted_mean (noc, all; null when
/// there is no scene). What is not known is null. Only where there is something to say: curves of a
/// scene (sparsification, sparsification_optimal, error_histogram; percent of the non-occluded
/// pixels, three decimals), whose abscissae are in axes (kept_percent; error_px, the upper ends of
/// the bins but the last), and unscored, the names of scenes without ground truth. The file is
/// replaced as a whole, so that an interruption leaves the old one. Throws Error naming the file
/// when it cannot be written.
void writeJsonReport(const EvaluationReport& report, const std::string& path);

/// Reads what writeJsonReport wrote; weights are 1. Throws Error naming the file when it is missing
/// or no such report.
EvaluationReport readJsonReport(const std::string& path);

/// One line for each scene and kind of pixels (noc, all), then the means. Errors as above.
void writeCsvReport(const EvaluationReport& report, const std::string& path);

/// Two tables, of noc and all, with their means. Errors as above.
void writeMarkdownReport(const EvaluationReport& report, const std::string& path);

/// The same tables for a terminal.
std::string formatReport(const EvaluationReport& report);

}  // namespace cbmv
