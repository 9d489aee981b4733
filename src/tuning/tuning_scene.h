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

/// Sum of error metrics to minimize.
struct ErrorSum {
  std::string name;                  ///< as given, for example bad_1+bad_4
  std::vector<std::size_t> metrics;  ///< indices in kMetrics

  double of(const MetricValues& values) const;
};

/// Parses `name`: one of the first kErrorMetrics of kMetrics, or several joined by +. Throws Error
/// with the list of valid names.
ErrorSum parseErrorSum(const std::string& name);

/// The first forest that was not trained on the scene, compared by name and data set. Throws Error
/// with the scene when there is none: a forest trained on the scene matches it better than unseen
/// scenes, so the tuned parameters would not generalize.
std::shared_ptr<const Forest> forestForScene(
    const std::vector<std::shared_ptr<const Forest>>& forests, const SceneReference& scene);

/// A scene and the forest that matches it.
struct TuningScene {
  std::size_t data_set = 0;  ///< any number that identifies the data set
  ErrorSum errors;           ///< what is minimized
  StereoScene scene;         ///< the right image is rectified; without left_color
  std::shared_ptr<const Forest> forest;

  double heldMb() const;  ///< memory in use, MB
};

/// Aligns the pair according to `rectification`. If rows > 0, keeps only this number of rows from
/// the middle of the scene, to save time. Throws Error with the scene or file. Also throws Error if
/// the machine has not enough memory for the scene in addition to `held_mb`, the memory of earlier
/// scenes.
TuningScene prepareScene(const SceneReference& scene, const std::shared_ptr<const Forest>& forest,
                         const RectificationOptions& rectification, int rows, double held_mb = 0);

/// Scores scenes; holds one matcher per forest.
class TuningScorer {
 public:
  /// The scene's error sum over the non-occluded pixels, with these options over the scene's own
  /// disparity range. Throws Error with the scene when it has no known true disparity there.
  double error(const TuningScene& scene, const StereoOptions& options);

 private:
  std::map<std::shared_ptr<const Forest>, std::unique_ptr<StereoMatcher>> matchers_;
};

}  // namespace cbmv
