// Calibration files of rigs, of any format, for both cameras and for one each.

#include "fuzz_target.h"
#include "io/stereo_cameras.h"
#include "scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  const cbmv::fuzz::ScratchFile half(data, size / 2);
  for (const char* cameras : {"", ":02,03"}) {
    cbmv::fuzz::attempt([&] { cbmv::readStereoCameras(file.path() + cameras); });
  }
  // The two files that a rig is described by in one input, then one camera twice.
  const cbmv::fuzz::ScratchFile rest(data + size / 2, size - size / 2);
  cbmv::fuzz::attempt([&] { cbmv::readStereoCameras(half.path(), rest.path()); });
  return cbmv::fuzz::attempt([&] { cbmv::readStereoCameras(file.path(), file.path()); });
}
