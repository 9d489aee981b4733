// Presets: YAML. Valid ones are made consistent, as in the programs.

#include "fuzz_target.h"
#include "pipeline/memory.h"
#include "scratch_file.h"

#include "cbmv_stereo/parameters.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  return cbmv::fuzz::attempt([&] {
    cbmv::StereoOptions options;
    cbmv::readPreset(file.path(), options);
    cbmv::correctOptions(options);
    cbmv::requiredMemoryMb({640, 480}, options);
  });
}
