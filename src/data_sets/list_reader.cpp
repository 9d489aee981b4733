// Data set that is a text file with one line per pair.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <locale>
#include <map>
#include <sstream>
#include <utility>

#include "data_sets/scene_files.h"
#include "data_sets/scene_reader.h"
#include "data_sets/visible_in_both.h"
#include "io/binary_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 64 << 20;

struct ListedPair {
  std::string left, right, truth;
  double divisor = 1.0;
  int disparities = 0;  ///< 0: derived from the truth
  std::string line;     ///< file and line, for messages
};

/// The left file without its extension, '/' replaced by '_'.
std::string sceneName(const std::string& left) {
  std::string name;
  for (const fs::path& part : fs::path(left).replace_extension().relative_path()) {
    if (part != "." && part != "..") {
      name += (name.empty() ? "" : "_") + part.string();
    }
  }
  return name;
}

/// Throws Error unless the text is `left right disparity scale [ndisp]`.
ListedPair parsePair(const std::string& text, const std::string& line) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  ListedPair pair;
  pair.line = line;
  in >> pair.left >> pair.right >> pair.truth >> pair.divisor;
  bool valid = !in.fail() && std::isfinite(pair.divisor) && pair.divisor > 0.0;
  if (valid && !(in >> std::ws).eof()) {
    in >> pair.disparities;
    valid = !in.fail() && pair.disparities > 0 && (in >> std::ws).eof();
  }
  if (!valid) {
    throw Error(line +
                ": invalid line, expected \"left right disparity scale [ndisp]\" with three file "
                "names without blanks, a scale above 0 and a whole number above 0. Correct it.");
  }
  return pair;
}

/// Smallest range from 0 that holds the truth.
int neededDisparities(const cv::Mat& truth) {
  float highest = 0.0F;
  for (auto value = truth.begin<float>(); value != truth.end<float>(); ++value) {
    highest = *value > highest ? *value : highest;
  }
  return static_cast<int>(std::min(std::ceil(highest), static_cast<float>(truth.cols))) + 1;
}

class ListReader : public SceneReader {
 public:
  explicit ListReader(const fs::path& file) : folder_(file.parent_path()) {
    std::ifstream in = openText(file.string(), kLargestFile);
    std::string text;
    for (int number = 1; std::getline(in, text); ++number) {
      text.erase(std::min(text.find('#'), text.size()));
      if (text.find_first_not_of(" \t\r") == std::string::npos) {
        continue;
      }
      const ListedPair pair = parsePair(text, file.string() + ", line " + std::to_string(number));
      const auto [other, is_new] = pairs_.emplace(sceneName(pair.left), pair);
      if (!is_new) {
        throw Error(pair.line + ": its scene is called " + other->first + ", as that of " +
                    other->second.line + ", expected different names of left images. Rename one.");
      }
    }
  }

  std::vector<std::string> scenes() const override {
    std::vector<std::string> names;
    for (const auto& entry : pairs_) {
      names.push_back(entry.first);
    }
    return names;
  }

  StereoScene read(const std::string& name) const override {
    const ListedPair& pair = pairs_.at(name);
    const fs::path left_file = folder_ / pair.left;
    StereoScene scene;
    scene.name = name;
    readPair(left_file, folder_ / pair.right, scene);
    scene.truth = readMatchingDisparity(folder_ / pair.truth, pair.divisor, left_file, scene.left);
    scene.visible = visibleInBoth(scene.truth);
    scene.calibration.width = scene.left.cols;
    scene.calibration.height = scene.left.rows;
    scene.calibration.disparities = pair.disparities > 0
                                        ? pair.disparities
                                        : std::min(neededDisparities(scene.truth), scene.left.cols);
    requireDisparitiesFit(pair.line, scene.calibration);
    return scene;
  }

 private:
  fs::path folder_;
  std::map<std::string, ListedPair> pairs_;
};

}  // namespace

std::unique_ptr<SceneReader> makeListReader(const std::string& file, Truth /*truth*/) {
  return std::make_unique<ListReader>(file);
}

}  // namespace cbmv
