#include "evaluation/submission.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <limits>
#include <locale>
#include <sstream>

#include "evaluation/folds.h"
#include "io/binary_file.h"
#include "io/disparity_file.h"
#include "io/image_file.h"
#include "io/pfm.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

/// File layout of an upload.
struct SubmissionFormat {
  const char* kind;         ///< of the data set
  const char* folder;       ///< precedes the scene's name
  const char* map;          ///< suffix of the map's path; .png: 16 bits
  const char* sparse_map;   ///< the same if some pixels have no disparity
  const char* time;         ///< suffix of the path of the time file; "": no time file
  const char* time_prefix;  ///< text before the seconds
};

namespace {

namespace fs = std::filesystem;

constexpr std::array<SubmissionFormat, 4> kFormats = {{
    {"middlebury_v3", "", "/disp0CBMV.pfm", "/disp0CBMV_s.pfm", "/timeCBMV.txt", ""},
    {"kitti2012", "", ".png", ".png", "", ""},
    {"kitti2015", "disp_0/", ".png", ".png", "", ""},
    {"eth3d", "low_res_two_view/", ".pfm", ".pfm", ".txt", "runtime "},
}};

const SubmissionFormat& findFormat(const DataSet& data_set) {
  const auto* const format = std::find_if(
      kFormats.begin(), kFormats.end(),
      [&](const SubmissionFormat& candidate) { return data_set.kind() == candidate.kind; });
  if (format == kFormats.end()) {
    throw Error("data set " + data_set.name() +
                ": there is no benchmark of this kind, expected middlebury_v3, kitti2012, "
                "kitti2015 or eth3d. Leave out --submission");
  }
  return *format;
}

/// The letter after "training" or "test" in Middlebury's folder names.
char findResolution(const DataSet& data_set) {
  const fs::path folder = fs::absolute(fs::path(data_set.folder()) / ".").lexically_normal();
  const char letter = folder.parent_path().filename().string().back();
  if (letter != 'Q' && letter != 'H' && letter != 'F') {
    throw Error("data set " + data_set.name() +
                ": the name of the folder does not end with the resolution Q, H or F, which the "
                "upload needs. Rename it, for example to trainingQ");
  }
  return letter;
}

bool isMiddleburyTrainingScene(const std::string& scene) {
  const std::vector<std::vector<std::string>> folds = middleburyFolds();
  return std::any_of(folds.begin(), folds.end(), [&](const std::vector<std::string>& fold) {
    return std::find(fold.begin(), fold.end(), scene) != fold.end();
  });
}

bool isDense(const cv::Mat& disparity) {
  return std::all_of(disparity.begin<float>(), disparity.end<float>(),
                     [](float value) { return std::isfinite(value); });
}

/// Replaces values that are not finite by infinity.
cv::Mat withInfinities(const cv::Mat& disparity) {
  cv::Mat map = disparity.clone();
  std::replace_if(
      map.begin<float>(), map.end<float>(), [](float value) { return !std::isfinite(value); },
      std::numeric_limits<float>::infinity());
  return map;
}

std::string secondsText(double seconds) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(3) << seconds;
  return text.str();
}

}  // namespace

SubmissionWriter::SubmissionWriter(const DataSet& data_set, const std::string& folder)
    : format_(&findFormat(data_set)), folder_(folder) {
  if (data_set.kind() == "middlebury_v3") {
    resolution_ = findResolution(data_set);
  }
}

void SubmissionWriter::write(const StereoScene& scene, const SceneMaps& maps) const {
  const std::string dense = pathOf(scene.name, format_->map);
  const std::string sparse = pathOf(scene.name, format_->sparse_map);
  makeFolder(fs::path(dense).parent_path().string());
  fs::remove(dense);  // an earlier run may have written the other kind
  fs::remove(sparse);
  const std::string& path = isDense(maps.disparity) ? dense : sparse;
  if (fs::path(path).extension() == ".png") {
    writeImage(path, toKittiDisparity(maps.disparity));
  } else {
    writePfm(path, withInfinities(maps.disparity));
  }
  if (*format_->time != '\0') {
    writeFile(pathOf(scene.name, format_->time),
              format_->time_prefix + secondsText(maps.seconds) + "\n");
  }
}

bool SubmissionWriter::has(const std::string& scene) const {
  return fs::exists(pathOf(scene, format_->map)) || fs::exists(pathOf(scene, format_->sparse_map));
}

std::string SubmissionWriter::pathOf(const std::string& scene, const std::string& ending) const {
  fs::path path = fs::path(folder_) / format_->folder;
  if (resolution_ != ' ') {
    path /= (isMiddleburyTrainingScene(scene) ? "training" : "test") + std::string(1, resolution_);
  }
  return (path / scene).string() + ending;
}

}  // namespace cbmv
