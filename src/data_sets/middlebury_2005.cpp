// Middlebury 2005 and 2006: three sizes with the same folder and file names.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "data_sets/scene_files.h"
#include "data_sets/scene_reader.h"
#include "data_sets/visible_in_both.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

struct Size {
  const char* kind;  ///< of the data set
  const char* title;
  double divisor;  ///< true disparity = value / divisor, px
  int widest_px;   ///< widest allowed image; full size images are 1240 to 1396 px wide
};

constexpr std::array<Size, 3> kSizes = {
    {{"middlebury_2005", "third size", 3.0, 550},
     {"middlebury_2005_half", "half size", 2.0, 900},
     {"middlebury_2005_full", "full size", 1.0, std::numeric_limits<int>::max()}}};

/// 255 where the true disparity of the right image equals the left one within 1 px, else 0.
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

/// Mean gray value difference between left pixels and the right pixels given by the truth times
/// `factor`. Uses only pixels that are inside the image for every size, so that the sizes are
/// comparable.
double meanDifference(const StereoScene& scene, double divisor, double factor) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < scene.left.rows; ++y) {
    for (int x = 0; x < scene.left.cols; ++x) {
      const double d = scene.truth.at<float>(y, x);
      if (x - d * divisor >= 0) {  // false for NaN
        const int column = static_cast<int>(std::lround(x - d * factor));
        sum += std::abs(scene.left.at<uchar>(y, x) - scene.right.at<uchar>(y, column));
        ++count;
      }
    }
  }
  return count > 0 ? sum / count : 0;
}

/// The size whose divisor fits the pair best. With the divisor of another size the gray values
/// differ about three times as much.
const Size& bestFit(const StereoScene& scene, const Size& wanted) {
  constexpr double clearly = 1.5;
  constexpr double noise = 1;  // gray levels
  const Size* best = &wanted;
  double least = (meanDifference(scene, wanted.divisor, 1) - noise) / clearly;
  for (const Size& size : kSizes) {
    const double difference = meanDifference(scene, wanted.divisor, wanted.divisor / size.divisor);
    if (&size != &wanted && difference < least) {
      best = &size;
      least = difference;
    }
  }
  return *best;
}

class Middlebury2005Reader : public SceneReader {
 public:
  Middlebury2005Reader(fs::path folder, const Size& size)
      : folder_(std::move(folder)), size_(size) {}

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
    requireWidth(left_file, scene.left.cols);
    const auto read_truth = [&](const char* file) {
      return readMatchingDisparity(base / file, size_.divisor, left_file, scene.left);
    };
    scene.truth = read_truth("disp1.png");
    requireFit(base / "disp1.png", scene);
    scene.visible = fs::exists(base / "disp5.png")
                        ? confirmedByRightTruth(scene.truth, read_truth("disp5.png"))
                        : visibleInBoth(scene.truth);
    const double highest = 255 / size_.divisor;  // the truth has 8 bits
    scene.calibration = searchRange(scene.left.size(), static_cast<int>(std::ceil(highest)));
    return scene;
  }

 private:
  void requireWidth(const fs::path& file, int width) const {
    if (width > size_.widest_px) {
      fail(file,
           "images of this size are at most " + std::to_string(size_.widest_px) +
               " px wide, this one " + std::to_string(width) + " px",
           *std::find_if(kSizes.begin(), kSizes.end(),
                         [&](const Size& size) { return width <= size.widest_px; }));
    }
  }

  /// Crops of larger images can be narrow, so the width alone does not tell the size.
  void requireFit(const fs::path& file, const StereoScene& scene) const {
    const Size& best = bestFit(scene, size_);
    if (&best != &size_) {
      fail(file, std::string("its disparities fit the images as those of ") + best.title, best);
    }
  }

  [[noreturn]] void fail(const fs::path& file, const std::string& what, const Size& better) const {
    throw Error("Cannot read " + file.string() + " as " + size_.kind + ", " + size_.title + ": " +
                what + ". Use the kind " + better.kind + ".");
  }

  fs::path folder_;
  const Size& size_;
};

}  // namespace

std::unique_ptr<SceneReader> makeMiddlebury2005Reader(const std::string& folder, Truth /*truth*/) {
  return std::make_unique<Middlebury2005Reader>(folder, kSizes[0]);
}

std::unique_ptr<SceneReader> makeMiddlebury2005HalfReader(const std::string& folder,
                                                          Truth /*truth*/) {
  return std::make_unique<Middlebury2005Reader>(folder, kSizes[1]);
}

std::unique_ptr<SceneReader> makeMiddlebury2005FullReader(const std::string& folder,
                                                          Truth /*truth*/) {
  return std::make_unique<Middlebury2005Reader>(folder, kSizes[2]);
}

}  // namespace cbmv
