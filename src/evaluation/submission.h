#pragma once

#include <string>

#include "data_sets/data_set.h"
#include "data_sets/stereo_scene.h"
#include "evaluation/scene_score.h"

namespace cbmv {

struct SubmissionFormat;

/// Writes disparity maps into a folder. Zip its content to get an upload for the benchmark:
///
/// - Middlebury v3: trainingQ/SCENE/disp0CBMV.pfm, or disp0CBMV_s.pfm if some pixels have no
///   disparity (infinity), and timeCBMV.txt with the time in seconds. testQ/ for all but the 15
///   training scenes. The last letter (Q, H or F: the resolution) comes from the name of the data
///   set's folder.
/// - KITTI 2012: NNNNNN_10.png, 16 bits, disparity · 256 rounded, 0 = none. A disparity that would
///   round to 0 or below is written as 1.
/// - KITTI 2015: the same in disp_0/.
/// - ETH3D: low_res_two_view/SCENE.pfm (infinity = none) and SCENE.txt with "runtime" and the
///   seconds.
class SubmissionWriter {
 public:
  /// Throws Error when no benchmark accepts this kind of data set, or the folder of a Middlebury v3
  /// data set is not named after its resolution.
  SubmissionWriter(const DataSet& data_set, const std::string& folder);

  /// The time must be known, except for KITTI. Throws Error with the file that cannot be written.
  void write(const StereoScene& scene, const SceneMaps& maps) const;

  /// Whether the scene was written, by this or an earlier run.
  bool has(const std::string& scene) const;

 private:
  std::string pathOf(const std::string& scene, const std::string& ending) const;

  const SubmissionFormat* format_;
  std::string folder_;
  char resolution_ = ' ';  ///< for Middlebury v3
};

}  // namespace cbmv
