#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/parameters.h"

namespace cbmv {

/// The parameters that a preset holds: those of optimization and refinement. The others describe
/// the camera, or change the matching volume.
std::vector<Parameter> presetParameters();

/// What is searched when nothing else is asked for.
std::vector<std::string> defaultSearchParameters();

/// The parameters that are searched, as a cube of coordinates in [0, 1]: linear or logarithmic
/// between the bounds of the search, which lie inside of those of the parameter.
class ParameterSpace {
 public:
  /// Throws Error that names a parameter that cannot be searched, or is given twice, or says that
  /// there is none.
  explicit ParameterSpace(const std::vector<std::string>& parameters);

  std::size_t dimensions() const { return axes_.size(); }

  /// Values outside of the bounds become the nearest bound.
  std::vector<double> coordinates(const StereoOptions& options) const;

  /// `others` with the parameters at these coordinates: whole numbers rounded, median windows to
  /// odd ones, real numbers to three digits; made consistent by correctOptions.
  StereoOptions optionsAt(const std::vector<double>& coordinates,
                          const StereoOptions& others) const;

  /// Steps to begin a local search with: no whole number is too far away for one.
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
