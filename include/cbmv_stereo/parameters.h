#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "cbmv_stereo/export.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// A parameter's value: switches, whole numbers and real numbers.
using ParameterValue = std::variant<bool, int, double>;

/// The value as presets have it.
CBMV_API std::string valueText(const ParameterValue& value);

/// One field of StereoOptions as users see it: in presets, on the command line, in the parameter
/// server and in dynamic_reconfigure, always under the same name.
struct Parameter {
  std::string name;
  std::string unit;  ///< "px", "s", …; empty for switches, counts and ratios
  std::string description;
  ParameterValue default_value;
  double lowest = 0;   ///< of numbers, inclusive
  double highest = 0;  ///< of numbers, inclusive
  std::function<ParameterValue(const StereoOptions&)> get;
  /// Throws Error if the value is of another type than default_value (int for double is accepted)
  /// or outside of [lowest, highest].
  std::function<void(StereoOptions&, const ParameterValue&)> set;
};

/// What the parameter does, with its unit in brackets.
CBMV_API std::string describe(const Parameter& parameter);

/// All parameters, in the order of the data flow.
CBMV_API std::vector<Parameter> stereoParameters();

/// The parameter of that name. Throws Error that names it if there is none.
CBMV_API Parameter findParameter(const std::string& name);

/// "name = value unit" lines of all parameters, for logs.
CBMV_API std::string describeOptions(const StereoOptions& options);

/// Mends what is inconsistent among the values (each of them inside of its own range): P1 > P2, an
/// even median window, penalties too large for 16-bit sums. Returns one sentence per mend that says
/// what was changed, to what, and why; empty when nothing was.
CBMV_API std::vector<std::string> correctOptions(StereoOptions& options);

/// Reads a preset: a YAML map from parameter names to values. What it does not name keeps the value
/// in `options`. Throws Error that names the file and, where there is one, the key.
CBMV_API void readPreset(const std::string& path, StereoOptions& options);

}  // namespace cbmv
