#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "evaluation/scene_score.h"

namespace cbmv {

/// Scores of one method on one data set.
struct EvaluationReport {
  std::string forest;       ///< display name; empty: none
  std::string preset;       ///< display name; empty: none
  std::string fingerprint;  ///< equal if scores are comparable and may be mixed; empty: unknown
  ScoreOptions scoring;     ///< of all scenes
  std::optional<double> density;   ///< density at which errors are reported, percent
  std::vector<SceneScore> scenes;  ///< sorted by name
  std::set<std::string> unscored;  ///< scenes matched without ground truth

  const SceneScore* find(const std::string& scene) const;  ///< nullptr: not found
  bool has(const std::string& scene) const;                ///< scored or unscored
  void insert(const SceneScore& score);                    ///< replaces a score with the same name
  bool isWeighted() const;                                 ///< whether any weight differs from 1
};

/// Eight hexadecimal digits (CRC-32) that identify the text.
std::string fingerprintOf(const std::string& text);

/// Writes one line per scene and kind of pixels (noc, all), then the means. Each line includes the
/// operating points of its pixels. Replaces the file atomically. Throws Error with the file when it
/// cannot be written.
void writeCsvReport(const EvaluationReport& report, const std::string& path);

/// Writes two tables, noc and all, with their means, and two tables of operating points if the
/// confidence is known. Errors as above.
void writeMarkdownReport(const EvaluationReport& report, const std::string& path);

/// The same tables for a terminal.
std::string formatReport(const EvaluationReport& report);

}  // namespace cbmv
