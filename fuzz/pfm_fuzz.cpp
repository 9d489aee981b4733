// Portable float maps.

#include "fuzz_target.h"
#include "scratch_file.h"

#include "cbmv_stereo/evaluation/disparity_error.h"
#include "cbmv_stereo/io/pfm.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  return cbmv::fuzz::attempt([&] { cbmv::visibleInBoth(cbmv::readPfm(file.path())); });
}
