#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>

namespace cbmv {

/// One message per parameter directly below the namespace of `private_nh` that is neither in
/// `known` nor read by the libraries of the nodelet. It suggests the nearest known name.
std::vector<std::string> describeUnknownParameters(const ros::NodeHandle& private_nh,
                                                   const std::vector<std::string>& known);

/// One message per launch file argument that the launch file does not declare; roslaunch ignores
/// these. `arguments`: the given arguments, a colon, and all declared arguments, separated by
/// blanks. `parameters` can be set as parameters, but not as arguments.
std::vector<std::string> describeUnknownArguments(const std::string& arguments,
                                                  const std::vector<std::string>& parameters);

/// The name with the smallest Levenshtein distance to `name`; `names` must not be empty.
std::string nearestName(const std::string& name, const std::vector<std::string>& names);

}  // namespace cbmv
