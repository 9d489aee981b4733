#include "evaluation/folds.h"

#include <algorithm>
#include <utility>

#include "cbmv_stereo/error.h"

namespace cbmv {

std::vector<std::vector<std::string>> middleburyFolds() {
  return {{"PlaytableP", "Recycle", "Shelves", "Teddy", "Vintage"},
          {"Adirondack", "ArtL", "Jadeplant", "Motorcycle", "MotorcycleE"},
          {"Piano", "PianoL", "Pipes", "Playroom", "Playtable"}};
}

std::size_t foldOf(const std::string& scene) {
  const std::vector<std::vector<std::string>> folds = middleburyFolds();
  for (std::size_t fold = 0; fold < folds.size(); ++fold) {
    if (std::count(folds[fold].begin(), folds[fold].end(), scene) > 0) {
      return fold;
    }
  }
  throw Error("scene " + scene +
              ": is in none of the three folds of Middlebury v3. Exclude it with --exclude");
}

std::vector<std::string> orderByFold(const std::vector<std::string>& scenes) {
  std::vector<std::pair<std::size_t, std::string>> folded;
  folded.reserve(scenes.size());
  for (const std::string& scene : scenes) {
    folded.emplace_back(foldOf(scene), scene);
  }
  std::sort(folded.begin(), folded.end());
  std::vector<std::string> ordered;
  ordered.reserve(folded.size());
  for (const auto& entry : folded) {
    ordered.push_back(entry.second);
  }
  return ordered;
}

}  // namespace cbmv
