#include "tuning/parameter_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kFirstStep = 0.1;  // fraction of the distance between the bounds
constexpr double kWholeStep = 1.01;

struct Bounds {
  const char* name;
  double lowest;
  double highest;
  double step;
  bool logarithmic;
};

constexpr std::array<Bounds, 16> kBounds = {{
    {"cbca_arm_length", 1, 16, 1, false},
    {"cbca_intensity_threshold", 0.01, 0.5, 0, true},
    {"cbca_iterations_before", 0, 4, 1, false},
    {"cbca_iterations_after", 0, 8, 1, false},
    {"surface_reach", 10, 200, 0, true},
    {"P1", 0.05, 10, 0, true},
    {"P2", 0.5, 30, 0, true},
    {"sgm_q1", 1, 10, 0, true},
    {"sgm_q2", 1, 10, 0, true},
    {"sgm_alpha1", 1, 10, 0, true},
    {"sgm_tau_so", 0.01, 0.5, 0, true},
    {"sgm_iterations", 0, 4, 1, false},
    {"left_right_max_difference", 0, 4, 0, false},
    {"median_size", 1, 5, 2, false},
    {"bilateral_sigma", 0, 10, 0, false},
    {"bilateral_threshold", 0, 8, 0, false},
}};

double numberOf(const ParameterValue& value) {
  return std::visit([](const auto& v) { return static_cast<double>(v); }, value);
}

double toThreeDigits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return std::strtod(text.data(), nullptr);
}

}  // namespace

std::vector<Parameter> presetParameters() {
  std::vector<Parameter> parameters = stereoParameters();
  const auto first = std::find_if(parameters.begin(), parameters.end(), [](const Parameter& each) {
    return each.name == "cbca_arm_length";
  });
  parameters.erase(parameters.begin(), first);  // the table is in data flow order
  return parameters;
}

std::vector<std::string> defaultSearchParameters() {
  return {"P1",
          "P2",
          "sgm_q1",
          "sgm_q2",
          "sgm_alpha1",
          "sgm_tau_so",
          "cbca_intensity_threshold",
          "cbca_arm_length",
          "cbca_iterations_before",
          "cbca_iterations_after",
          "bilateral_sigma",
          "bilateral_threshold",
          "median_size"};
}

ParameterSpace::ParameterSpace(const std::vector<std::string>& parameters) {
  if (parameters.empty()) {
    throw Error("there is no parameter to search, expected at least one. Correct --parameters");
  }
  for (const std::string& name : parameters) {
    if (std::count(parameters.begin(), parameters.end(), name) > 1) {
      throw Error("parameter " + name + " is given twice, expected once. Correct --parameters");
    }
    axes_.push_back(findAxis(name));
  }
}

std::vector<double> ParameterSpace::coordinates(const StereoOptions& options) const {
  std::vector<double> coordinates;
  for (const Axis& axis : axes_) {
    const double value =
        std::clamp(numberOf(axis.parameter.get(options)), axis.lowest, axis.highest);
    coordinates.push_back(axis.logarithmic
                              ? std::log(value / axis.lowest) / std::log(axis.highest / axis.lowest)
                              : (value - axis.lowest) / (axis.highest - axis.lowest));
  }
  return coordinates;
}

StereoOptions ParameterSpace::optionsAt(const std::vector<double>& coordinates,
                                        const StereoOptions& others) const {
  StereoOptions options = others;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double value = valueAt(axes_[i], std::clamp(coordinates[i], 0.0, 1.0));
    if (std::holds_alternative<int>(axes_[i].parameter.default_value)) {
      axes_[i].parameter.set(options, static_cast<int>(std::lround(value)));
    } else {
      axes_[i].parameter.set(options, value);
    }
  }
  correctOptions(options);
  return options;
}

std::vector<double> ParameterSpace::firstSteps() const {
  std::vector<double> steps;
  for (const Axis& axis : axes_) {
    steps.push_back(std::max(kFirstStep, kWholeStep * axis.step / (axis.highest - axis.lowest)));
  }
  return steps;
}

ParameterSpace::Axis ParameterSpace::findAxis(const std::string& name) {
  const Parameter parameter = findParameter(name);
  for (const Bounds& bounds : kBounds) {
    if (name == bounds.name) {
      return {parameter, bounds.lowest, bounds.highest, bounds.step, bounds.logarithmic};
    }
  }
  throw Error(
      "parameter " + name +
      " cannot be searched, expected parameters of cost aggregation, SGM and refinement that are "
      "numbers. Correct --parameters");
}

double ParameterSpace::valueAt(const Axis& axis, double coordinate) {
  if (axis.logarithmic) {
    return toThreeDigits(axis.lowest * std::pow(axis.highest / axis.lowest, coordinate));
  }
  const double value = axis.lowest + coordinate * (axis.highest - axis.lowest);
  return axis.step > 0 ? axis.lowest + axis.step * std::round((value - axis.lowest) / axis.step)
                       : toThreeDigits(value);
}

}  // namespace cbmv
