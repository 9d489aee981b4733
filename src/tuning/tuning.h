#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "data_sets/data_set.h"
#include "forest/forest.h"
#include "tuning/parameter_search.h"
#include "tuning/tuning_report.h"

#include "cbmv_stereo/options.h"

namespace cbmv {

struct TuningRequest {
  std::vector<SceneReference> scenes;
  std::vector<std::shared_ptr<const Forest>> forests;  ///< see forestForScene
  /// See parseErrorSum; one for all data sets, or one for each in their order.
  std::vector<std::string> objectives;
  std::vector<std::string> parameters = defaultSearchParameters();
  StereoOptions start;  ///< its range is not used; threads are
  std::string start_name = "the defaults";
  SearchSettings search;
  /// Of each scene, from its middle; 0: all. A strip favours other parameters than the whole image.
  int rows = 0;
  bool cross_validate = false;  ///< three more searches; of Middlebury v3 only
};

/// What a tuning tells while it runs; both must be set.
struct TuningEvents {
  std::function<void(const std::string&)> progress;   ///< a line for people
  std::function<void(const TuningReport&)> improved;  ///< the best so far, the start at first
};

/// Searches the parameters that follow the matching volume for the lowest error over the
/// non-occluded pixels: the mean over the scenes of a data set, relative to that of the start; of
/// several data sets, the mean of these.
///
/// Cross-validation searches anew without each of middleburyFolds and scores its scenes with what
/// was found: what the search is worth on scenes that it has not seen.
///
/// Throws Error that names what is wrong with the request, a scene or a file.
TuningReport tune(const TuningRequest& request, const TuningEvents& events);

}  // namespace cbmv
