#include "ros/parameter_server.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include <dynamic_reconfigure/Config.h>
#include <ros/package.h>

#include "ros/private_parameters.h"
#include "ros/unknown_parameters.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/parameters.h"
#include "cbmv_stereo/presets.h"

namespace cbmv {
namespace {

/// Parameters of stereo_image_proc/disparity without a counterpart here.
constexpr std::array<const char*, 8> kStockOnly = {
    "stereo_algorithm", "prefilter_size",    "prefilter_cap", "correlation_window_size",
    "uniqueness_ratio", "texture_threshold", "fullDP",        "disp12MaxDiff"};

/// The list of dynamic_reconfigure::Config for parameters of type Value.
template <typename Value>
auto& listOf(dynamic_reconfigure::Config& message) {
  if constexpr (std::is_same_v<Value, bool>) {
    return message.bools;
  } else if constexpr (std::is_same_v<Value, int>) {
    return message.ints;
  } else {
    return message.doubles;
  }
}

/// Calls use(entry) with the entry of `message` that has the name and type of `parameter`; an entry
/// has the members name and value.
template <typename Use>
void withEntry(dynamic_reconfigure::Config& message, const Parameter& parameter, const Use& use) {
  std::visit(
      [&](auto value) {
        auto& list = listOf<decltype(value)>(message);
        const auto entry = std::find_if(list.begin(), list.end(), [&](const auto& candidate) {
          return candidate.name == parameter.name;
        });
        if (entry == list.end()) {
          throw Error("cfg/Stereo.cfg: the parameter '" + parameter.name +
                      "' is missing or has the wrong type, expected the type of its default " +
                      valueText(parameter.default_value) +
                      " in src/pipeline/parameters.cpp. Add it, or correct its type");
        }
        use(*entry, value);
      },
      parameter.default_value);
}

/// Compares as the core does, which stores real numbers as float.
template <typename Value>
bool sameValue(Value a, Value b) {
  if constexpr (std::is_same_v<Value, double>) {
    return static_cast<float>(a) == static_cast<float>(b);
  }
  return a == b;
}

}  // namespace

void applyConfig(const cbmv_stereo::StereoConfig& config, StereoOptions& options) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  for (const Parameter& parameter : stereoParameters()) {
    withEntry(message, parameter, [&](const auto& entry, auto value) {
      parameter.set(options, static_cast<decltype(value)>(entry.value));
    });
  }
}

void writeConfig(const StereoOptions& options, cbmv_stereo::StereoConfig& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  for (const Parameter& parameter : stereoParameters()) {
    withEntry(message, parameter, [&](auto& entry, auto value) {
      const auto written = std::get<decltype(value)>(parameter.get(options));
      if (!sameValue(static_cast<decltype(value)>(entry.value), written)) {
        entry.value = written;
      }
    });
  }
  config.__fromMessage__(message);
}

float minConfidence(const cbmv_stereo::StereoConfig& config) {
  if (std::isnan(config.min_confidence)) {
    throw Error("min_confidence is not a number, expected 0 to 1. Set a valid value");
  }
  return static_cast<float>(config.min_confidence);
}

std::string presetPath(const std::string& preset) {
  if (preset.empty() || preset == kNoPreset) {
    return {};
  }
  return presetPath(preset, ros::package::getPath("cbmv_stereo") + "/config");
}

void applyPreset(const std::string& preset, StereoOptions& options) {
  const std::string path = presetPath(preset);
  if (!path.empty()) {
    readPreset(path, options);
  }
}

std::string presetOf(const std::string& preset, const StereoOptions& options) {
  StereoOptions made = options;
  try {
    applyPreset(preset, made);
  } catch (const Error&) {
    return kNoPreset;  // the file no longer exists
  }
  correctOptions(made);
  return describeOptions(made) == describeOptions(options) && !preset.empty() ? preset : kNoPreset;
}

std::vector<std::string> offerParameters(const StereoOptions& options,
                                         ros::NodeHandle& private_nh) {
  std::vector<std::string> differences;
  for (const Parameter& parameter : stereoParameters()) {
    std::visit(
        [&](auto default_value) {
          const auto value = std::get<decltype(default_value)>(parameter.get(options));
          auto present = value;
          if (private_nh.getParam(parameter.name, present)) {
            if (!sameValue(present, value)) {
              differences.push_back(private_nh.resolveName(parameter.name) + " = " +
                                    valueText(present) + " on the parameter server overrides " +
                                    valueText(value));
            }
          } else if (!sameValue(value, default_value)) {
            private_nh.setParam(parameter.name, value);
          }
        },
        parameter.default_value);
  }
  return differences;
}

std::vector<std::string> describeUnknownNames(const ros::NodeHandle& private_nh,
                                              const std::string& arguments) {
  std::vector<std::string> of_method;
  for (const auto& description : cbmv_stereo::StereoConfig::__getParamDescriptions__()) {
    of_method.push_back(description->name);
  }
  std::vector<std::string> all = namesOf(stereoPrivateParameters());
  all.insert(all.end(), of_method.begin(), of_method.end());
  all.insert(all.end(), kStockOnly.begin(),
             kStockOnly.end());  // handled by describeForeignParameters
  auto messages = describeUnknownParameters(private_nh, all);
  for (auto& message : describeUnknownArguments(arguments, of_method)) {
    messages.push_back(std::move(message));
  }
  return messages;
}

std::vector<std::string> describeForeignParameters(const ros::NodeHandle& private_nh) {
  std::vector<std::string> messages;
  for (const Parameter& parameter : stereoParameters()) {
    double value = 0;
    if (private_nh.getParam(parameter.name, value) &&
        !(value >= parameter.lowest && value <= parameter.highest)) {
      std::ostringstream message;
      message << private_nh.resolveName(parameter.name) << " is " << value << ", expected "
              << rangeText(parameter.lowest, parameter.highest)
              << ". The nearest valid value is used. Units may differ from stereo_image_proc";
      messages.push_back(message.str());
    }
  }
  for (const char* name : kStockOnly) {
    if (private_nh.hasParam(name)) {
      messages.push_back(private_nh.resolveName(name) +
                         " is a parameter of stereo_image_proc that cbmv_stereo does not have. It "
                         "is ignored; remove it");
    }
  }
  return messages;
}

}  // namespace cbmv
