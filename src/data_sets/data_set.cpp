#include "data_sets/data_set.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "data_sets/scene_reader.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

struct Kind {
  const char* name;
  const char* title;
  const char* layout;  ///< expected content of a folder, for messages
  double correct_px;   ///< DataSet::correctPx
  std::unique_ptr<SceneReader> (*make_reader)(const std::string&, Truth);
};

constexpr std::array<Kind, 8> kKinds = {{
    {"middlebury_v3", "Middlebury v3", "folders with im0.png and calib.txt", 1.0,
     makeMiddleburyReader},
    {"middlebury_2005", "Middlebury 2005/2006", "folders with view1.png and view5.png", 1.0,
     makeMiddlebury2005Reader},
    {"middlebury_2005_half", "Middlebury 2005/2006", "folders with view1.png and view5.png", 1.0,
     makeMiddlebury2005HalfReader},
    {"middlebury_2005_full", "Middlebury 2005/2006", "folders with view1.png and view5.png", 1.0,
     makeMiddlebury2005FullReader},
    {"kitti2012", "KITTI 2012", "disp_noc/NNNNNN_10.png", 3.0, makeKitti2012Reader},
    {"kitti2015", "KITTI 2015", "disp_noc_0/NNNNNN_10.png", 3.0, makeKitti2015Reader},
    {"eth3d", "ETH3D", "folders with im0.png and calib.txt", 1.0, makeEth3dReader},
    {"list", "list", "lines `left right disparity scale [ndisp]`", 1.0, makeListReader},
}};

constexpr std::array<const char*, 5> kHalfWeightScenes = {"PianoL", "Playroom", "Playtable",
                                                          "Shelves", "Vintage"};

template <typename Names>
bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

const Kind& findKind(const std::string& name, const std::string& data_set) {
  std::string all;
  for (const Kind& kind : kKinds) {
    if (name == kind.name) {
      return kind;
    }
    all += (all.empty() ? "" : ", ") + std::string(kind.name);
  }
  throw Error("data set " + data_set +
              ": unknown, expected KIND:DIR or list:FILE, where KIND is one of " + all);
}

/// "data set A, B", for messages.
std::string namesOf(const std::vector<DataSet>& data_sets) {
  std::string names;
  for (const DataSet& data_set : data_sets) {
    names += (names.empty() ? "data set " : ", ") + data_set.name();
  }
  return names;
}

}  // namespace

DataSet DataSet::open(const std::string& kind_and_folder, Truth truth) {
  const std::size_t colon = kind_and_folder.find(':');
  const std::string kind_name = kind_and_folder.substr(0, colon);
  const Kind& kind = findKind(kind_name, kind_and_folder);
  const std::string path = colon == std::string::npos ? "" : kind_and_folder.substr(colon + 1);
  if (path.empty()) {
    throw Error("data set " + kind_and_folder +
                ": no folder or file after ':', expected KIND:DIR or list:FILE. Add it");
  }
  DataSet data_set;
  data_set.kind_ = kind.name;
  data_set.folder_ = path;
  data_set.title_ = kind.title;
  data_set.correct_px_ = kind.correct_px;
  if (data_set.kind_ == "list") {
    data_set.title_ += " " + std::filesystem::path(path).stem().string();
  }
  data_set.name_ = kind_and_folder;
  data_set.reader_ = kind.make_reader(path, truth);
  data_set.scenes_ = data_set.reader_->scenes();
  if (data_set.scenes_.empty()) {
    throw Error("data set " + kind_and_folder + ": has no scene, expected " + kind.layout);
  }
  return data_set;
}

StereoScene DataSet::read(const std::string& scene) const {
  if (!contains(scenes_, scene)) {
    throw Error("data set " + name_ + ": has no scene " + scene);
  }
  return reader_->read(scene);
}

double DataSet::weight(const std::string& scene) const {
  return kind_ == "middlebury_v3" && contains(kHalfWeightScenes, scene) ? 0.5 : 1.0;
}

std::vector<SceneReference> chooseScenes(const std::vector<DataSet>& data_sets,
                                         const SceneFilter& filter) {
  for (const std::vector<std::string>* names : {&filter.only, &filter.excluded}) {
    for (const std::string& name : *names) {
      if (std::none_of(data_sets.begin(), data_sets.end(),
                       [&](const DataSet& set) { return contains(set.scenes(), name); })) {
        throw Error(namesOf(data_sets) + ": has no scene " + name);
      }
    }
  }
  std::vector<SceneReference> chosen;
  for (const DataSet& data_set : data_sets) {
    for (const std::string& name : data_set.scenes()) {
      if ((filter.only.empty() || contains(filter.only, name)) &&
          !contains(filter.excluded, name)) {
        chosen.push_back({data_set, name});
      }
    }
  }
  if (chosen.empty()) {
    throw Error(namesOf(data_sets) +
                ": all scenes are excluded, expected at least one. Correct --scenes and --exclude");
  }
  return chosen;
}

}  // namespace cbmv
