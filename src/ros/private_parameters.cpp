#include "ros/private_parameters.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kMostDepthM = 1e6;

std::vector<PrivateParameter> syncParameters() {
  return {
      {"queue_size", 5, 1, 1000, "messages",
       "Maximum number of messages per input that wait for a partner"},
      {"approximate_sync", false, 0, 0, "", "Pair messages with similar instead of equal stamps"},
      {"approximate_sync_max_interval_s", 0.1, 0, 3600, "s",
       "With approximate_sync: largest stamp difference of a pair; 0: no limit"},
      {"image_transport", std::string("raw"), 0, 0, "", "Image transport of the inputs"}};
}

std::vector<PrivateParameter> topicParameters() {
  return {
      {"left_image_topic", std::string("left/image_rect"), 0, 0, "", "Topic of the left image"},
      {"left_info_topic", std::string("left/camera_info"), 0, 0, "", "Its camera_info"},
      {"right_image_topic", std::string("right/image_rect"), 0, 0, "", "Topic of the right image"},
      {"right_info_topic", std::string("right/camera_info"), 0, 0, "", "Its camera_info"},
      {"left_color_topic", std::string("left/image_rect_color"), 0, 0, "",
       "Topic of the image with the colors of the point cloud"}};
}

std::vector<PrivateParameter> cloudParameters() {
  return {{"points_min_depth_m", 0.0, 0, kMostDepthM, "m", "Nearer points (Z) are NaN"},
          {"points_max_depth_m", 0.0, 0, kMostDepthM, "m",
           "Points farther away (Z) are NaN; 0: no limit"},
          {"points_compact", false, 0, 0, "",
           "Compact layout: 16 bytes per point (more with confidence or sigma), rgb at byte 12; "
           "PCL's layout has 32 bytes"}};
}

std::vector<PrivateParameter> limitParameters() {
  return {{"warn_silence_s", 3.0, 0.1, 3600, "s",
           "Diagnostics: time without a pair, while an output has a subscriber, above which the "
           "status is an error"},
          {"warn_age_s", 1.0, 0, 3600, "s",
           "Diagnostics: mean age of published results above which the status is a warning; 0: no "
           "limit"},
          {"warn_vertical_offset_px", 1.0, 0, 16, "px",
           "Diagnostics and log: residual vertical offset (RMS over the image) above which the "
           "node warns that the calibration has changed; 0: no limit"}};
}

void append(const std::vector<PrivateParameter>& more, std::vector<PrivateParameter>& table) {
  table.insert(table.end(), more.begin(), more.end());
}

template <typename Value>
constexpr const char* typeName() {
  if constexpr (std::is_same_v<Value, bool>) {
    return "true or false";
  } else if constexpr (std::is_same_v<Value, int>) {
    return "a whole number";
  } else if constexpr (std::is_same_v<Value, double>) {
    return "a number";
  } else {
    return "a string";
  }
}

template <typename Value>
void requireRange([[maybe_unused]] const std::string& name, [[maybe_unused]] Value value,
                  [[maybe_unused]] const PrivateParameter& parameter) {
  if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
    if (!(value >= parameter.lowest && value <= parameter.highest)) {
      throw Error(name + " is " + numberText(value) + ", expected " +
                  rangeText(parameter.lowest, parameter.highest) +
                  (parameter.unit.empty() ? "" : " " + parameter.unit) +
                  ". Set a value in this range");
    }
  }
}

}  // namespace

std::string numberText(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

std::string rangeText(double lowest, double highest) {
  return numberText(lowest) + " to " + numberText(highest);
}

std::vector<PrivateParameter> stereoPrivateParameters() {
  std::vector<PrivateParameter> table = {
      {"forest", std::string(), 0, 0, "",
       "Path of the forest file; required (the launch files set models/middlebury_small.forest)"},
      {"preset", std::string(), 0, 0, "",
       "Name of a file in config/ without its ending, or path of a YAML file; private parameters "
       "override it"},
      {"threads", 0, 0, 1024, "threads", "Threads for matching; 0: all hardware threads"},
      {"allow_different_frame_ids", true, 0, 0, "",
       "Accept pairs with different frame_ids; outputs use the left frame_id"}};
  append(topicParameters(), table);
  append(syncParameters(), table);
  append(cloudParameters(), table);
  append(limitParameters(), table);
  table.push_back(
      {"points_confidence", false, 0, 0, "", "Add a field `confidence` to the point cloud"});
  table.push_back({"points_sigma", false, 0, 0, "",
                   "Add a field `sigma` to the point cloud: `depth_sigma` of the point, in meters; "
                   "NaN without a second forest"});
  table.push_back({"unknown_arguments", std::string(), 0, 0, "",
                   "Set by the launch files: unknown arguments, a colon, all declared arguments; "
                   "the node warns about the unknown ones"});
  return table;
}

std::vector<PrivateParameter> pointCloudPrivateParameters() {
  std::vector<PrivateParameter> table = syncParameters();
  append(cloudParameters(), table);
  return table;
}

std::vector<std::string> namesOf(const std::vector<PrivateParameter>& table) {
  std::vector<std::string> names;
  std::transform(table.begin(), table.end(), std::back_inserter(names),
                 [](const PrivateParameter& parameter) { return parameter.name; });
  return names;
}

PrivateParameters::PrivateParameters(const ros::NodeHandle& private_nh,
                                     std::vector<PrivateParameter> table)
    : private_nh_(private_nh), table_(std::move(table)) {}

template <typename Value>
Value PrivateParameters::get(const std::string& name) const {
  const PrivateParameter& parameter = find(name);
  auto value = std::get<Value>(parameter.default_value);
  const std::string resolved = private_nh_.resolveName(name);
  if (private_nh_.hasParam(name) && !private_nh_.getParam(name, value)) {
    throw Error(resolved + " has a value of the wrong type, expected " + typeName<Value>() +
                ". Correct it, for example in the launch file");
  }
  requireRange(resolved, value, parameter);
  return value;
}

template bool PrivateParameters::get<bool>(const std::string&) const;
template int PrivateParameters::get<int>(const std::string&) const;
template double PrivateParameters::get<double>(const std::string&) const;
template std::string PrivateParameters::get<std::string>(const std::string&) const;

const PrivateParameter& PrivateParameters::find(const std::string& name) const {
  const auto found = std::find_if(table_.begin(), table_.end(),
                                  [&](const auto& parameter) { return parameter.name == name; });
  if (found == table_.end()) {
    throw std::logic_error("there is no private parameter " + name);
  }
  return *found;
}

}  // namespace cbmv
