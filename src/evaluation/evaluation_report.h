#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "evaluation/scene_score.h"

namespace cbmv {

/// Scores of one method on one data set.
struct EvaluationReport {
  std::string forest;       ///< for people; empty: none
  std::string preset;       ///< for people; empty: none
  std::string fingerprint;  ///< equal where the scores can be compared and mixed; empty: unknown
  ScoreOptions scoring;     ///< of all scenes
  std::optional<double> density;   ///< percent of the pixels at which errors are wanted
  std::vector<SceneScore> scenes;  ///< by name
  std::set<std::string> unscored;  ///< matched, but without ground truth

  const SceneScore* find(const std::string& scene) const;  ///< nullptr: not there
  bool has(const std::string& scene) const;                ///< scored or unscored
  void insert(const SceneScore& score);                    ///< in place of one of the same name
  bool isWeighted() const;                                 ///< a weight is not 1
};

/// Eight digits, different for different texts (CRC-32).
std::string fingerprintOf(const std::string& text);

/// One line for each scene and kind of pixels (noc, all), then the means, with the operating points
/// of each line's pixels. The file is replaced as a whole. Throws Error naming the file when it
/// cannot be written.
void writeCsvReport(const EvaluationReport& report, const std::string& path);

/// Two tables, of noc and all, with their means, and where the confidence is known, of the
/// operating points. Errors as above.
void writeMarkdownReport(const EvaluationReport& report, const std::string& path);

/// The same tables for a terminal.
std::string formatReport(const EvaluationReport& report);

}  // namespace cbmv
