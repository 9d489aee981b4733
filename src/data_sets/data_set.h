#pragma once

#include <memory>
#include <string>
#include <vector>

#include "data_sets/stereo_scene.h"

namespace cbmv {

class SceneReader;

/// Whether the scenes of a data set must have true disparities.
enum class Truth { kRequired, kOptional };

/// Pairs with ground truth in one of these layouts. A scene's `truth` holds all that is known,
/// `visible` the part of it that both cameras see.
///
/// - middlebury_v3: SCENE/ of readMiddleburyScene, also of 2014 in full size. ndisp from calib.txt.
/// - middlebury_2005, middlebury_2005_half, middlebury_2005_full (2006 too; third, half and full
///   size): SCENE/view1.png (left), view5.png (right), disp1.png (value / 3, 2 or 1; 0 unknown).
///   Visible: where disp5.png, the truth of view5, agrees within 1 px; without that file
///   visibleInBoth(truth). 85, 128 or 255 disparities. It is an Error where images are too wide for
///   the size, or gray values tell that the truth is of another one.
/// - kitti2012: image_0/SCENE.png (left), image_1 (right), disp_noc (value / 256, 0 unknown; the
///   visible pixels) and, where it is there, disp_occ, the truth of all pixels. 228 disparities.
/// - kitti2015: the same with image_2, image_3, disp_noc_0, disp_occ_0.
/// - eth3d: as middlebury_v3; 64 disparities where calib.txt has no ndisp.
/// - list: a text file of lines `left right disparity scale [ndisp]`, `#` begins a comment, paths
///   relative to the file and without blanks. disparity is read by readDisparity, scale is its
///   divisor. Visible: visibleInBoth(truth). Without ndisp, just what the truth needs. A scene is
///   called as the left file without extension, with '_' for '/'.
///
/// With Truth::kOptional the test scenes of the benchmarks can be read too: Middlebury v3 and ETH3D
/// without disp0GT.pfm or disp0.pfm, and KITTI without a folder of the visible truth, where the
/// scenes are the NNNNNN_10.png of the left images. The other kinds always need the truth.
///
/// Ranges that are the same for a whole kind are cut to the width of the image. Copies share what
/// they hold; reading from several threads is safe.
class DataSet {
 public:
  /// `kind_and_folder` is KIND:DIR, or list:FILE. Throws Error naming it when there is no such kind
  /// or folder, no scene in it, or the list is malformed.
  static DataSet open(const std::string& kind_and_folder, Truth truth = Truth::kRequired);

  const std::string& name() const { return name_; }  ///< as given to open, for messages
  const std::string& kind() const { return kind_; }
  const std::string& folder() const { return folder_; }               ///< or the list
  const std::string& title() const { return title_; }                 ///< for people, without paths
  const std::vector<std::string>& scenes() const { return scenes_; }  ///< names, sorted

  /// Throws Error naming the scene or file that is missing, malformed, of another size than the
  /// left image, or has more disparities than columns.
  StereoScene read(const std::string& scene) const;

  /// Weight of the scene in the official average: 0.5 for PianoL, Playroom, Playtable, Shelves and
  /// Vintage of Middlebury v3, else 1.
  double weight(const std::string& scene) const;

  /// Largest error of a disparity, px, that still counts as correct where confidences are measured:
  /// 3 for KITTI, whose truth is not better, else 1.
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

/// Which scenes a user wants.
struct SceneFilter {
  std::vector<std::string> only;      ///< these; empty: all
  std::vector<std::string> excluded;  ///< none of these
};

/// A scene of one of several data sets.
struct SceneReference {
  DataSet data_set;
  std::string scene;

  StereoScene read() const { return data_set.read(scene); }
};

/// The scenes that the filter lets through, in the order of the data sets, by name in each. Throws
/// Error when the filter names a scene that no data set has, or nothing is left.
std::vector<SceneReference> chooseScenes(const std::vector<DataSet>& data_sets,
                                         const SceneFilter& filter);

}  // namespace cbmv
