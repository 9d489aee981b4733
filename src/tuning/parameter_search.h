#pragma once

#include <cstdint>
#include <functional>

#include "tuning/parameter_space.h"

#include "cbmv_stereo/options.h"

namespace cbmv {

struct SearchSettings {
  int evaluations = 200;       ///< of the objective, that of the start included; at least 1
  int global_evaluations = 0;  ///< so many of them look all over the space first
  std::uint64_t seed = 1;      ///< of the global part
};

struct SearchPoint {
  StereoOptions options;
  double score = 0;  ///< lower is better
};

using Objective = std::function<double(const StereoOptions&)>;

/// Called after each evaluation: which one (from 1 on), where, and the best so far, this one
/// included.
using SearchProgress =
    std::function<void(int evaluation, const SearchPoint& here, const SearchPoint& best)>;

/// Looks for the lowest objective without derivatives, by NLopt: DIRECT-L (Gablonsky & Kelley 2001)
/// over the whole space, if asked for, then Subplex (Rowan 1990) from the best point so far. The
/// first evaluation is of `start` as it is, so the result is never worse. Options that were
/// evaluated already are not evaluated again. Deterministic. Passes on what `objective` and
/// `progress` throw; throws Error when the settings are out of range.
SearchPoint searchParameters(const ParameterSpace& space, const StereoOptions& start,
                             const Objective& objective, const SearchSettings& settings,
                             const SearchProgress& progress);

}  // namespace cbmv
