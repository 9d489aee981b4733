#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace cbmv {

/// The three folds of the paper's cross-validation on Middlebury v3 (Batsos et al. 2018, section
/// 4).
std::vector<std::vector<std::string>> middleburyFolds();

/// Index in middleburyFolds. Throws Error with the scene if it is in no fold.
std::size_t foldOf(const std::string& scene);

/// The scenes sorted by fold. Errors as foldOf.
std::vector<std::string> orderByFold(const std::vector<std::string>& scenes);

}  // namespace cbmv
