#include "cbmv_stereo/parameters.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <type_traits>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "optimization/semi_global_matching.h"
#include "optimization/sgm_penalties.h"
#include "refinement/bilateral_filter.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

std::string valueText(const ParameterValue& value) {
  std::ostringstream text;
  text << std::boolalpha;
  std::visit([&](const auto& v) { text << v; }, value);
  return text.str();
}

namespace {

constexpr std::uintmax_t kLargestPreset = 64 << 10;
constexpr int kLargestSgmCost = 16383;  // the sum of four paths fits into 16 bits

double numberOf(const ParameterValue& value) {
  return std::visit([](const auto& v) { return static_cast<double>(v); }, value);
}

/// The type of a value in error messages.
const char* typeName(const ParameterValue& value) {
  constexpr std::array<const char*, 3> names = {"true or false", "a whole number", "a number"};
  return names[value.index()];
}

void requireFits(const Parameter& parameter, const ParameterValue& value) {
  const bool promoted =
      std::holds_alternative<int>(value) && std::holds_alternative<double>(parameter.default_value);
  if (value.index() != parameter.default_value.index() && !promoted) {
    throw Error(parameter.name + " is " + valueText(value) + ", expected " +
                typeName(parameter.default_value));
  }
  // Options are stored as float. A value that equals a limit must stay valid after conversion to
  // float.
  const auto number = static_cast<float>(numberOf(value));
  if (!std::holds_alternative<bool>(value) && !(number >= static_cast<float>(parameter.lowest) &&
                                                number <= static_cast<float>(parameter.highest))) {
    std::ostringstream text;
    text << parameter.name << " is " << number << ", expected a value in [" << parameter.lowest
         << ", " << parameter.highest << "]";
    throw Error(text.str());
  }
}

/// Builds the table. Each call of add() adds a field, which `access` finds in any StereoOptions.
class ParameterTable {
 public:
  template <typename Access>
  void add(const char* name, const char* unit, double lowest, double highest, Access access,
           const char* description) {
    using Field = std::decay_t<decltype(access(std::declval<StereoOptions&>()))>;
    using Value = std::conditional_t<std::is_floating_point_v<Field>, double, Field>;
    Parameter parameter;
    parameter.name = name;
    parameter.unit = unit;
    parameter.description = description;
    parameter.lowest = lowest;
    parameter.highest = highest;
    parameter.get = [access](const StereoOptions& options) {
      StereoOptions copy = options;
      return ParameterValue(static_cast<Value>(access(copy)));
    };
    parameter.default_value = parameter.get(StereoOptions());
    Parameter checked = parameter;
    parameter.set = [access, checked](StereoOptions& options, const ParameterValue& value) {
      requireFits(checked, value);
      access(options) = static_cast<Field>(numberOf(value));
    };
    parameters.push_back(std::move(parameter));
  }

  std::vector<Parameter> parameters;
};

using Options = StereoOptions;

void addMatchingParameters(ParameterTable& table) {
  table.add(
      "min_disparity", "px", -2048, 2048, [](Options& o) -> int& { return o.range.min; },
      "Lowest disparity of the range; negative for toed-in cameras");
  table.add(
      "disparity_range", "px", 0, 4096, [](Options& o) -> int& { return o.range.count; },
      "Number of disparities, from min_disparity on; 0: found in the images");
  table.add(
      "max_memory_mb", "MB", 0, 100000, [](Options& o) -> int& { return o.max_memory_mb; },
      "Pairs that need more memory are rejected; 0: no limit");
  table.add(
      "search_levels", "", 0, 6, [](Options& o) -> int& { return o.search.levels; },
      "Coarse-to-fine search: number of halvings of the images. Only the smallest pair is "
      "searched over the whole range. 0: exhaustive search");
  table.add(
      "search_neighborhood", "px", 0, 8,
      [](Options& o) -> int& { return o.search.neighborhood_px; },
      "Coarse-to-fine search: radius, in coarse pixels, from which a pixel takes candidate "
      "disparities");
  table.add(
      "search_margin", "px", 0, 16, [](Options& o) -> int& { return o.search.margin_px; },
      "Coarse-to-fine search: disparities that are added on both sides of each candidate");
  table.add(
      "refine_rectification", "", 0, 1, [](Options& o) -> bool& { return o.rectification.enabled; },
      "Estimate and correct the residual vertical offset between the images");
  table.add(
      "rectification_max_offset", "px", 0.5, 16,
      [](Options& o) -> double& { return o.rectification.max_offset_px; },
      "Largest vertical offset that is searched");
  table.add(
      "rectification_interval", "s", 0, 3600,
      [](Options& o) -> double& { return o.rectification.interval_s; },
      "Time between two estimates of the vertical offset in a stream");
}

void addOptimizationParameters(ParameterTable& table) {
  table.add(
      "cbca_arm_length", "px", 1, 64,
      [](Options& o) -> int& { return o.aggregation.arm_length_px; },
      "L1: the arms of the support regions are shorter than this");
  table.add(
      "cbca_intensity_threshold", "standard deviations", 0, 10,
      [](Options& o) -> float& { return o.aggregation.intensity_threshold; },
      "tau1: an arm ends where the intensity differs from that of the center by this");
  table.add(
      "cbca_iterations_before", "", 0, 16,
      [](Options& o) -> int& { return o.aggregation.iterations_before; },
      "Iterations of cost aggregation before semi-global matching");
  table.add(
      "cbca_iterations_after", "", 0, 16,
      [](Options& o) -> int& { return o.aggregation.iterations_after; },
      "Iterations of cost aggregation after semi-global matching");
  table.add(
      "surface_prior", "", 0, 1, [](Options& o) -> bool& { return o.surface.enabled; },
      "Match at half the size first; semi-global matching then follows the slanted surfaces found "
      "there");
  table.add(
      "surface_reach", "px", 2, 500, [](Options& o) -> float& { return o.surface.reach_px; },
      "Standard deviation of the distances over which a surface is fitted");
  table.add(
      "P1", "", 0, 60, [](Options& o) -> float& { return o.sgm.p1; },
      "Penalty of a disparity step of one pixel; matching costs are in [0, 1]");
  table.add(
      "P2", "", 0, 60, [](Options& o) -> float& { return o.sgm.p2; },
      "Penalty of a larger disparity step, at least P1");
  table.add(
      "sgm_q1", "", 1, 20, [](Options& o) -> float& { return o.sgm.q1; },
      "Divides P1 and P2 where one of the images has an edge");
  table.add(
      "sgm_q2", "", 1, 20, [](Options& o) -> float& { return o.sgm.q2; },
      "Divides P1 and P2 once more where both images have an edge");
  table.add(
      "sgm_alpha1", "", 1, 20, [](Options& o) -> float& { return o.sgm.alpha1; },
      "Divides P1 on the vertical paths");
  table.add(
      "sgm_tau_so", "standard deviations", 0, 10,
      [](Options& o) -> float& { return o.sgm.edge_threshold; },
      "Smallest intensity step between neighbors that is an edge");
  table.add(
      "sgm_iterations", "", 0, 4, [](Options& o) -> int& { return o.sgm.iterations; },
      "Iterations of semi-global matching, each on the result of the one before; 0: off");
}

void addRefinementParameters(ParameterTable& table) {
  table.add(
      "left_right_check", "", 0, 1,
      [](Options& o) -> bool& { return o.refinement.left_right_check; },
      "Match the right view too, and find occlusions and mismatches by the left-right consistency "
      "check");
  table.add(
      "optimize_right_view", "", 0, 1,
      [](Options& o) -> bool& { return o.refinement.optimize_right_view; },
      "Run semi-global matching on the right view, too, for the check; this doubles its time. "
      "Off: the right view takes its disparities from the left cost volume");
  table.add(
      "left_right_max_difference", "px", 0, 16,
      [](Options& o) -> float& { return o.refinement.max_left_right_difference_px; },
      "Largest difference of both views that passes the left-right consistency check");
  table.add(
      "fill_occlusions", "", 0, 1, [](Options& o) -> bool& { return o.refinement.fill_occlusions; },
      "Fill occlusions from the background; off: they are invalid");
  table.add(
      "fill_mismatches", "", 0, 1, [](Options& o) -> bool& { return o.refinement.fill_mismatches; },
      "Fill mismatches from their neighbors; off: they are invalid");
  table.add(
      "subpixel", "", 0, 1, [](Options& o) -> bool& { return o.refinement.subpixel; },
      "Refine whole-pixel disparities by a parabola through the costs");
  table.add(
      "median_size", "px", 1, 5, [](Options& o) -> int& { return o.refinement.median_size_px; },
      "Side of the window of the median filter, odd; 1: off");
  table.add(
      "bilateral_sigma", "px", 0, kMaxBilateralSigmaPx,
      [](Options& o) -> float& { return o.refinement.bilateral_sigma_px; },
      "Standard deviation of the bilateral filter; 0: off");
  table.add(
      "bilateral_threshold", "px", 0.01, 16,
      [](Options& o) -> float& { return o.refinement.bilateral_threshold_px; },
      "The bilateral filter ignores disparities that differ from that of the center by this or "
      "more");
  table.add(
      "second_forest", "", 0, 1, [](Options& o) -> bool& { return o.refinement.second_forest; },
      "Calibrated confidence and standard deviation; needs a forest file with a second forest");
  table.add(
      "replace_improbable", "", 0, 1,
      [](Options& o) -> bool& { return o.refinement.replace_improbable; },
      "Replace improbable disparities by those of confident neighbors, where the second forest "
      "finds these more probable; needs second_forest");
  table.add(
      "confidence_scale", "", 0.1, 10,
      [](Options& o) -> float& { return o.refinement.confidence_scale; },
      "Recalibrates the confidence of the second forest: multiplies its log-odds; 1: as trained");
  table.add(
      "confidence_shift", "", -10, 10,
      [](Options& o) -> float& { return o.refinement.confidence_shift; },
      "Recalibrates the confidence of the second forest: is added to its log-odds, after "
      "confidence_scale; 0: as trained");
  table.add(
      "sigma_scale", "", 0.1, 10, [](Options& o) -> float& { return o.refinement.sigma_scale; },
      "Multiplies the standard deviation of disparity and depth; 1: as trained");
  table.add(
      "speckle_size", "px", 0, 1000,
      [](Options& o) -> int& { return o.refinement.speckle_size_px; },
      "Regions of up to this many pixels become invalid; 0: off");
  table.add(
      "speckle_range", "px", 0, 31,
      [](Options& o) -> int& { return o.refinement.speckle_range_px; },
      "Neighbors whose disparities differ by more belong to two regions");
}

ParameterValue valueFromYaml(const Parameter& parameter, const YAML::Node& node) {
  if (std::holds_alternative<bool>(parameter.default_value)) {
    return node.as<bool>();
  }
  if (std::holds_alternative<int>(parameter.default_value)) {
    return node.as<int>();
  }
  return node.as<double>();
}

void requirePresetFile(const std::string& path) {
  std::error_code ignored;  // files that cannot be opened are reported when they are read
  if (std::filesystem::is_directory(path, ignored)) {
    throw Error("is a folder, expected a YAML file. Give the path of a preset");
  }
  if (std::filesystem::is_regular_file(path, ignored) &&
      std::filesystem::file_size(path, ignored) > kLargestPreset) {
    throw Error("has more than " + std::to_string(kLargestPreset) +
                " bytes, expected a preset. Give the path of a preset");
  }
}

}  // namespace

std::string describe(const Parameter& parameter) {
  return parameter.description + (parameter.unit.empty() ? "" : " (" + parameter.unit + ")");
}

std::vector<Parameter> stereoParameters() {
  ParameterTable table;
  addMatchingParameters(table);
  addOptimizationParameters(table);
  addRefinementParameters(table);
  return table.parameters;
}

Parameter findParameter(const std::string& name) {
  for (const Parameter& parameter : stereoParameters()) {
    if (parameter.name == name) {
      return parameter;
    }
  }
  throw Error("there is no parameter " + name + ". docs/parameters.md lists the names");
}

std::string describeOptions(const StereoOptions& options) {
  std::string text;
  for (const Parameter& parameter : stereoParameters()) {
    text += parameter.name + " = " + valueText(parameter.get(options)) +
            (parameter.unit.empty() ? "" : " " + parameter.unit) + "\n";
  }
  return text;
}

std::vector<std::string> correctOptions(StereoOptions& options) {
  std::vector<std::string> corrections;
  SgmOptions& sgm = options.sgm;
  if (sgm.p1 > sgm.p2) {
    corrections.push_back(
        "P1 (" + valueText(sgm.p1) + ") was lowered to P2 (" + valueText(sgm.p2) +
        "): the penalty of a small disparity step must not exceed that of a large one");
    sgm.p1 = sgm.p2;
  }
  if (sgmCostBound(sgm) > kLargestSgmCost) {
    const int whole_highest = (kLargestSgmCost - 255) / 255 / sgm.iterations;
    const auto highest = static_cast<float>(whole_highest);
    corrections.push_back("P2 (" + valueText(sgm.p2) + ") was lowered to " + valueText(highest) +
                          ": the cost sums of " + valueText(sgm.iterations) +
                          " iterations of semi-global matching must fit into 16 bits");
    sgm.p2 = highest;
    sgm.p1 = std::min(sgm.p1, sgm.p2);
  }
  int& median = options.refinement.median_size_px;
  if (median % 2 == 0) {
    corrections.push_back("median_size (" + valueText(median) + ") was lowered to " +
                          valueText(median - 1) + ": the window must be odd");
    --median;
  }
  return corrections;
}

void readPreset(const std::string& path, StereoOptions& options) {
  try {
    requirePresetFile(path);
    const YAML::Node preset = YAML::LoadFile(path);
    if (!preset.IsMap()) {
      throw Error("is not a map, expected lines NAME: VALUE. Correct the file");
    }
    StereoOptions read = options;
    for (const auto& entry : preset) {
      const auto name = entry.first.as<std::string>();
      const Parameter parameter = findParameter(name);
      try {
        parameter.set(read, valueFromYaml(parameter, entry.second));
      } catch (const YAML::Exception&) {
        throw Error(name + " has a value of the wrong type, expected " +
                    typeName(parameter.default_value));
      }
    }
    options = read;
  } catch (const YAML::BadFile&) {
    throw Error("preset " + path +
                ": cannot be opened, expected a YAML file. Check the path and its permissions");
  } catch (const YAML::Exception& error) {
    throw Error("preset " + path + ": is not valid YAML: " + error.what() + ". Correct the file");
  } catch (const Error& error) {
    throw Error("preset " + path + ": " + error.what());
  }
}

}  // namespace cbmv
