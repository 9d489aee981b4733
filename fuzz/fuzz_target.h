#pragma once

#include <cstddef>
#include <cstdint>

#include "cbmv_stereo/error.h"

// Each program of this folder hands hostile bytes to one reader. All that the reader may do is to
// return, or to throw cbmv::Error: everything else ends the program.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace cbmv::fuzz {

/// Runs a reader. A refusal in a sentence is as good as a result.
template <typename Read>
int attempt(const Read& read) {
  try {
    read();
  } catch (const Error&) {  // what the reader promises
  }
  return 0;
}

}  // namespace cbmv::fuzz
