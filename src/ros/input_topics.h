#pragma once

#include <array>
#include <string>

#include <ros/node_handle.h>

#include "ros/private_parameters.h"
#include "ros/sync_monitor.h"

// Determines the input topics of a nodelet.

namespace cbmv {

/// Topic names, indexed by InputIndex.
using TopicNames = std::array<std::string, kInputs>;

/// Returns the name of an input: `name` if it is remapped, else the value `configured` of the
/// parameter. So remaps also work around a launch file that sets the parameter.
std::string inputName(const ros::NodeHandle& nh, const std::string& name,
                      const std::string& configured);

/// Input names of cbmv_stereo/stereo, absolute or relative to the nodelet's namespace.
TopicNames stereoInputNames(const ros::NodeHandle& nh, const PrivateParameters& parameters);
/// The same for its color image.
std::string colorInputName(const ros::NodeHandle& nh, const PrivateParameters& parameters);

/// Throws Error if two inputs are the same topic. `names` are resolved.
void requireDifferentTopics(const TopicNames& names);

/// The name to subscribe with. Usually the resolved name, so that the topics of an image transport
/// below it (image/compressed) follow a remap of the image. If the resolved name is itself remapped
/// (left and right exchanged), roscpp would remap it again; the result is then `name`.
std::string nameToSubscribe(const ros::NodeHandle& nh, const std::string& name);

}  // namespace cbmv
