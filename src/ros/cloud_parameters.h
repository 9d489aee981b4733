#pragma once

#include "ros/point_cloud.h"
#include "ros/private_parameters.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

/// Reads the private parameters points_…, except those for confidence and sigma, which not every
/// nodelet has. Throws Error if the limits exclude every point.
inline CloudOptions readCloudOptions(const PrivateParameters& parameters) {
  CloudOptions options;
  options.min_depth_m = parameters.get<double>("points_min_depth_m");
  options.max_depth_m = parameters.get<double>("points_max_depth_m");
  options.compact = parameters.get<bool>("points_compact");
  if (options.max_depth_m != 0 && options.max_depth_m <= options.min_depth_m) {
    throw Error(
        parameters.nodeHandle().resolveName("points_max_depth_m") + " is " +
        numberText(options.max_depth_m) + ", expected more than points_min_depth_m (" +
        numberText(options.min_depth_m) +
        "): the cloud would be empty. Increase points_max_depth_m, or set it to 0 for no limit");
  }
  return options;
}

}  // namespace cbmv
