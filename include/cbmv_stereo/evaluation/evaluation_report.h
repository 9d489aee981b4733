#pragma once

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

  const SceneScore* find(const std::string& scene) const;  ///< nullptr: not there
  void insert(const SceneScore& score);                    ///< in place of one of the same name
  bool isWeighted() const;                                 ///< a weight is not 1
};

/// Eight digits, different for different texts (CRC-32).
std::string fingerprintOf(const std::string& text);

/// Writes the report as JSON: forest, preset, fingerprint, scenes (scene, noc, all: an object of
/// all metrics; density, seconds, ns_per_hypothesis), mean and weighted_mean (noc, all; null when
/// there is no scene). What is not known is null. The file is replaced as a whole, so that an
/// interruption leaves the old one. Throws Error naming the file when it cannot be written.
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
