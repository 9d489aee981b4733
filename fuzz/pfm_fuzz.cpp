// Portable float maps.

#include "data_sets/visible_in_both.h"
#include "fuzz_target.h"
#include "io/pfm.h"
#include "scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  return cbmv::fuzz::attempt([&] { cbmv::visibleInBoth(cbmv::readPfm(file.path())); });
}
