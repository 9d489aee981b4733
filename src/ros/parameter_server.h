#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>

#include "cbmv_stereo/options.h"
#include <cbmv_stereo/StereoConfig.h>

// Maps StereoOptions to the parameters of cfg/Stereo.cfg by name (stereoParameters()).

namespace cbmv {

/// Sets every parameter of `options` from `config`. Throws Error if a parameter is missing in
/// cfg/Stereo.cfg or a value is invalid (dynamic_reconfigure does not clamp NaN).
void applyConfig(const cbmv_stereo::StereoConfig& config, StereoOptions& options);

/// Writes every parameter of `options` into `config`.
void writeConfig(const StereoOptions& options, cbmv_stereo::StereoConfig& config);

/// The value min_confidence, which affects publishing and is not part of StereoOptions. Throws
/// Error if it is not a number.
float minConfidence(const cbmv_stereo::StereoConfig& config);

/// Value of `preset` in a configuration without a preset.
inline constexpr const char* kNoPreset = "custom";

/// Path of a preset file; empty for kNoPreset and for the empty string. See presets.h for the
/// rules; names refer to config/ of this package. Throws Error with the list of names if the preset
/// does not exist.
std::string presetPath(const std::string& preset);

/// Sets the values of the preset. Throws Error with the file (readPreset) or with the list of
/// preset names.
void applyPreset(const std::string& preset, StereoOptions& options);

/// `preset` if it yields exactly `options`, else kNoPreset.
std::string presetOf(const std::string& preset, const StereoOptions& options);

/// Sets the values of `options` (from a preset) on the parameter server, except parameters that are
/// already set: explicit values win. Returns one message per parameter whose explicit value
/// differs.
std::vector<std::string> offerParameters(const StereoOptions& options, ros::NodeHandle& private_nh);

/// One message per private parameter whose value is not used as set: it is outside its range (P1
/// and P2 of stereo_image_proc have other units), or it is a parameter of stereo_image_proc that
/// does not exist here.
std::vector<std::string> describeForeignParameters(const ros::NodeHandle& private_nh);

/// One message per private parameter that the nodelet cbmv_stereo/stereo does not know, and per
/// unknown launch file argument (describeUnknownArguments).
std::vector<std::string> describeUnknownNames(const ros::NodeHandle& private_nh,
                                              const std::string& arguments);

}  // namespace cbmv
