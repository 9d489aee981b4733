#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/parameters.h"

namespace cbmv {

/// The parameters in a preset: cost aggregation, SGM and refinement. The others describe the camera
/// or change the matching cost volume.
std::vector<Parameter> presetParameters();

/// Parameters that are searched by default.
std::vector<std::string> defaultSearchParameters();

/// The searched parameters as a unit cube with coordinates in [0, 1]. Each axis is linear or
/// logarithmic between search bounds that lie inside the bounds of the parameter.
class ParameterSpace {
 public:
  /// Throws Error if the list is empty, or with the parameter that cannot be searched or is given
  /// twice.
  explicit ParameterSpace(const std::vector<std::string>& parameters);

  std::size_t dimensions() const { return axes_.size(); }

  /// Values outside the bounds are clamped.
  std::vector<double> coordinates(const StereoOptions& options) const;

  /// `others` with the searched parameters set from `coordinates`: integers are rounded, median
  /// windows are rounded to odd numbers, real numbers to three digits. correctOptions makes the
  /// result consistent.
  StereoOptions optionsAt(const std::vector<double>& coordinates,
                          const StereoOptions& others) const;

  /// Initial steps of a local search: large enough to reach the next integer.
  std::vector<double> firstSteps() const;

 private:
  struct Axis {
    Parameter parameter;
    double lowest = 0;
    double highest = 0;
    double step = 0;  ///< values are lowest + k · step; 0: real numbers
    bool logarithmic = false;
  };

  static Axis findAxis(const std::string& name);
  static double valueAt(const Axis& axis, double coordinate);

  std::vector<Axis> axes_;
};

}  // namespace cbmv
