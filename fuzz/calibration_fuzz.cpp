// calib.txt of Middlebury and ETH3D.

#include "fuzz_target.h"
#include "io/calibration.h"
#include "scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  cbmv::fuzz::attempt([&] { cbmv::readMiddleburyCalibration(file.path()); });
  return cbmv::fuzz::attempt([&] { cbmv::readMiddleburyCalibration(file.path(), 64); });
}
