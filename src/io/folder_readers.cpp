// Data sets that are a folder in a layout of their own: Middlebury, ETH3D, KITTI.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "scene_files.h"
#include "scene_reader.h"

#include "cbmv_stereo/evaluation/disparity_error.h"
#include "cbmv_stereo/io/middlebury_scene.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr int kEth3dDisparities = 64;
constexpr int kMiddlebury2005Disparities = 85;  // third size: 255 / 3
constexpr double kMiddlebury2005Divisor = 3.0;
constexpr int kKittiDisparities = 228;
constexpr double kKittiDivisor = 256.0;

/// 255 where the right image's true disparities confirm the left ones within 1 px, else 0.
cv::Mat confirmedByRightTruth(const cv::Mat& truth, const cv::Mat& right_truth) {
  cv::Mat visible(truth.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      const float d = truth.at<float>(y, x);
      const float column = std::round(static_cast<float>(x) - d);
      if (column >= 0.0F && column < static_cast<float>(truth.cols) &&
          std::abs(right_truth.at<float>(y, static_cast<int>(column)) - d) <= 1.0F) {
        visible.at<uchar>(y, x) = 255;
      }
    }
  }
  return visible;
}

/// Of a data set without calibration files.
StereoCalibration searchRange(const cv::Size& size, int disparities) {
  StereoCalibration calibration;
  calibration.width = size.width;
  calibration.height = size.height;
  calibration.disparities = std::min(disparities, size.width);
  return calibration;
}

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

class Middlebury2005Reader : public SceneReader {
 public:
  explicit Middlebury2005Reader(fs::path folder) : folder_(std::move(folder)) {}

  std::vector<std::string> scenes() const override {
    return listEntries(folder_, [](const fs::path& entry) {
      return fs::exists(entry / "view1.png") && fs::exists(entry / "view5.png");
    });
  }

  StereoScene read(const std::string& name) const override {
    const fs::path base = folder_ / name;
    const fs::path left_file = base / "view1.png";
    StereoScene scene;
    scene.name = name;
    readPair(left_file, base / "view5.png", scene);
    const auto read_truth = [&](const char* file) {
      return readMatchingDisparity(base / file, kMiddlebury2005Divisor, left_file, scene.left);
    };
    scene.truth = read_truth("disp1.png");
    scene.visible = fs::exists(base / "disp5.png")
                        ? confirmedByRightTruth(scene.truth, read_truth("disp5.png"))
                        : visibleInBoth(scene.truth);
    scene.calibration = searchRange(scene.left.size(), kMiddlebury2005Disparities);
    return scene;
  }

 private:
  fs::path folder_;
};

/// Names of the folders in a KITTI data set.
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

std::unique_ptr<SceneReader> makeMiddlebury2005Reader(const std::string& folder, Truth /*truth*/) {
  return std::make_unique<Middlebury2005Reader>(folder);
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
