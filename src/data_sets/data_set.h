#pragma once

#include <memory>
#include <string>
#include <vector>

#include "data_sets/stereo_scene.h"

namespace cbmv {

class SceneReader;

/// Whether the scenes of a data set must have ground truth.
enum class Truth { kRequired, kOptional };

/// Stereo pairs with ground truth, in one of the layouts below. `truth` of a scene holds all known
/// disparities. `visible` marks those that both cameras see.
///
/// - middlebury_v3: SCENE/ as read by readMiddleburyScene, also the 2014 data sets in full size.
///   The number of disparities is ndisp of calib.txt.
/// - middlebury_2005, middlebury_2005_half, middlebury_2005_full: the 2005 and 2006 data sets in
///   third, half and full size. SCENE/view1.png (left), view5.png (right), disp1.png (disparity =
///   value / 3, 2 or 1; 0 = unknown). A pixel is visible where disp5.png, the truth of view5,
///   agrees within 1 px; without disp5.png, visibleInBoth(truth). 85, 128 or 255 disparities.
///   Throws Error when the images are too wide for the size, or when the gray values show that the
///   truth belongs to another size.
/// - kitti2012: image_0/SCENE.png (left), image_1 (right), disp_noc (disparity = value / 256, 0 =
///   unknown; the visible pixels) and the optional disp_occ, the truth of all pixels. 228
///   disparities.
/// - kitti2015: the same with image_2, image_3, disp_noc_0, disp_occ_0.
/// - eth3d: as middlebury_v3; 64 disparities if calib.txt has no ndisp.
/// - list: a text file with lines `left right disparity scale [ndisp]`; `#` starts a comment. Paths
///   are relative to the file and contain no blanks. readDisparity reads disparity; scale is its
///   divisor. Visible: visibleInBoth(truth). Without ndisp, the smallest range that holds the
///   truth. A scene is named after the left file without extension, with '_' for '/'.
///
/// Truth::kOptional also allows the test scenes of the benchmarks: Middlebury v3 and ETH3D without
/// disp0GT.pfm or disp0.pfm, and KITTI without the folder of visible truth. The KITTI scenes are
/// then the NNNNNN_10.png of the left images. The other kinds always need the truth.
///
/// A number of disparities that is fixed for a kind is limited to the image width. Copies share
/// their data. Reading from several threads is safe.
class DataSet {
 public:
  /// `kind_and_folder` is KIND:DIR or list:FILE. Throws Error with this name if the kind or folder
  /// does not exist, the folder has no scene, or the list is malformed.
  static DataSet open(const std::string& kind_and_folder, Truth truth = Truth::kRequired);

  const std::string& name() const { return name_; }  ///< as given to open, for messages
  const std::string& kind() const { return kind_; }
  const std::string& folder() const { return folder_; }  ///< or the list file
  const std::string& title() const { return title_; }    ///< display name, without paths
  const std::vector<std::string>& scenes() const { return scenes_; }  ///< names, sorted

  /// Throws Error with the scene or file that is missing, malformed, differs in size from the left
  /// image, or has more disparities than columns.
  StereoScene read(const std::string& scene) const;

  /// Weight of the scene in the official average: 0.5 for PianoL, Playroom, Playtable, Shelves and
  /// Vintage of Middlebury v3, otherwise 1.
  double weight(const std::string& scene) const;

  /// Largest disparity error of a correct pixel when confidences are evaluated, px: 3 for KITTI,
  /// whose truth is not more accurate, otherwise 1.
  double correctPx() const { return correct_px_; }

 private:
  DataSet() = default;
  std::string kind_;
  std::string folder_;
  std::string title_;
  std::string name_;
  double correct_px_ = 1.0;
  std::vector<std::string> scenes_;
  std::shared_ptr<const SceneReader> reader_;
};

/// Selects scenes by name.
struct SceneFilter {
  std::vector<std::string> only;      ///< only these; empty: all
  std::vector<std::string> excluded;  ///< without these
};

/// A scene and its data set.
struct SceneReference {
  DataSet data_set;
  std::string scene;

  StereoScene read() const { return data_set.read(scene); }
};

/// The scenes that pass the filter, in the order of the data sets, sorted by name within each.
/// Throws Error when the filter names a scene that no data set has, or when no scene is left.
std::vector<SceneReference> chooseScenes(const std::vector<DataSet>& data_sets,
                                         const SceneFilter& filter);

}  // namespace cbmv
