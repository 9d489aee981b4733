#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "data_sets/data_set.h"
#include "evaluation/scene_score.h"
#include "forest/forest.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {

/// Errors whose sum is lowered.
struct ErrorSum {
  std::string name;                  ///< as given: bad_1+bad_4
  std::vector<std::size_t> metrics;  ///< in kMetrics

  double of(const MetricValues& values) const;
};

/// The errors of `name`: one of the first kErrorMetrics of kMetrics, or several joined by +.
/// Throws Error that lists the names.
ErrorSum parseErrorSum(const std::string& name);

/// The first of the forests that was not trained on the scene, by name and data set. Throws Error
/// that names the scene when there is none: matching by a forest that knows the answer is better
/// than any that the parameters will meet.
std::shared_ptr<const Forest> forestForScene(
    const std::vector<std::shared_ptr<const Forest>>& forests, const SceneReference& scene);

/// A scene, and the forest that matches it.
struct TuningScene {
  std::size_t data_set = 0;  ///< any number that tells the data sets apart
  ErrorSum errors;           ///< what counts
  StereoScene scene;         ///< the right image aligned; without left_color
  std::shared_ptr<const Forest> forest;

  double heldMb() const;  ///< memory that it keeps, MB
};

/// Aligns the pair as the options say. rows > 0: only so many rows from the middle of the scene are
/// kept, to save time. Throws Error that names the scene or file, also
/// where the machine has no memory for the scene beside `held_mb`, what earlier ones keep.
TuningScene prepareScene(const SceneReference& scene, const std::shared_ptr<const Forest>& forest,
                         const RectificationOptions& rectification, int rows, double held_mb = 0);

/// Scores scenes; holds a matcher for each forest.
class TuningScorer {
 public:
  /// The scene's error sum over the non-occluded pixels, with these options over the
  /// scene's own range. Throws Error that names the scene when no true disparity is known there.
  double error(const TuningScene& scene, const StereoOptions& options);

 private:
  std::map<std::shared_ptr<const Forest>, std::unique_ptr<StereoMatcher>> matchers_;
};

}  // namespace cbmv
