#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>

#include "cbmv_stereo/options.h"
#include <cbmv_stereo/StereoConfig.h>

// StereoOptions and the parameters of cfg/Stereo.cfg, matched by name through stereoParameters().

namespace cbmv {

/// Sets every parameter of `options` from `config`. Throws Error if a name of the table is not in
/// cfg/Stereo.cfg, or a value is refused (dynamic_reconfigure does not clamp NaN).
void applyConfig(const cbmv_stereo::StereoConfig& config, StereoOptions& options);

/// The opposite direction: writes every parameter of `options` into `config`.
void writeConfig(const StereoOptions& options, cbmv_stereo::StereoConfig& config);

/// The entry min_confidence, which is about publishing and no option of the method. Throws Error if
/// it is not a number.
float minConfidence(const cbmv_stereo::StereoConfig& config);

/// The entry preset of a configuration that takes its values from none.
inline constexpr const char* kNoPreset = "custom";

/// The file of a preset: empty for kNoPreset and for nothing, else as presets.h says, with the
/// names of config/ of this package. Throws Error that lists the names if there is none.
std::string presetPath(const std::string& preset);

/// Sets what the preset names. Throws Error that names the file (readPreset), or that lists the
/// names that there are.
void applyPreset(const std::string& preset, StereoOptions& options);

/// `preset`, or kNoPreset if `options` are not what it makes of them.
std::string presetOf(const std::string& preset, const StereoOptions& options);

/// Makes `options` (from a preset) the parameters' values on the parameter server, except where
/// there already is one: that one is explicit and wins. Returns one sentence for each that differs.
std::vector<std::string> offerParameters(const StereoOptions& options, ros::NodeHandle& private_nh);

/// One sentence for each private parameter that is not taken as it is on the parameter server: out
/// of its range here (stereo_image_proc's P1 and P2 have other units), or one of
/// stereo_image_proc's that has no meaning here.
std::vector<std::string> describeForeignParameters(const ros::NodeHandle& private_nh);

/// One sentence for each private parameter that the nodelet cbmv_stereo/stereo does not know, and
/// for each argument that the launch file does not (describeUnknownArguments).
std::vector<std::string> describeUnknownNames(const ros::NodeHandle& private_nh,
                                              const std::string& arguments);

}  // namespace cbmv
