#pragma once

#include <stdexcept>
#include <string>

namespace cbmv {

/// Bad input from outside: a file, a message, a parameter. The text is one sentence that names the
/// thing, says what is wrong with it and what would be right. Tools print it and exit with status
/// 2, the node warns and drops the frame.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& sentence) : std::runtime_error(sentence) {}
};

}  // namespace cbmv
