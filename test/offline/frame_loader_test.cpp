#include "offline/frame_loader.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include "offline/recording.h"
#include "ros/image_conversion.h"
#include "support/error_text.h"

namespace cbmv {
namespace {

using testing::HasSubstr;

/// Of a raw image, as drivers send it.
sensor_msgs::CameraInfo calibration() {
  sensor_msgs::CameraInfo info = *recordedFrame(0).left_info;
  info.distortion_model = "plumb_bob";
  info.D = {-0.1, 0.01, 0, 0, 0};
  info.K = {info.P[0], 0, info.P[2], 0, info.P[5], info.P[6], 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return info;
}

sensor_msgs::Image imageOf(const sensor_msgs::CameraInfo& info) {
  const cv::Size size(static_cast<int>(info.width), static_cast<int>(info.height));
  return toMessage(cv::Mat::zeros(size, CV_8UC1), sensor_msgs::image_encodings::MONO8, info.header);
}

/// Why an image of the size of the recording cannot be rectified with this calibration.
std::string refusal(const sensor_msgs::CameraInfo& info) {
  return errorText([&] { makeCamera(info, "/left", imageOf(calibration())); });
}

/// The bytes of a message in which the 4 bytes at `place` are a length that there is not.
template <typename Message>
void expectOverrun(const Message& message, std::size_t place) {
  RawMessage raw = toRawMessage(message, "/topic");
  std::vector<std::uint8_t> bytes(raw.data, raw.data + raw.size);
  EXPECT_NO_THROW(fromRawMessage<Message>(raw));
  for (const std::uint32_t claimed : {0xffffffffU, 0x20000001U, raw.size}) {
    std::memcpy(bytes.data() + place, &claimed, sizeof(claimed));
    raw.data = bytes.data();
    EXPECT_THROW(fromRawMessage<Message>(raw), ros::serialization::StreamOverrunException)
        << claimed;
  }
}

/// 0x20000001 doubles have 8 bytes, as roscpp counts with 32 bits.
TEST(FromRawMessage, TakesNoMemoryForLengthsThatAreNotThere) {
  sensor_msgs::Image image = imageOf(calibration());
  image.header.frame_id = "left";
  image.encoding = "mono8";
  const std::size_t frame_end = 4 + 8 + 4 + image.header.frame_id.size();
  expectOverrun(image, 4 + 8);
  expectOverrun(image, frame_end + 8);
  expectOverrun(image, frame_end + 8 + 4 + image.encoding.size() + 1 + 4);
  sensor_msgs::CompressedImage compressed;
  compressed.data.resize(10);
  expectOverrun(compressed, 4 + 8 + 4 + 4);
  sensor_msgs::CameraInfo info = calibration();
  info.header.frame_id.clear();
  info.distortion_model.clear();
  expectOverrun(info, 4 + 8 + 4 + 8 + 4);
  std_msgs::String text;
  text.data = "labels";
  expectOverrun(text, 0);
}

TEST(MakeCamera, TakesTheCalibrationOfTheImage) { EXPECT_EQ(refusal(calibration()), "no error"); }

TEST(MakeCamera, RefusesUnusableCalibrations) {
  const auto changed = [](const auto& change) {
    sensor_msgs::CameraInfo info = calibration();
    change(info);
    return refusal(info);
  };
  using Info = sensor_msgs::CameraInfo;
  EXPECT_THAT(changed([](Info& info) { info.K[0] = 0; }), HasSubstr("no calibration"));
  EXPECT_THAT(changed([](Info& info) { info.width = info.height = 4000000000U; }),
              HasSubstr("/left is raw, and its camera_info describes a sensor of 4000000000x"));
  EXPECT_THAT(changed([](Info& info) { info.width += 1; }), HasSubstr("/left has"));
  // The image is a window of 16x12 of a sensor whose maps would take gigabytes.
  EXPECT_THAT(changed([](Info& info) {
                info.roi.width = info.width;
                info.roi.height = info.height;
                info.width = info.height = 40000;
              }),
              HasSubstr("sensor of 40000x40000"));
  EXPECT_THAT(changed([](Info& info) { info.binning_x = 4000000000U; }), HasSubstr("/left"));
  EXPECT_THAT(changed([](Info& info) { info.distortion_model = "fisheye of my own"; }),
              HasSubstr("/left is raw, but its camera_info cannot be used"));
  EXPECT_THAT(changed([](Info& info) {
                info.D = {0.1, 0.2, 0.3};
              }),
              HasSubstr("/left is raw, but its camera_info cannot be used"));
}

}  // namespace
}  // namespace cbmv
