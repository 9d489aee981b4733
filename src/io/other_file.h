#pragma once

#include <string>
#include <vector>

namespace cbmv {

/// Returns whether both paths are the same file. Symbolic and hard links are resolved. The file
/// need not exist.
bool isSameFile(const std::string& a, const std::string& b);

/// Throws Error if writing `output` would destroy `input`: both are the same file by any path, or
/// `input` is the partial file of an earlier run that would be replaced. `output` need not exist.
void requireOtherFile(const std::string& input, const std::string& output);

/// The same for every pair of an input and an output. Empty paths are ignored.
void requireOtherFiles(const std::vector<std::string>& inputs,
                       const std::vector<std::string>& outputs);

}  // namespace cbmv
