#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>

namespace cbmv {

/// One sentence for each parameter right below the namespace of `private_nh` that is neither
/// `known` nor one that the libraries of the nodelet read; it names the nearest known name.
std::vector<std::string> describeUnknownParameters(const ros::NodeHandle& private_nh,
                                                   const std::vector<std::string>& known);

/// One sentence for each argument that a launch file was given and does not have: roslaunch ignores
/// them. `arguments` is what the launch file says: those, a colon, and all that it has, separated
/// by blanks. `parameters` can be set, but not by an argument.
std::vector<std::string> describeUnknownArguments(const std::string& arguments,
                                                  const std::vector<std::string>& parameters);

/// The name that takes the fewest changes (Levenshtein: a character added, left out or replaced)
/// to make of `name`; `names` is not empty.
std::string nearestName(const std::string& name, const std::vector<std::string>& names);

}  // namespace cbmv
