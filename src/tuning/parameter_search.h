#pragma once

#include <cstdint>
#include <functional>

#include "tuning/parameter_space.h"

#include "cbmv_stereo/options.h"

namespace cbmv {

struct SearchSettings {
  int evaluations = 200;       ///< evaluations of the objective, including the start; at least 1
  int global_evaluations = 0;  ///< number of evaluations spent on the global search
  std::uint64_t seed = 1;      ///< of the global search
};

struct SearchPoint {
  StereoOptions options;
  double score = 0;  ///< lower is better
};

using Objective = std::function<double(const StereoOptions&)>;

/// Called after each evaluation with its number (from 1), its point, and the best point found until
/// then, including this one.
using SearchProgress =
    std::function<void(int evaluation, const SearchPoint& here, const SearchPoint& best)>;

/// Minimizes the objective without derivatives, by NLopt: DIRECT-L (Gablonsky & Kelley 2001) over
/// the whole space if global_evaluations is above 0, then Subplex (Rowan 1990) from the best point.
/// The first evaluation uses `start` unchanged, so the result is never worse than the start. No
/// options are evaluated twice. Deterministic. Exceptions of `objective` and `progress` are passed
/// on. Throws Error when the settings are out of range.
SearchPoint searchParameters(const ParameterSpace& space, const StereoOptions& start,
                             const Objective& objective, const SearchSettings& settings,
                             const SearchProgress& progress);

}  // namespace cbmv
