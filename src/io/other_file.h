#pragma once

#include <string>
#include <vector>

namespace cbmv {

/// Whether both paths name one file, which need not exist: symbolic and hard links count.
bool isSameFile(const std::string& a, const std::string& b);

/// Throws Error if writing `output` would destroy `input`: it is the same file, by whatever path,
/// or a part of an earlier run that is replaced. `output` need not exist.
void requireOtherFile(const std::string& input, const std::string& output);

/// The same of each input with each output. Empty paths are no files.
void requireOtherFiles(const std::vector<std::string>& inputs,
                       const std::vector<std::string>& outputs);

}  // namespace cbmv
