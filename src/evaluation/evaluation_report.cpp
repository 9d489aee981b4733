#include "evaluation/evaluation_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "evaluation/confidence_summary.h"
#include "io/binary_file.h"
#include "io/crc32_text.h"

namespace cbmv {
namespace {

/// One row per scene, then the means.
std::vector<SceneScore> rowsWithMeans(const EvaluationReport& report) {
  std::vector<SceneScore> rows = report.scenes;
  if (!report.scenes.empty()) {
    rows.push_back(meanScore(report.scenes, false));
    if (report.isWeighted()) {
      rows.push_back(meanScore(report.scenes, true));
    }
  }
  return rows;
}

std::string fixed(double value, int decimals) {
  if (std::isnan(value)) {
    return "-";
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

using Table = std::vector<std::vector<std::string>>;

/// Table of noc or all pixels, header first.
Table tableOf(const EvaluationReport& report, MetricValues SceneScore::*pixels) {
  Table table(1, {"scene"});
  for (const Metric& metric : kMetrics) {
    table[0].emplace_back(metric.name);
  }
  table[0].insert(table[0].end(), {"density", "s", "ns/hyp."});
  for (const SceneScore& score : rowsWithMeans(report)) {
    std::vector<std::string> row = {score.scene};
    for (std::size_t m = 0; m < kMetrics.size(); ++m) {
      row.push_back(fixed((score.*pixels)[m], kMetrics[m].decimals));
    }
    row.push_back(fixed(score.density, 2));
    row.push_back(fixed(score.seconds, 2));
    row.push_back(fixed(score.ns_per_hypothesis, 1));
    table.push_back(row);
  }
  return table;
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string blanks(width - text.size(), ' ');
  return left ? text + blanks : blanks + text;
}

/// Pads the columns to equal width, with `begin`, `between` and `end` around the cells.
std::string alignTable(const Table& table, const char* begin, const char* between,
                       const char* end) {
  std::vector<std::size_t> widths(table[0].size(), 0);
  for (const std::vector<std::string>& row : table) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      widths[c] = std::max(widths[c], row[c].size());
    }
  }
  std::string text;
  for (const std::vector<std::string>& row : table) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      text += (c == 0 ? begin : between) + padded(row[c], widths[c], c == 0);
    }
    text += end;
  }
  return text;
}

std::string markdownTable(Table table) {
  std::vector<std::string> rule(table[0].size(), "---:");
  rule[0] = "---";
  table.insert(table.begin() + 1, rule);
  return alignTable(table, "| ", " | ", " |\n");
}

/// The points at kMinConfidences, then those at the given density.
std::vector<OperatingPoint> pointsOf(const ConfidenceSummary& summary) {
  std::vector<OperatingPoint> points(summary.operating_points.begin(),
                                     summary.operating_points.end());
  if (summary.at_density) {
    points.push_back(*summary.at_density);
    points.push_back(*summary.at_density_each_scene);
  }
  return points;
}

std::string shortNumber(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

/// Names of pointsOf.
std::vector<std::string> pointNames(const EvaluationReport& report) {
  std::vector<std::string> names;
  names.reserve(kMinConfidences.size() + 2);
  for (const double threshold : kMinConfidences) {
    names.push_back("min_confidence " + shortNumber(threshold));
  }
  if (report.density) {
    const std::string most = "most confident " + shortNumber(*report.density) + " %, ";
    names.push_back(most + "one threshold");
    names.push_back(most + "a threshold per scene");
  }
  return names;
}

/// Table of operating points, header first; empty if they are unknown.
Table operatingTable(const EvaluationReport& report, bool weighted) {
  const auto noc =
      summarizeConfidence(report.scenes, &SceneScore::noc_sums, weighted, report.density);
  const auto all =
      summarizeConfidence(report.scenes, &SceneScore::all_sums, weighted, report.density);
  if (!noc || !all) {
    return {};
  }
  Table table = {{"kept pixels", "noc: from", "density", "bad_1", "bad_3", "all: from", "density",
                  "bad_1", "bad_3"}};
  for (const std::string& name : pointNames(report)) {
    const std::size_t place = table.size() - 1;
    table.push_back({name});
    for (const auto& summary : {noc, all}) {
      const OperatingPoint point = pointsOf(*summary)[place];
      table.back().push_back(fixed(point.min_confidence, 3));
      for (const double percent : {point.density, point.bad_1, point.bad_3}) {
        table.back().push_back(fixed(percent, 2));
      }
    }
  }
  return table;
}

/// States the limit of a correct disparity.
std::string correctNote(const EvaluationReport& report) {
  const std::string px = shortNumber(report.scoring.correct_px * report.scoring.scale);
  return "(auc: of bad " + px + "; ece, brier: correct up to " + px + " px)";
}

/// A title and a table for each kind of mean; `text` formats the table.
template <typename Text>
std::string operatingTables(const EvaluationReport& report, const Text& text) {
  std::string tables;
  for (const bool weighted : {false, true}) {
    const Table table =
        weighted && !report.isWeighted() ? Table() : operatingTable(report, weighted);
    if (!table.empty()) {
      tables += text(weighted ? "Operating points, pixels of all scenes, official weights"
                              : "Operating points, pixels of all scenes",
                     table);
    }
  }
  return tables;
}

/// What would calibrate confidence and standard deviations of these scenes; empty if the confidence
/// is unknown.
std::string recalibrationNote(const EvaluationReport& report) {
  const auto all = summarizeConfidence(report.scenes, &SceneScore::all_sums, false, report.density);
  if (!all) {
    return "";
  }
  return "Recalibration for " + shortNumber(report.scoring.correct_px * report.scoring.scale) +
         " px, pixels of all scenes: ece " + fixed(all->calibration_error, 3) +
         ", and with log-odds * " + fixed(all->recalibration.scale, 2) + " + " +
         fixed(all->recalibration.shift, 2) +
         " (confidence_scale, confidence_shift): " + fixed(all->recalibrated_error, 3) +
         (all->sigma_scale
              ? ". Standard deviations * " + fixed(*all->sigma_scale, 2) + " (sigma_scale)"
              : std::string()) +
         "\n";
}

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

/// Column name suffixes of each operating point.
std::vector<std::string> csvPoints(const EvaluationReport& report) {
  std::vector<std::string> ends;
  ends.reserve(kMinConfidences.size() + 1);
  for (const double threshold : kMinConfidences) {
    ends.push_back("_from_" + shortNumber(threshold));
  }
  if (report.density) {
    ends.push_back("_at_density_" + shortNumber(*report.density));
  }
  return ends;
}

std::string csvLine(const EvaluationReport& report, const SceneScore& score, const char* pixels,
                    const MetricValues& values, const ConfidenceProfile& profile) {
  std::string line = csvField(score.scene) + "," + pixels;
  const auto append = [&](double value) {
    line += "," + (std::isnan(value) ? std::string() : fixed(value, 6));
  };
  std::for_each(values.begin(), values.end(), append);
  append(score.density);
  append(score.seconds);
  append(score.ns_per_hypothesis);
  append(report.scoring.correct_px * report.scoring.scale);
  const auto append_point = [&](const OperatingPoint& point) {
    for (const double value : {point.min_confidence, point.density, point.bad_1, point.bad_3}) {
      append(value);
    }
  };
  for (const double threshold : kMinConfidences) {
    append_point(operatingPoint(profile, threshold));
  }
  if (report.density) {
    append_point(atDensity(profile, *report.density));
  }
  return line + "\n";
}

}  // namespace

const SceneScore* EvaluationReport::find(const std::string& scene) const {
  const auto found = std::find_if(scenes.begin(), scenes.end(),
                                  [&](const SceneScore& score) { return score.scene == scene; });
  return found == scenes.end() ? nullptr : &*found;
}

bool EvaluationReport::has(const std::string& scene) const {
  return find(scene) != nullptr || unscored.count(scene) > 0;
}

void EvaluationReport::insert(const SceneScore& score) {
  const auto place = std::lower_bound(
      scenes.begin(), scenes.end(), score.scene,
      [](const SceneScore& other, const std::string& name) { return other.scene < name; });
  if (place != scenes.end() && place->scene == score.scene) {
    *place = score;
  } else {
    scenes.insert(place, score);
  }
}

bool EvaluationReport::isWeighted() const {
  return std::any_of(scenes.begin(), scenes.end(),
                     [](const SceneScore& score) { return score.weight != 1.0; });
}

std::string fingerprintOf(const std::string& text) { return crc32Text(text); }

void writeCsvReport(const EvaluationReport& report, const std::string& path) {
  std::string text = "scene,pixels";
  for (const Metric& metric : kMetrics) {
    text += std::string(",") + metric.name;
  }
  text += ",density,seconds,ns_per_hypothesis,correct_px";
  for (const std::string& end : csvPoints(report)) {
    for (const char* name : {",min_confidence", ",density", ",bad_1", ",bad_3"}) {
      text += name + end;
    }
  }
  text += "\n";
  for (const SceneScore& score : rowsWithMeans(report)) {
    text += csvLine(report, score, "noc", score.noc, score.noc_sums.confidence) +
            csvLine(report, score, "all", score.all, score.all_sums.confidence);
  }
  replaceFile(path, text);
}

void writeMarkdownReport(const EvaluationReport& report, const std::string& path) {
  const std::string note = " " + correctNote(report) + ":\n\n";
  replaceFile(path, "Non-occluded pixels" + note +
                        markdownTable(tableOf(report, &SceneScore::noc)) + "\nAll pixels" + note +
                        markdownTable(tableOf(report, &SceneScore::all)) +
                        operatingTables(report,
                                        [](const std::string& title, const Table& table) {
                                          return "\n" + title + ":\n\n" + markdownTable(table);
                                        }) +
                        "\n" + recalibrationNote(report));
}

std::string formatReport(const EvaluationReport& report) {
  const auto aligned = [](const Table& table) { return alignTable(table, "", "  ", "\n"); };
  const std::string note = " " + correctNote(report) + "\n";
  return "non-occluded pixels" + note + aligned(tableOf(report, &SceneScore::noc)) +
         "\nall pixels" + note + aligned(tableOf(report, &SceneScore::all)) +
         operatingTables(report,
                         [&](const std::string& title, const Table& table) {
                           return "\n" + title + "\n" + aligned(table);
                         }) +
         "\n" + recalibrationNote(report);
}

}  // namespace cbmv
