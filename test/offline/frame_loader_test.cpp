#include "offline/frame_loader.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <image_geometry/pinhole_camera_model.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "offline/recording.h"
#include "ros/image_conversion.h"
#include "support/error_text.h"

namespace cbmv {
namespace {

using testing::HasSubstr;

/// Calibration of a raw image, as sent by drivers.
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

/// The error when an image with the recorded size is rectified with this calibration.
std::string rejection(const sensor_msgs::CameraInfo& info) {
  return errorText([&] { RawCamera(info, "/left", imageSize(imageOf(calibration()))); });
}

/// The bytes of a message in which the 4 bytes at `place` are a length that exceeds the message.
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

/// 0x20000001 doubles are 8 bytes in the 32-bit arithmetic of roscpp.
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

TEST(RawCamera, TakesTheCalibrationOfTheImage) { EXPECT_EQ(rejection(calibration()), "no error"); }

TEST(RawCamera, RejectsUnusableCalibrations) {
  const auto changed = [](const auto& change) {
    sensor_msgs::CameraInfo info = calibration();
    change(info);
    return rejection(info);
  };
  using Info = sensor_msgs::CameraInfo;
  EXPECT_THAT(changed([](Info& info) { info.K[0] = 0; }),
              HasSubstr("no usable calibration (K[0] = 0)"));
  EXPECT_THAT(changed([](Info& info) { info.width = info.height = 4000000000U; }),
              HasSubstr("/left is raw, but its camera_info describes a sensor of 4000000000x"));
  EXPECT_THAT(changed([](Info& info) { info.width += 1; }),
              HasSubstr("its camera_info describes images of"));
  EXPECT_THAT(changed([](Info& info) { std::swap(info.width, info.height); }),
              HasSubstr("width and height are exchanged"));
  EXPECT_THAT(changed([](Info& info) {
                info.roi.width = info.width - 1;
                info.roi.height = info.height;
              }),
              HasSubstr("region of interest (roi)"));
  // The image is a window of 16x12 px in a sensor whose maps would take gigabytes.
  EXPECT_THAT(changed([](Info& info) {
                info.roi.width = info.width;
                info.roi.height = info.height;
                info.width = info.height = 40000;
              }),
              HasSubstr("sensor of 40000x40000"));
  EXPECT_THAT(changed([](Info& info) { info.binning_x = 4000000000U; }), HasSubstr("/left"));
  EXPECT_THAT(changed([](Info& info) { info.distortion_model = "fisheye of my own"; }),
              HasSubstr("/left is raw, but its camera_info has an unknown distortion model "
                        "'fisheye of my own'. Expected plumb_bob, rational_polynomial or "
                        "equidistant"));
  EXPECT_THAT(changed([](Info& info) { info.distortion_model = ""; }),
              HasSubstr("unknown distortion model ''"));
  EXPECT_THAT(changed([](Info& info) { info.R.assign(0); }),
              HasSubstr("R that is no rotation (all zero)"));
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(changed([](Info& info) { info.K[4] = 0; }), HasSubstr("K[4] = 0"));
  EXPECT_THAT(changed([](Info& info) { info.K[0] = kNotANumber; }), HasSubstr("K[0] = nan"));
  EXPECT_THAT(changed([](Info& info) { info.K[2] = kNotANumber; }), HasSubstr("K[2] = nan"));
  EXPECT_THAT(changed([](Info& info) { info.D[1] = kNotANumber; }), HasSubstr("D[1] = nan"));
  EXPECT_THAT(changed([](Info& info) {
                info.width = info.height = 0;
                info.binning_x = info.binning_y = 4000000000U;
              }),
              HasSubstr("describes a sensor of"));
  EXPECT_THAT(changed([](Info& info) { info.R[8] = -1; }), HasSubstr("R that is no rotation"));
  EXPECT_THAT(
      changed([](Info& info) {
        info.D = {0.1, 0.2, 0.3};
      }),
      HasSubstr("/left is raw, but its camera_info has 3 distortion coefficients D of the model "
                "plumb_bob, expected 4, 5, 8, 12 or 14. Correct D"));
  EXPECT_THAT(changed([](Info& info) { info.distortion_model = "equidistant"; }),
              HasSubstr("coefficients D of the model equidistant, expected 4. Correct D"));
}

/// Rotates the camera about the vertical axis.
void turn(sensor_msgs::CameraInfo& info) {
  const double c = std::cos(0.05);
  const double s = std::sin(0.05);
  info.R = {c, 0, -s, 0, 1, 0, s, 0, c};
}

cv::Mat noise(const sensor_msgs::CameraInfo& info) {
  cv::Mat image(static_cast<int>(info.height), static_cast<int>(info.width), CV_8UC1);
  cv::RNG(7).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

/// Expected result from OpenCV's maps for a camera without distortion.
cv::Mat expectedImage(const sensor_msgs::CameraInfo& info, const cv::Mat& image, bool fisheye) {
  const cv::Matx33d k(info.K.data());
  const cv::Matx33d r(info.R.data());
  const cv::Matx33d p = cv::Matx34d(info.P.data()).get_minor<3, 3>(0, 0);
  cv::Mat map1, map2, rectified;
  if (fisheye) {
    cv::fisheye::initUndistortRectifyMap(k, cv::Vec4d(), r, p, image.size(), CV_16SC2, map1, map2);
  } else {
    cv::initUndistortRectifyMap(k, cv::noArray(), r, p, image.size(), CV_16SC2, map1, map2);
  }
  cv::remap(image, rectified, map1, map2, cv::INTER_LINEAR);
  return rectified;
}

/// image_geometry before 1.16 does not.
bool knowsEquidistant() {
  sensor_msgs::CameraInfo info = calibration();
  info.distortion_model = "equidistant";
  info.D.assign(4, 0.01);
  image_geometry::PinholeCameraModel model;
  try {
    model.fromCameraInfo(info);
    cv::Mat rectified;
    model.rectifyImage(noise(info), rectified);
  } catch (const std::exception&) {
    return false;
  }
  return true;
}

/// image_proc does not, because image_geometry treats zeros as "nothing to do".
TEST(RawCamera, RectifiesByRotationAndProjectionWithoutDistortion) {
  std::vector<std::string> models = {"", "plumb_bob", "rational_polynomial"};
  if (knowsEquidistant()) {
    models.emplace_back("equidistant");
  }
  for (const std::string& model : models) {
    for (const std::size_t coefficients : {0U, 4U}) {
      for (const bool is_turned : {true, false}) {
        SCOPED_TRACE(model + (is_turned ? ", turned" : ", other focal length"));
        sensor_msgs::CameraInfo info = calibration();
        info.distortion_model = model;
        info.D.assign(coefficients, 0.0);
        is_turned ? turn(info) : static_cast<void>(info.K[0] = info.K[4] = 1.1 * info.P[0]);
        const cv::Mat image = noise(info);
        const cv::Mat rectified = RawCamera(info, "/left", image.size()).rectify(image, "/left");
        const cv::Mat expected = expectedImage(info, image, model == "equidistant");
        EXPECT_EQ(cv::norm(rectified, expected, cv::NORM_INF), 0);
        EXPECT_GT(cv::norm(rectified, image, cv::NORM_L1), 1000);
      }
    }
  }
}

TEST(RawCamera, LeavesImagesThatNeedNoRectification) {
  sensor_msgs::CameraInfo info = calibration();
  const cv::Mat image = noise(info);
  for (const std::string model : {"", "plumb_bob"}) {
    info.distortion_model = model;
    info.D.clear();
    EXPECT_EQ(RawCamera(info, "/left", image.size()).rectify(image, "/left").data, image.data);
  }
}

TEST(RawCamera, EquidistantHasDistortionEvenIfAllCoefficientsAreZero) {
  if (!knowsEquidistant()) {
    GTEST_SKIP() << "image_geometry is older than 1.16";
  }
  sensor_msgs::CameraInfo info = calibration();
  info.D.clear();
  info.distortion_model = "equidistant";
  const cv::Mat image = noise(info);
  const cv::Mat rectified = RawCamera(info, "/left", image.size()).rectify(image, "/left");
  EXPECT_EQ(cv::norm(rectified, expectedImage(info, image, true), cv::NORM_INF), 0);
}

TEST(RawCamera, TakesTheSizeOfTheImageWhereNoneIsKnown) {
  sensor_msgs::CameraInfo info = calibration();
  turn(info);
  const cv::Mat image = noise(info);
  const cv::Mat expected = RawCamera(info, "/left", image.size()).rectify(image, "/left");
  info.width = info.height = 0;
  const cv::Mat found = RawCamera(info, "/left", image.size()).rectify(image, "/left");
  EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0);
}

/// The sensor is at least as large as the region of the image.
TEST(RawCamera, TakesTheSizeOfTheRegionOfInterestWhereNoneIsKnown) {
  sensor_msgs::CameraInfo info = calibration();
  const cv::Size size(40, 30);
  info.roi.x_offset = 20;
  info.roi.y_offset = 10;
  info.roi.width = 40;
  info.roi.height = 30;
  const cv::Mat image = noise(info)(cv::Rect({20, 10}, size)).clone();
  const cv::Mat expected = RawCamera(info, "/left", size).rectify(image, "/left");
  info.width = info.height = 0;
  const cv::Mat found = RawCamera(info, "/left", size).rectify(image, "/left");
  EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0);
}

TEST(RectifyImage, TakesYuvAndPlainColors) {
  const sensor_msgs::CameraInfo info = calibration();
  const cv::Size size(static_cast<int>(info.width), static_cast<int>(info.height));
  const RawCamera camera(info, "/left", size);
  const auto rectified = [&](const cv::Mat& pixels, const std::string& encoding) {
    const auto raw = boost::make_shared<sensor_msgs::Image>(toMessage(pixels, "8UC3", {}));
    raw->encoding = encoding;
    raw->step = static_cast<std::uint32_t>(pixels.step);
    raw->data.assign(pixels.datastart, pixels.dataend);
    const auto image = rectifyImage(raw, "/left", camera, false);
    EXPECT_EQ(image->encoding, "mono8");
    return cv::Mat(size, CV_8UC1, image->data.data()).clone();
  };
  const cv::Mat gray = noise(info);
  cv::Mat bgr, yuyv;
  cv::cvtColor(gray, bgr, cv::COLOR_GRAY2BGR);
  cv::merge(std::vector<cv::Mat>{gray, cv::Mat(size, CV_8UC1, cv::Scalar(128))}, yuyv);
  const cv::Mat expected = camera.rectify(gray, "/left");
  EXPECT_EQ(cv::norm(rectified(bgr, "8UC3"), expected, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(rectified(yuyv, "yuv422_yuy2"), expected, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace cbmv
