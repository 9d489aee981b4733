#include "evaluation/json_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <utility>

#include "evaluation/confidence_summary.h"
#include "evaluation/disparity_error.h"
#include "io/binary_file.h"
#include "io/bounded_json.h"
#include "io/ordered_json.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

using Json = OrderedJson;

constexpr std::uintmax_t kLargestFile = 64 << 20;
/// Earlier versions have no sums (1) or others of sigma (2), and are not read.
constexpr int kVersion = 3;

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

/// A curve of SceneCurves and its name in reports.
struct Curve {
  const char* name;
  std::vector<double> SceneCurves::*values;
};

constexpr std::array<Curve, 3> kCurves = {{
    {"sparsification", &SceneCurves::sparsification},
    {"sparsification_optimal", &SceneCurves::sparsification_optimal},
    {"error_histogram", &SceneCurves::error_histogram},
}};

double rounded(double value) { return std::round(1e3 * value) / 1e3; }

/// The known curves, with three decimals.
Json curvesToJson(const SceneCurves& curves) {
  Json json;
  for (const Curve& curve : kCurves) {
    for (const double value : curves.*curve.values) {
      json[curve.name].push_back(rounded(value));
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

/// An array of the bins of ConfidenceProfile and its name in reports.
struct BinEntry {
  const char* name;
  double ConfidenceProfile::Bin::*value;
};

constexpr std::array<BinEntry, 5> kBinEntries = {{
    {"pixels", &ConfidenceProfile::Bin::pixels},
    {"confidence", &ConfidenceProfile::Bin::confidence},
    {"wrong", &ConfidenceProfile::Bin::wrong},
    {"bad_1", &ConfidenceProfile::Bin::bad_1},
    {"bad_3", &ConfidenceProfile::Bin::bad_3},
}};

Json profileToJson(const ConfidenceProfile& profile) {
  Json json = {{"pixels", profile.pixels}, {"squared_error", profile.squared_error}};
  for (const BinEntry& entry : kBinEntries) {
    Json& values = json["bins"][entry.name] = Json::array();
    for (const ConfidenceProfile::Bin& bin : profile.bins) {
      values.push_back(rounded(bin.*entry.value));
    }
  }
  return json;
}

/// Throws the same exception for a list of wrong length as for a missing entry.
ConfidenceProfile profileFromJson(const Json& json) {
  ConfidenceProfile profile;
  profile.pixels = json.at("pixels").get<double>();
  profile.squared_error = json.at("squared_error").get<double>();
  profile.bins.resize(kConfidenceBins);
  for (const BinEntry& entry : kBinEntries) {
    const Json& values = json.at("bins").at(entry.name);
    for (std::size_t b = 0; b < kConfidenceBins; ++b) {
      profile.bins[b].*entry.value = values.at(b).get<double>();
    }
  }
  return profile;
}

Json coverageToJson(const SigmaCoverage& coverage) {
  Json json = {{"pixels", coverage.pixels},
               {"inliers", coverage.inliers},
               {"squared_sum", coverage.squared_sum}};
  for (const double count : coverage.bins) {
    json["bins"].push_back(rounded(count));
  }
  return json;
}

SigmaCoverage coverageFromJson(const Json& json) {
  SigmaCoverage coverage;
  coverage.pixels = json.at("pixels").get<double>();
  coverage.inliers = json.at("inliers").get<double>();
  coverage.squared_sum = json.at("squared_sum").get<double>();
  for (std::size_t b = 0; b < SigmaCoverage::kBins; ++b) {
    coverage.bins[b] = json.at("bins").at(b).get<double>();
  }
  return coverage;
}

/// The known sums.
Json sumsToJson(const PixelSums& sums) {
  Json json = Json::object();
  if (!sums.confidence.bins.empty()) {
    json["confidence"] = profileToJson(sums.confidence);
  }
  if (sums.sigma.inliers > 0.0) {
    json["sigma"] = coverageToJson(sums.sigma);
  }
  return json;
}

PixelSums sumsFromJson(const Json& json) {
  PixelSums sums;
  if (json.contains("confidence")) {
    sums.confidence = profileFromJson(json.at("confidence"));
  }
  if (json.contains("sigma")) {
    sums.sigma = coverageFromJson(json.at("sigma"));
  }
  return sums;
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
  const Json noc = sumsToJson(score.noc_sums);
  const Json all = sumsToJson(score.all_sums);
  if (!noc.empty() || !all.empty()) {
    json["sums"] = {{"noc", noc}, {"all", all}};
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
  if (json.contains("sums")) {
    score.noc_sums = sumsFromJson(json.at("sums").at("noc"));
    score.all_sums = sumsFromJson(json.at("sums").at("all"));
  }
  return score;
}

Json pointToJson(const OperatingPoint& point) {
  return {{"min_confidence", numberToJson(point.min_confidence)},
          {"density", numberToJson(point.density)},
          {"bad_1", numberToJson(point.bad_1)},
          {"bad_3", numberToJson(point.bad_3)}};
}

Json summaryToJson(const ConfidenceSummary& summary) {
  Json json;
  for (const CalibrationBin& bin : summary.reliability) {
    json["reliability"].push_back({{"pixels", numberToJson(bin.pixels)},
                                   {"confidence", numberToJson(bin.confidence)},
                                   {"correct", numberToJson(bin.correct)}});
  }
  for (const OperatingPoint& point : summary.operating_points) {
    json["operating_points"].push_back(pointToJson(point));
  }
  json["recalibration"] = {{"confidence_scale", summary.recalibration.scale},
                           {"confidence_shift", summary.recalibration.shift},
                           {"ece", numberToJson(summary.recalibrated_error)}};
  if (summary.sigma_scale) {
    json["recalibration"]["sigma_scale"] = *summary.sigma_scale;
  }
  if (summary.at_density) {
    json["at_density"] = pointToJson(*summary.at_density);
    json["at_density_each_scene"] = pointToJson(*summary.at_density_each_scene);
  }
  return json;
}

Json meanToJson(const EvaluationReport& report, bool weighted) {
  if (report.scenes.empty()) {
    return {};
  }
  const SceneScore mean = meanScore(report.scenes, weighted);
  Json json = {{"noc", metricsToJson(mean.noc)}, {"all", metricsToJson(mean.all)}};
  for (const auto& [name, sums] : {std::make_pair("noc_confidence", &SceneScore::noc_sums),
                                   std::make_pair("all_confidence", &SceneScore::all_sums)}) {
    const auto summary = summarizeConfidence(report.scenes, sums, weighted, report.density);
    if (summary) {
      json[name] = summaryToJson(*summary);
    }
  }
  return json;
}

/// Throws Error if the report has another version.
void requireVersion(const Json& json, const std::string& path) {
  const int version = json.is_object() ? json.value("version", 1) : kVersion;
  if (version != kVersion) {
    throw Error("Cannot read " + path + ": it is a report of version " + std::to_string(version) +
                ", whose numbers cannot be mixed with those of this program, expected version " +
                std::to_string(kVersion) + ". Measure all scenes again, without --resume.");
  }
}

}  // namespace

void writeJsonReport(const EvaluationReport& report, const std::string& path) {
  Json json;
  json["version"] = kVersion;
  json["forest"] = textToJson(report.forest);
  json["preset"] = textToJson(report.preset);
  json["fingerprint"] = textToJson(report.fingerprint);
  json["correct_px"] = report.scoring.correct_px;
  json["error_scale"] = report.scoring.scale;
  json["scenes"] = Json::array();
  for (const SceneScore& score : report.scenes) {
    json["scenes"].push_back(sceneToJson(score));
  }
  json["mean"] = meanToJson(report, false);
  json["weighted_mean"] = meanToJson(report, true);
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
    requireVersion(json, path);
    EvaluationReport report;
    report.forest = textFromJson(json.at("forest"));
    report.preset = textFromJson(json.at("preset"));
    report.fingerprint = textFromJson(json.at("fingerprint"));
    report.scoring.correct_px = json.at("correct_px").get<double>();
    report.scoring.scale = json.at("error_scale").get<double>();
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

}  // namespace cbmv
