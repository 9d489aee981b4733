#pragma once

#include <array>
#include <string>

#include <ros/node_handle.h>

#include "ros/private_parameters.h"
#include "ros/sync_monitor.h"

// Which topics the inputs of a nodelet are.

namespace cbmv {

/// Of each input, by InputIndex.
using TopicNames = std::array<std::string, kInputs>;

/// The name to use for an input that the nodelet calls `name` and a parameter calls `configured`: a
/// remap of `name` wins, so that a launch file which sets the parameter can be included with remaps
/// around it.
std::string inputName(const ros::NodeHandle& nh, const std::string& name,
                      const std::string& configured);

/// The names of the inputs of cbmv_stereo/stereo, relative to the namespace of the nodelet or
/// absolute.
TopicNames stereoInputNames(const ros::NodeHandle& nh, const PrivateParameters& parameters);
/// The same of its colour image.
std::string colorInputName(const ros::NodeHandle& nh, const PrivateParameters& parameters);

/// Throws Error if two of the inputs are one topic. `names` are resolved.
void requireDifferentTopics(const TopicNames& names);

/// The name to subscribe by: the resolved one, so that the topics which an image transport adds
/// below it (image/compressed) follow a remap of the image; `name` itself where the resolved name
/// is remapped in turn (left and right exchanged), which roscpp would follow.
std::string nameToSubscribe(const ros::NodeHandle& nh, const std::string& name);

}  // namespace cbmv
