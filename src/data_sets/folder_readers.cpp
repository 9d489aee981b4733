// Data sets that are a folder: Middlebury v3, ETH3D, KITTI.

#include <filesystem>
#include <utility>

#include "data_sets/middlebury_scene.h"
#include "data_sets/scene_files.h"
#include "data_sets/scene_reader.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr int kEth3dDisparities = 64;
constexpr int kKittiDisparities = 228;
constexpr double kKittiDivisor = 256.0;

class MiddleburyReader : public SceneReader {
 public:
  MiddleburyReader(fs::path folder, int default_disparities, Truth truth)
      : folder_(std::move(folder)), default_disparities_(default_disparities), truth_(truth) {}

  std::vector<std::string> scenes() const override {
    return listMiddleburyScenes(folder_.string());
  }

  StereoScene read(const std::string& scene) const override {
    return readMiddleburyScene((folder_ / scene).string(), default_disparities_,
                               truth_ == Truth::kRequired);
  }

 private:
  fs::path folder_;
  int default_disparities_;
  Truth truth_;
};

/// Folder names of a KITTI data set.
struct KittiLayout {
  const char* left;
  const char* right;
  const char* visible_truth;
  const char* whole_truth;
};

class KittiReader : public SceneReader {
 public:
  KittiReader(fs::path folder, const KittiLayout& layout, Truth truth)
      : folder_(std::move(folder)),
        layout_(layout),
        has_truth_(truth == Truth::kRequired || fs::exists(folder_ / layout.visible_truth)) {}

  std::vector<std::string> scenes() const override {
    std::vector<std::string> names = has_truth_
                                         ? listEntries(folder_ / layout_.visible_truth, isImage)
                                         : listEntries(folder_ / layout_.left, isTestImage);
    for (std::string& name : names) {
      name = fs::path(name).stem().string();
    }
    return names;
  }

  StereoScene read(const std::string& name) const override {
    const std::string file = name + ".png";
    const fs::path left_file = folder_ / layout_.left / file;
    StereoScene scene;
    scene.name = name;
    readPair(left_file, folder_ / layout_.right / file, scene);
    if (has_truth_) {
      readTruth(left_file, scene);
    }
    scene.calibration = searchRange(scene.left.size(), kKittiDisparities);
    return scene;
  }

 private:
  static bool isImage(const fs::path& file) {
    return file.extension() == ".png" && file.filename().string().front() != '.';
  }

  /// Frame 10 of each pair of frames.
  static bool isTestImage(const fs::path& file) {
    const std::string name = file.stem().string();
    return isImage(file) && name.size() > 3 && name.compare(name.size() - 3, 3, "_10") == 0;
  }

  void readTruth(const fs::path& left_file, StereoScene& scene) const {
    const fs::path file = left_file.filename();
    scene.truth = readMatchingDisparity(folder_ / layout_.visible_truth / file, kKittiDivisor,
                                        left_file, scene.left);
    scene.visible = scene.truth == scene.truth;  // NaN differs from itself
    const fs::path whole_file = folder_ / layout_.whole_truth / file;
    if (fs::exists(whole_file)) {
      const cv::Mat whole = readMatchingDisparity(whole_file, kKittiDivisor, left_file, scene.left);
      whole.copyTo(scene.truth, scene.visible == 0);
    }
  }

  fs::path folder_;
  KittiLayout layout_;
  bool has_truth_;
};

}  // namespace

std::unique_ptr<SceneReader> makeMiddleburyReader(const std::string& folder, Truth truth) {
  return std::make_unique<MiddleburyReader>(folder, 0, truth);
}

std::unique_ptr<SceneReader> makeEth3dReader(const std::string& folder, Truth truth) {
  return std::make_unique<MiddleburyReader>(folder, kEth3dDisparities, truth);
}

std::unique_ptr<SceneReader> makeKitti2012Reader(const std::string& folder, Truth truth) {
  return std::make_unique<KittiReader>(
      folder, KittiLayout{"image_0", "image_1", "disp_noc", "disp_occ"}, truth);
}

std::unique_ptr<SceneReader> makeKitti2015Reader(const std::string& folder, Truth truth) {
  return std::make_unique<KittiReader>(
      folder, KittiLayout{"image_2", "image_3", "disp_noc_0", "disp_occ_0"}, truth);
}

}  // namespace cbmv
