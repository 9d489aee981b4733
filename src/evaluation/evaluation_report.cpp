#include "cbmv_stereo/evaluation/evaluation_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iterator>

#include <nlohmann/json.hpp>

#include "../io/binary_file.h"
#include "../io/bounded_json.h"
#include "../io/crc32_text.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/evaluation/disparity_error.h"

namespace cbmv {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kLargestFile = 64 << 20;

Json numberToJson(double value) { return std::isnan(value) ? Json() : Json(value); }

double numberFromJson(const Json& json) {
  return json.is_null() ? kNotMeasured : json.get<double>();
}

Json textToJson(const std::string& text) { return text.empty() ? Json() : Json(text); }

std::string textFromJson(const Json& json) { return json.is_null() ? "" : json.get<std::string>(); }

Json metricsToJson(const MetricValues& values) {
  Json json = Json::object();
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    json[kMetrics[m].name] = numberToJson(values[m]);
  }
  return json;
}

MetricValues metricsFromJson(const Json& json) {
  MetricValues values{};
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    values[m] = numberFromJson(json.at(kMetrics[m].name));
  }
  return values;
}

/// A curve of SceneCurves, as reports call it.
struct Curve {
  const char* name;
  std::vector<double> SceneCurves::*values;
};

constexpr std::array<Curve, 3> kCurves = {{
    {"sparsification", &SceneCurves::sparsification},
    {"sparsification_optimal", &SceneCurves::sparsification_optimal},
    {"error_histogram", &SceneCurves::error_histogram},
}};

/// Those that are known, to three decimals.
Json curvesToJson(const SceneCurves& curves) {
  Json json;
  for (const Curve& curve : kCurves) {
    for (const double value : curves.*curve.values) {
      json[curve.name].push_back(std::round(1e3 * value) / 1e3);
    }
  }
  return json;
}

SceneCurves curvesFromJson(const Json& json) {
  SceneCurves curves;
  for (const Curve& curve : kCurves) {
    if (json.contains(curve.name)) {
      curves.*curve.values = json.at(curve.name).get<std::vector<double>>();
    }
  }
  return curves;
}

Json axesToJson() {
  Json json;
  json["kept_percent"] = kKeptPercents;
  for (std::size_t k = 1; k <= kErrorBins; ++k) {
    json["error_px"].push_back(static_cast<double>(k) * kErrorBinPx);
  }
  return json;
}

Json sceneToJson(const SceneScore& score) {
  Json json = {{"scene", score.scene},
               {"noc", metricsToJson(score.noc)},
               {"all", metricsToJson(score.all)},
               {"density", numberToJson(score.density)},
               {"seconds", numberToJson(score.seconds)},
               {"ns_per_hypothesis", numberToJson(score.ns_per_hypothesis)}};
  const Json curves = curvesToJson(score.curves);
  if (!curves.is_null()) {
    json["curves"] = curves;
  }
  return json;
}

SceneScore sceneFromJson(const Json& json) {
  SceneScore score;
  score.scene = json.at("scene").get<std::string>();
  score.noc = metricsFromJson(json.at("noc"));
  score.all = metricsFromJson(json.at("all"));
  score.density = numberFromJson(json.at("density"));
  score.seconds = numberFromJson(json.at("seconds"));
  score.ns_per_hypothesis = numberFromJson(json.at("ns_per_hypothesis"));
  if (json.contains("curves")) {
    score.curves = curvesFromJson(json.at("curves"));
  }
  return score;
}

Json meanToJson(const std::vector<SceneScore>& scores, bool weighted) {
  if (scores.empty()) {
    return {};
  }
  const SceneScore mean = meanScore(scores, weighted);
  return {{"noc", metricsToJson(mean.noc)}, {"all", metricsToJson(mean.all)}};
}

/// The scenes' rows and, below, their means.
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

/// Cells of the table of noc or all pixels, the header first.
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

/// Columns as wide as their widest cell, between `begin`, `between` and `end`.
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

std::string csvLine(const SceneScore& score, const char* pixels, const MetricValues& values) {
  std::string line = csvField(score.scene) + "," + pixels;
  const auto append = [&](double value) {
    line += "," + (std::isnan(value) ? std::string() : fixed(value, 6));
  };
  std::for_each(values.begin(), values.end(), append);
  append(score.density);
  append(score.seconds);
  append(score.ns_per_hypothesis);
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

void writeJsonReport(const EvaluationReport& report, const std::string& path) {
  Json json;
  json["forest"] = textToJson(report.forest);
  json["preset"] = textToJson(report.preset);
  json["fingerprint"] = textToJson(report.fingerprint);
  json["scenes"] = Json::array();
  for (const SceneScore& score : report.scenes) {
    json["scenes"].push_back(sceneToJson(score));
  }
  json["mean"] = meanToJson(report.scenes, false);
  json["weighted_mean"] = meanToJson(report.scenes, true);
  if (std::any_of(json["scenes"].begin(), json["scenes"].end(),
                  [](const Json& scene) { return scene.contains("curves"); })) {
    json["axes"] = axesToJson();
  }
  if (!report.unscored.empty()) {
    json["unscored"] = report.unscored;
  }
  replaceFile(path, json.dump(1) + "\n");
}

EvaluationReport readJsonReport(const std::string& path) {
  std::ifstream in = openForReading(path, kLargestFile);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  try {
    const auto json = parseBounded<Json>(text);
    EvaluationReport report;
    report.forest = textFromJson(json.at("forest"));
    report.preset = textFromJson(json.at("preset"));
    report.fingerprint = textFromJson(json.at("fingerprint"));
    for (const Json& scene : json.at("scenes")) {
      report.insert(sceneFromJson(scene));
    }
    if (json.contains("unscored")) {
      report.unscored = json.at("unscored").get<std::set<std::string>>();
    }
    return report;
  } catch (const JsonTooLarge& error) {
    throw Error("Cannot read " + path + ": it is not a report of this program, it " + error.what() +
                ".");
  } catch (const Json::exception& error) {
    throw Error("Cannot read " + path + ": it is not a report of this program (" + error.what() +
                ").");
  }
}

void writeCsvReport(const EvaluationReport& report, const std::string& path) {
  std::string text = "scene,pixels";
  for (const Metric& metric : kMetrics) {
    text += std::string(",") + metric.name;
  }
  text += ",density,seconds,ns_per_hypothesis\n";
  for (const SceneScore& score : rowsWithMeans(report)) {
    text += csvLine(score, "noc", score.noc) + csvLine(score, "all", score.all);
  }
  replaceFile(path, text);
}

void writeMarkdownReport(const EvaluationReport& report, const std::string& path) {
  replaceFile(path, "Non-occluded pixels:\n\n" + markdownTable(tableOf(report, &SceneScore::noc)) +
                        "\nAll pixels:\n\n" + markdownTable(tableOf(report, &SceneScore::all)));
}

std::string formatReport(const EvaluationReport& report) {
  return "non-occluded pixels\n" + alignTable(tableOf(report, &SceneScore::noc), "", "  ", "\n") +
         "\nall pixels\n" + alignTable(tableOf(report, &SceneScore::all), "", "  ", "\n");
}

}  // namespace cbmv
