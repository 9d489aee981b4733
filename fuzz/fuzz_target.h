#pragma once

#include <cstddef>
#include <cstdint>

#include "cbmv_stereo/error.h"

// Each program of this folder passes arbitrary bytes to one reader. The reader must return or throw
// cbmv::Error. Everything else ends the program.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace cbmv::fuzz {

/// Runs a reader. cbmv::Error is a valid result.
template <typename Read>
int attempt(const Read& read) {
  try {
    read();
  } catch (const Error&) {  // valid result
  }
  return 0;
}

}  // namespace cbmv::fuzz
