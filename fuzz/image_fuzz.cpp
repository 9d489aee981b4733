// Images: PNG, JPEG and all other formats that OpenCV reads, decoded as gray, as color and as
// disparities.

#include "fuzz_target.h"
#include "io/disparity_file.h"
#include "io/image_file.h"
#include "scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  cbmv::fuzz::attempt([&] { cbmv::readGrayImage(file.path()); });
  return cbmv::fuzz::attempt([&] { cbmv::readDisparity(file.path(), 256.0); });
}
