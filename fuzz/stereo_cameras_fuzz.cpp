// Calibration files of stereo rigs in all formats: one file for both cameras, and one file per
// camera.

#include "fuzz_target.h"
#include "io/stereo_cameras.h"
#include "scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  const cbmv::fuzz::ScratchFile half(data, size / 2);
  for (const char* cameras : {"", ":02,03"}) {
    cbmv::fuzz::attempt([&] { cbmv::readStereoCameras(file.path() + cameras); });
  }
  // Splits the input into two files that describe one rig.
  const cbmv::fuzz::ScratchFile rest(data + size / 2, size - size / 2);
  cbmv::fuzz::attempt([&] { cbmv::readStereoCameras(half.path(), rest.path()); });
  return cbmv::fuzz::attempt([&] { cbmv::readStereoCameras(file.path(), file.path()); });
}
