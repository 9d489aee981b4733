#include "forest/confidence_forest.h"

#include <algorithm>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

std::string nameAt(const std::vector<std::string>& names, std::size_t f) {
  return f < names.size() ? "\"" + names[f] + "\"" : "missing";
}

}  // namespace

void requireFeatures(const ConfidenceForest& forest, const std::string& stage,
                     const std::vector<std::string>& names, const std::string& file_name) {
  const std::vector<std::string>& own = forest.feature_names;
  const auto same = std::mismatch(own.begin(), own.end(), names.begin(), names.end()).first;
  if (own == names) {
    return;
  }
  const auto f = static_cast<std::size_t>(same - own.begin());
  throw Error("forest " + file_name + ": feature " + std::to_string(f) + " of the " + stage +
              " forest is " + nameAt(own, f) + ", expected " +
              (f < names.size() ? nameAt(names, f) : std::to_string(names.size()) + " features") +
              ". Train the forest again with this version of cbmv_train");
}

}  // namespace cbmv
