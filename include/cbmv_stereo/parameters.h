#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "cbmv_stereo/export.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// The value of a parameter: a switch, an integer or a real number.
using ParameterValue = std::variant<bool, int, double>;

/// Formats a value as presets do.
CBMV_API std::string valueText(const ParameterValue& value);

/// One field of StereoOptions as users see it. It has the same name in presets, on the command
/// line, on the parameter server and in dynamic_reconfigure.
struct Parameter {
  std::string name;
  std::string unit;  ///< "px", "s", …; empty for switches, counts and ratios
  std::string description;
  ParameterValue default_value;
  double lowest = 0;   ///< numbers only, inclusive
  double highest = 0;  ///< numbers only, inclusive
  std::function<ParameterValue(const StereoOptions&)> get;
  /// Throws Error if the type differs from the type of default_value (int is accepted for double),
  /// or if the value is outside of [lowest, highest].
  std::function<void(StereoOptions&, const ParameterValue&)> set;
};

/// The description with the unit in brackets.
CBMV_API std::string describe(const Parameter& parameter);

/// All parameters, in the order of the data flow.
CBMV_API std::vector<Parameter> stereoParameters();

/// Returns the parameter with this name. Throws Error with the name if it does not exist.
CBMV_API Parameter findParameter(const std::string& name);

/// Lists all parameters for logs, one "name = value unit" per line.
CBMV_API std::string describeOptions(const StereoOptions& options);

/// Corrects values that are within their ranges but inconsistent: P1 > P2, an even median window,
/// penalties too large for 16-bit sums. Returns one message per correction: what was changed, to
/// which value, and why. Empty if nothing was changed.
CBMV_API std::vector<std::string> correctOptions(StereoOptions& options);

/// Reads a preset: a YAML map from parameter names to values. Parameters that it does not name keep
/// their value in `options`. Throws Error that names the file and, if known, the key.
CBMV_API void readPreset(const std::string& path, StereoOptions& options);

}  // namespace cbmv
