// Serialized sensor_msgs/Image, decoded as gray, color and numbers.

#include "raw_input.h"
#include "ros/image_conversion.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto image = cbmv::fuzz::toRosMessage<sensor_msgs::Image>(data, size);
  if (!image) {
    return 0;
  }
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  const cbmv::StereoMessages messages{image, info, image, info};
  cbmv::fuzz::attempt([&] { cbmv::toGrayPair(cbmv::toStereoInput(messages, {}, true)); });
  cbmv::fuzz::attempt([&] { cbmv::toColor(*image, "left", cbmv::imageSize(*image)); });
  return cbmv::fuzz::attempt([&] { cbmv::toFloats(*image, "disparity"); });
}
