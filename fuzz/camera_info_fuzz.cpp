// Serialized sensor_msgs/CameraInfo: geometry of a pair and rectification of a raw image.

#include <sensor_msgs/image_encodings.h>

#include "offline/frame_loader.h"
#include "raw_input.h"
#include "ros/camera_info.h"
#include "ros/image_conversion.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto info = cbmv::fuzz::toRosMessage<sensor_msgs::CameraInfo>(data, size);
  if (!info) {
    return 0;
  }
  const cv::Size image_size(16, 12);
  cbmv::fuzz::attempt([&] { cbmv::toGeometry(*info, *info, image_size, {}); });
  return cbmv::fuzz::attempt([&] {
    const auto raw = boost::make_shared<sensor_msgs::Image>(
        cbmv::toMessage(cv::Mat(image_size, CV_8UC1, cv::Scalar(7)),
                        sensor_msgs::image_encodings::MONO8, info->header));
    cbmv::rectifyImage(raw, "left", cbmv::RawCamera(*info, "left", image_size), false);
  });
}
