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
  /// See parseErrorSum. One for all data sets, or one per data set in their order.
  std::vector<std::string> objectives;
  std::vector<std::string> parameters = defaultSearchParameters();
  StereoOptions start;  ///< range is ignored; threads is used
  std::string start_name = "the defaults";
  SearchSettings search;
  /// Number of rows used per scene, from the middle; 0: all. A strip favors other parameters than
  /// the whole image.
  int rows = 0;
  bool cross_validate = false;  ///< three more searches; Middlebury v3 only
};

/// Callbacks of tune; both must be set.
struct TuningEvents {
  std::function<void(const std::string&)> progress;  ///< a progress message
  std::function<void(const TuningReport&)>
      improved;  ///< best report found until then, first the start
};

/// Searches the parameters after the matching cost volume for the lowest error over the
/// non-occluded pixels. The objective of one data set is the mean error over its scenes divided by
/// that of the start; for several data sets, the mean of these.
///
/// Cross-validation repeats the search without each fold of middleburyFolds and scores that fold
/// with the parameters found. It shows how well the parameters generalize to unseen scenes.
///
/// Throws Error with the invalid part of the request, the scene or the file.
TuningReport tune(const TuningRequest& request, const TuningEvents& events);

}  // namespace cbmv
