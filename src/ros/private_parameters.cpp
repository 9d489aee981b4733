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
  return {{"queue_size", 5, 1, 1000, "messages",
           "Messages of each input that may wait for their partners"},
          {"approximate_sync", false, 0, 0, "", "Pair messages whose stamps are close, not equal"},
          {"approximate_sync_max_interval_s", 0.1, 0, 3600, "s",
           "With approximate_sync: stamps farther apart are never paired; 0: no bound"},
          {"image_transport", std::string("raw"), 0, 0, "",
           "Transport by which the images are received"}};
}

std::vector<PrivateParameter> topicParameters() {
  return {
      {"left_image_topic", std::string("left/image_rect"), 0, 0, "", "Topic of the left image"},
      {"left_info_topic", std::string("left/camera_info"), 0, 0, "", "Its camera_info"},
      {"right_image_topic", std::string("right/image_rect"), 0, 0, "", "Topic of the right image"},
      {"right_info_topic", std::string("right/camera_info"), 0, 0, "", "Its camera_info"},
      {"left_color_topic", std::string("left/image_rect_color"), 0, 0, "",
       "Topic of the image that colors the cloud"}};
}

std::vector<PrivateParameter> cloudParameters() {
  return {{"points_min_depth_m", 0.0, 0, kMostDepthM, "m", "Nearer points (Z) are missing"},
          {"points_max_depth_m", 0.0, 0, kMostDepthM, "m",
           "Points farther away (Z) are missing; 0: no limit"},
          {"points_compact", false, 0, 0, "",
           "16 bytes a point, rgb at byte 12, in place of the 32 bytes that PCL's types have"}};
}

std::vector<PrivateParameter> limitParameters() {
  return {{"warn_silence_s", 3.0, 0.1, 3600, "s",
           "Diagnostics: without a pair for longer while an output is wanted is an error"},
          {"warn_age_s", 1.0, 0, 3600, "s",
           "Diagnostics: results that are older when published are a warning; 0: no bound"},
          {"warn_vertical_offset_px", 1.0, 0, 16, "px",
           "Diagnostics and log: warn where rows are farther apart (root mean square over the "
           "image): the rig has lost its calibration; 0: no bound"}};
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
    return "a text";
  }
}

std::string numberText(double value) {
  std::ostringstream text;
  text.precision(10);  // 1000000, not 1e+06
  text << value;
  return text.str();
}

template <typename Value>
void requireRange([[maybe_unused]] const std::string& name, [[maybe_unused]] Value value,
                  [[maybe_unused]] const PrivateParameter& parameter) {
  if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
    if (!(value >= parameter.lowest && value <= parameter.highest)) {
      throw Error(name + " is " + numberText(value) + ", expected " +
                  rangeText(parameter.lowest, parameter.highest) +
                  (parameter.unit.empty() ? "" : " " + parameter.unit));
    }
  }
}

}  // namespace

std::string rangeText(double lowest, double highest) {
  return numberText(lowest) + " to " + numberText(highest);
}

std::vector<PrivateParameter> stereoPrivateParameters() {
  std::vector<PrivateParameter> table = {
      {"forest", std::string(), 0, 0, "",
       "File of the forest; without one the nodelet does not come up (the launch files give "
       "models/middlebury_small.forest)"},
      {"preset", std::string(), 0, 0, "",
       "Name of a file in config/ without its ending, or path of a YAML file; private parameters "
       "win "
       "over it"},
      {"threads", 0, 0, 1024, "threads", "0: as many as the machine has"},
      {"allow_different_frame_ids", true, 0, 0, "",
       "Accept pairs whose images differ in frame_id; outputs have the left one's"}};
  append(topicParameters(), table);
  append(syncParameters(), table);
  append(cloudParameters(), table);
  append(limitParameters(), table);
  table.push_back(
      {"points_confidence", false, 0, 0, "", "Give the points of the cloud a field `confidence`"});
  table.push_back({"points_sigma", false, 0, 0, "",
                   "Give the points of the cloud a field `sigma`: `depth_sigma` of the point, in "
                   "meters; NaN without a second forest"});
  table.push_back(
      {"unknown_arguments", std::string(), 0, 0, "",
       "Set by the launch files: arguments that they were given and do not have, a colon, those "
       "that they have; the node warns of the former"});
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
    throw Error(resolved + " has a value of the wrong type, expected " + typeName<Value>());
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
    throw std::logic_error("no private parameter is called " + name);
  }
  return *found;
}

}  // namespace cbmv
