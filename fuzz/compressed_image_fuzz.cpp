// Serialized sensor_msgs/CompressedImage.

#include "offline/frame_loader.h"
#include "raw_input.h"
#include "ros/image_conversion.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto message = cbmv::fuzz::toRosMessage<sensor_msgs::CompressedImage>(data, size);
  if (!message) {
    return 0;
  }
  return cbmv::fuzz::attempt([&] {
    const auto image = cbmv::decompressImage(*message, "left");
    cbmv::toColor(*image, "left", cbmv::imageSize(*image));
  });
}
