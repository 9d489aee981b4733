#include "ros/conversions.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>
#include <image_geometry/pinhole_camera_model.h>

#include "ros/stereo_pair.h"

namespace cbmv {
namespace {

const StereoTopics kTopics = {"/s/left/image_rect", "/s/left/camera_info", "/s/right/image_rect",
                              "/s/right/camera_info"};
const cv::Size kSize(37, 23);

PairMessages goodMessages(const Rig& rig = {}) {
  return makeMessages(renderPair(kSize, 3, 6), rig, ros::Time(12, 34));
}

/// Expects InputError with this fault and a message that contains `words`.
template <typename Call>
void expectInputError(const Call& call, InputFault fault, const std::vector<std::string>& words) {
  try {
    call();
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), fault) << error.what();
    for (const std::string& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "'" << word << "' is missing in: " << error.what();
    }
  }
}

GrayPair grayPairOf(const PairMessages& messages, bool allow_different_frame_ids = false) {
  return toGrayPair(toStereoInput(messages.asConst(), kTopics, allow_different_frame_ids));
}

void expectBadPair(const PairMessages& messages, InputFault fault,
                   const std::vector<std::string>& words) {
  expectInputError([&] { grayPairOf(messages); }, fault, words);
}

StereoGeometry geometryOf(const PairMessages& messages) {
  return toGeometry(*messages.left_info, *messages.right_info, kSize, kTopics);
}

void expectBadInfo(const PairMessages& messages, InputFault fault,
                   const std::vector<std::string>& words) {
  expectInputError([&] { geometryOf(messages); }, fault, words);
}

TEST(GrayPair, KeepsMono8) {
  const StereoPair pair = renderPair(kSize, 3, 6);
  const PairMessages messages = goodMessages();
  const GrayPair gray = grayPairOf(messages);
  EXPECT_EQ(cv::norm(gray.left, pair.left, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(gray.right, pair.right, cv::NORM_INF), 0);
}

TEST(GrayPair, ReadsRowsWithPadding) {
  PairMessages messages = goodMessages();
  const StereoPair pair = renderPair(kSize, 3, 6);
  cv::Mat padded;
  cv::copyMakeBorder(pair.left, padded, 0, 0, 0, 5, cv::BORDER_CONSTANT, 99);
  messages.left_image = makeImage(padded, "mono8", messages.left_image->header);
  messages.left_image->width = kSize.width;
  const GrayPair gray = grayPairOf(messages);
  EXPECT_EQ(cv::norm(gray.left, pair.left, cv::NORM_INF), 0);
}

TEST(GrayPair, ConvertsColor) {
  const StereoPair pair = renderPair(kSize, 3, 6);
  for (const auto& [encoding, code] :
       {std::pair("bgr8", cv::COLOR_GRAY2BGR), std::pair("rgba8", cv::COLOR_GRAY2RGBA)}) {
    PairMessages messages = goodMessages();
    cv::Mat left;
    cv::Mat right;
    cv::cvtColor(pair.left, left, code);
    cv::cvtColor(pair.right, right, code);
    messages.left_image = makeImage(left, encoding, messages.left_image->header);
    messages.right_image = makeImage(right, encoding, messages.right_image->header);
    const GrayPair gray = grayPairOf(messages);
    EXPECT_EQ(cv::norm(gray.left, pair.left, cv::NORM_INF), 0) << encoding;
    EXPECT_EQ(cv::norm(gray.right, pair.right, cv::NORM_INF), 0) << encoding;
  }
}

TEST(GrayPair, TakesImagesOfDifferentEncodings) {
  const StereoPair pair = renderPair(kSize, 3, 6);
  PairMessages messages = goodMessages();
  messages.left_image->encoding = "8UC1";
  cv::Mat right;
  cv::cvtColor(pair.right, right, cv::COLOR_GRAY2RGB);
  messages.right_image = makeImage(right, "rgb8", messages.right_image->header);
  const GrayPair gray = grayPairOf(messages);
  EXPECT_EQ(cv::norm(gray.left, pair.left, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(gray.right, pair.right, cv::NORM_INF), 0);
}

TEST(GrayPair, ConvertsYuvUnderAllItsNames) {
  const cv::Size even(36, 23);
  cv::Mat packed(even, CV_8UC2);
  cv::randu(packed, 0, 256);
  for (const auto& [encoding, luma_channel] :
       {std::pair("yuv422", 1), std::pair("uyvy", 1), std::pair("UYVY", 1),
        std::pair("yuv422_yuy2", 0), std::pair("yuyv", 0), std::pair("YUYV", 0),
        std::pair("yuy2", 0)}) {
    SCOPED_TRACE(encoding);
    PairMessages messages = goodMessages();
    messages.left_image = makeImage(packed, encoding, messages.left_image->header);
    messages.right_image = makeImage(packed, encoding, messages.right_image->header);
    cv::Mat luma;
    cv::extractChannel(packed, luma, luma_channel);
    EXPECT_EQ(cv::norm(grayPairOf(messages).left, luma, cv::NORM_INF), 0);
    cv::Mat bgr;
    cv::cvtColor(packed, bgr, luma_channel == 1 ? cv::COLOR_YUV2BGR_UYVY : cv::COLOR_YUV2BGR_YUY2);
    EXPECT_EQ(cv::norm(toColor(*messages.left_image, "/color", even), bgr, cv::NORM_INF), 0);
  }
}

/// The encoding that cv_bridge sets in Python if none is given.
TEST(GrayPair, TakesPlainChannelsAsBlueGreenRedWithAWarning) {
  PairMessages messages = goodMessages();
  EXPECT_TRUE(toStereoInput(messages.asConst(), kTopics, false).warnings.empty());
  const cv::Mat color(kSize, CV_8UC3, cv::Scalar(10, 100, 200));
  messages.left_image = makeImage(color, "bgr8", messages.left_image->header);
  messages.right_image = makeImage(color, "8UC3", messages.right_image->header);
  const StereoInput input = toStereoInput(messages.asConst(), kTopics, false);
  const GrayPair gray = toGrayPair(input);
  EXPECT_EQ(cv::norm(gray.left, gray.right, cv::NORM_INF), 0);
  ASSERT_EQ(input.warnings.size(), 1U);
  EXPECT_NE(input.warnings[0].find(kTopics.right_image + " has the encoding '8UC3'"),
            std::string::npos);
  EXPECT_EQ(toColor(*messages.right_image, "/color", kSize).at<cv::Vec3b>(2, 2),
            cv::Vec3b(10, 100, 200));
}

/// A scene with one gray level, seen through a Bayer mosaic with brighter green pixels.
TEST(GrayPair, ConvertsBayer) {
  for (const char* encoding :
       {"bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8", "bayer_rggb16"}) {
    SCOPED_TRACE(encoding);
    const bool deep = std::string(encoding).find("16") != std::string::npos;
    cv::Mat mosaic(kSize, deep ? CV_16UC1 : CV_8UC1);
    const bool green_first = encoding[6] == 'g';
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        const bool green = ((x + y) % 2 == 0) == green_first;
        // The left half is dark, the right half bright; red and blue pixels get half of it.
        const int level = (x < kSize.width / 2 ? 40 : 200) / (green ? 1 : 2);
        deep ? mosaic.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(level * 16)
             : mosaic.at<uchar>(y, x) = static_cast<uchar>(level);
      }
    }
    PairMessages messages = goodMessages();
    messages.left_image = makeImage(mosaic, encoding, messages.left_image->header);
    messages.right_image = makeImage(mosaic, encoding, messages.right_image->header);
    const GrayPair gray = grayPairOf(messages);
    const cv::Rect dark(2, 2, kSize.width / 2 - 5, kSize.height - 4);
    const cv::Rect bright(kSize.width / 2 + 4, 2, kSize.width / 2 - 6, kSize.height - 4);
    for (const cv::Rect& half : {dark, bright}) {  // the mosaic has been removed
      double lowest = 0;
      double highest = 0;
      cv::minMaxLoc(gray.left(half), &lowest, &highest);
      EXPECT_LE(highest - lowest, 1);
    }
    EXPECT_GT(cv::mean(gray.left(bright))[0], cv::mean(gray.left(dark))[0] + 100);
  }
}

/// 12 bits in 16. A division by 256 would leave only 16 levels.
TEST(GrayPair, SixteenBitsKeepTheirContrast) {
  cv::RNG random(5);
  cv::Mat left(kSize, CV_16UC1);
  cv::Mat right(kSize, CV_16UC1);
  random.fill(left, cv::RNG::UNIFORM, 1000, 3000);
  random.fill(right, cv::RNG::UNIFORM, 1500, 4096);
  for (const char* encoding : {"mono16", "16UC1"}) {
    SCOPED_TRACE(encoding);
    PairMessages messages = goodMessages();
    messages.left_image = makeImage(left, encoding, messages.left_image->header);
    messages.right_image = makeImage(right, encoding, messages.right_image->header);
    const GrayPair gray = grayPairOf(messages);

    std::vector<std::uint16_t> all(left.begin<std::uint16_t>(), left.end<std::uint16_t>());
    all.insert(all.end(), right.begin<std::uint16_t>(), right.end<std::uint16_t>());
    std::sort(all.begin(), all.end());
    const auto outliers = static_cast<std::size_t>(0.001 * static_cast<double>(all.size()));
    const double black = all[outliers];
    const double white = all[all.size() - 1 - outliers];
    const auto expect_stretched = [&](const cv::Mat& deep, const cv::Mat& stretched) {
      for (int y = 0; y < kSize.height; ++y) {
        for (int x = 0; x < kSize.width; ++x) {
          const double wanted = 255 * (deep.at<std::uint16_t>(y, x) - black) / (white - black);
          ASSERT_NEAR(stretched.at<uchar>(y, x), std::clamp(wanted, 0.0, 255.0), 0.51 + 1e-3);
        }
      }
    };
    expect_stretched(left, gray.left);
    expect_stretched(right, gray.right);
  }
}

TEST(GrayPair, OutliersDoNotTakeTheLevelsOfSixteenBits) {
  PairMessages messages = goodMessages();
  cv::Mat deep;
  renderPair(kSize, 3, 6).left.convertTo(deep, CV_16U, 2, 7000);
  messages.right_image = makeImage(deep, "mono16", messages.right_image->header);
  deep.at<std::uint16_t>(3, 4) = 65535;  // a hot pixel
  messages.left_image = makeImage(deep, "mono16", messages.left_image->header);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(grayPairOf(messages).left, mean, deviation);
  EXPECT_GT(deviation[0], 30);
}

TEST(GrayPair, EvenSixteenBitImagesAreEven) {
  PairMessages messages = goodMessages();
  const cv::Mat even(kSize, CV_16UC1, cv::Scalar(1234));
  messages.left_image = makeImage(even, "mono16", messages.left_image->header);
  messages.right_image = makeImage(even, "mono16", messages.right_image->header);
  const GrayPair gray = grayPairOf(messages);
  EXPECT_EQ(cv::norm(gray.left, gray.right, cv::NORM_INF), 0);
}

/// The message as written by a machine with the other byte order, with padded rows.
sensor_msgs::ImagePtr toBigEndian(const sensor_msgs::Image& message, std::uint32_t value_bytes) {
  auto big = boost::make_shared<sensor_msgs::Image>(message);
  big->is_bigendian = 1;
  big->step += value_bytes;
  big->data.assign(static_cast<std::size_t>(big->step) * big->height, 0xAB);
  for (std::uint32_t y = 0; y < message.height; ++y) {
    for (std::uint32_t i = 0; i < message.step; ++i) {
      const std::uint32_t mirrored = i - i % value_bytes + value_bytes - 1 - i % value_bytes;
      big->data[y * big->step + i] = message.data[y * message.step + mirrored];
    }
  }
  return big;
}

TEST(GrayPair, TakesBothOrdersOfBytes) {
  for (const auto& [encoding, type] : {std::pair("mono16", CV_16UC1), std::pair("16UC1", CV_16UC1),
                                       std::pair("bgr16", CV_16UC3)}) {
    PairMessages messages = goodMessages();
    for (sensor_msgs::ImagePtr* image : {&messages.left_image, &messages.right_image}) {
      cv::Mat deep(kSize, type);
      cv::randu(deep, 0, 65536);
      *image = makeImage(deep, encoding, (*image)->header);
    }
    const GrayPair expected = grayPairOf(messages);
    messages.left_image = toBigEndian(*messages.left_image, 2);
    messages.right_image = toBigEndian(*messages.right_image, 2);
    const GrayPair found = grayPairOf(messages);
    EXPECT_EQ(cv::norm(found.left, expected.left, cv::NORM_INF), 0) << encoding;
    EXPECT_EQ(cv::norm(found.right, expected.right, cv::NORM_INF), 0) << encoding;
  }
  cv::Mat floats(kSize, CV_32FC1);
  cv::randu(floats, -5, 5);
  const sensor_msgs::Image message = toMessage(floats, "32FC1", {});
  EXPECT_EQ(cv::norm(toFloats(*toBigEndian(message, 4), "t"), floats, cv::NORM_INF), 0);
}

TEST(GrayPair, RejectsWhatDiffers) {
  PairMessages messages = goodMessages();
  messages.right_image =
      makeImage(cv::Mat(20, 37, CV_8UC1, cv::Scalar(7)), "mono8", messages.right_image->header);
  expectBadPair(messages, InputFault::kDifferentSizes,
                {kTopics.left_image, kTopics.right_image, "37 x 23", "37 x 20"});

  messages = goodMessages();
  messages.right_image->header.frame_id = "right_camera";
  expectBadPair(
      messages, InputFault::kDifferentFrameIds,
      {kTopics.left_image, kTopics.right_image, "'left_camera'", "'right_camera'", "allow_"});
  EXPECT_NO_THROW(grayPairOf(messages, true));
}

TEST(GrayPair, RejectsMalformedImages) {
  PairMessages messages = goodMessages();
  messages.left_image->width = messages.right_image->width = 0;
  expectBadPair(messages, InputFault::kEmptyImage, {kTopics.left_image, "0 x 23"});

  messages = goodMessages();
  messages.right_image->step = 36;
  expectBadPair(messages, InputFault::kTruncatedImage, {kTopics.right_image, "36", "37"});

  messages = goodMessages();
  messages.right_image->data.resize(100);
  expectBadPair(messages, InputFault::kTruncatedImage, {kTopics.right_image, "100", "851"});

  messages = goodMessages();
  messages.left_image->encoding = messages.right_image->encoding = "nonsense";
  expectBadPair(messages, InputFault::kUnsupportedEncoding, {kTopics.left_image, "'nonsense'"});

  messages = goodMessages();
  const cv::Mat floats(kSize, CV_32FC1, cv::Scalar(1));
  messages.left_image = makeImage(floats, "32FC1", messages.left_image->header);
  messages.right_image = makeImage(floats, "32FC1", messages.right_image->header);
  expectBadPair(messages, InputFault::kUnsupportedEncoding,
                {kTopics.left_image, "'32FC1'", "Expected mono8", "driver"});
}

TEST(Color, AllEncodingsGiveTheSame) {
  cv::Mat bgr(kSize, CV_8UC3);
  cv::randu(bgr, 0, 256);
  for (const auto& [encoding, code] :
       {std::pair("bgr8", -1), std::pair("rgb8", +cv::COLOR_BGR2RGB),
        std::pair("bgra8", +cv::COLOR_BGR2BGRA), std::pair("rgba8", +cv::COLOR_BGR2RGBA)}) {
    cv::Mat sent = bgr.clone();
    if (code >= 0) {
      cv::cvtColor(bgr, sent, code);
    }
    const auto message = makeImage(sent, encoding, {});
    EXPECT_EQ(cv::norm(toColor(*message, "/color", kSize), bgr, cv::NORM_INF), 0) << encoding;
  }
  const cv::Mat gray(kSize, CV_8UC1, cv::Scalar(42));
  EXPECT_EQ(toColor(*makeImage(gray, "mono8", {}), "/color", kSize).at<cv::Vec3b>(3, 4),
            cv::Vec3b(42, 42, 42));
}

TEST(Color, TakesBayerAndSixteenBits) {
  const cv::Mat mosaic(kSize, CV_8UC1, cv::Scalar(77));
  EXPECT_EQ(toColor(*makeImage(mosaic, "bayer_rggb8", {}), "/color", kSize).at<cv::Vec3b>(9, 9),
            cv::Vec3b(77, 77, 77));
  cv::Mat deep(kSize, CV_16UC3, cv::Scalar(0, 2048, 4095));
  const cv::Mat color = toColor(*makeImage(deep, "rgb16", {}), "/color", kSize);
  EXPECT_EQ(color.at<cv::Vec3b>(9, 9), cv::Vec3b(255, 128, 0));
}

TEST(Color, RejectsOtherSizesAndEncodings) {
  expectInputError(
      [&] {
        toColor(*makeImage(cv::Mat(kSize, CV_8UC3), "bgr8", {}), "/color", {38, 23});
      },
      InputFault::kDifferentSizes, {"/color", "37 x 23", "38 x 23"});
  expectInputError(
      [&] { toColor(*makeImage(cv::Mat(kSize, CV_64FC1), "64FC1", {}), "/color", kSize); },
      InputFault::kUnsupportedEncoding, {"/color", "64FC1"});
}

TEST(Geometry, ReadsProjectionMatrices) {
  const Rig rig{120, 0.25, 62.5, 52.5, 40.25};
  const StereoGeometry geometry = geometryOf(goodMessages(rig));
  EXPECT_DOUBLE_EQ(geometry.focal_length_px, 120);
  EXPECT_DOUBLE_EQ(geometry.baseline_m, 0.25);
  EXPECT_DOUBLE_EQ(geometry.disparity_offset_px, 10);
  EXPECT_DOUBLE_EQ(geometry.left_fx_px, 120);
  EXPECT_DOUBLE_EQ(geometry.left_fy_px, 120);
  EXPECT_DOUBLE_EQ(geometry.left_cx_px, 62.5);
  EXPECT_DOUBLE_EQ(geometry.left_cy_px, 40.25);
}

TEST(Geometry, FollowsBinningAndRegionOfInterest) {
  PairMessages messages = goodMessages();
  for (const auto& info : {messages.left_info, messages.right_info}) {
    info->width = 200;
    info->height = 100;
    info->binning_x = info->binning_y = 2;
    info->roi.width = 75;  // of 37 px after binning
    info->roi.height = 46;
    info->roi.y_offset = 20;
  }
  messages.left_info->roi.x_offset = 12;
  messages.right_info->roi.x_offset = 8;
  const StereoGeometry geometry = geometryOf(messages);
  EXPECT_DOUBLE_EQ(geometry.focal_length_px, 60);
  EXPECT_DOUBLE_EQ(geometry.baseline_m, 0.25);
  EXPECT_DOUBLE_EQ(geometry.left_cx_px, (62.5 - 12) / 2);
  EXPECT_DOUBLE_EQ(geometry.left_cy_px, (40.25 - 20) / 2);
  EXPECT_DOUBLE_EQ(geometry.disparity_offset_px, (8 - 12) / 2.0);
}

TEST(Geometry, RejectsUnusableCameras) {
  PairMessages messages = goodMessages();
  messages.right_info->P.assign(0);
  expectBadInfo(messages, InputFault::kUncalibrated, {kTopics.right_info, "P[0]"});

  messages = goodMessages();
  messages.left_info->P[2] = std::numeric_limits<double>::quiet_NaN();
  expectBadInfo(messages, InputFault::kUncalibrated, {kTopics.left_info});

  for (const double tx : {0.0, 30.0}) {
    messages = goodMessages();
    messages.right_info->P[3] = tx;
    expectBadInfo(messages, InputFault::kUncalibrated,
                  {kTopics.right_info, "P[3]", tx > 0 ? "exchanged" : "calibrated separately"});
  }
  messages = goodMessages();  // each value is possible, but not their quotient
  messages.right_info->P[0] = 1e-6;
  messages.right_info->P[3] = -1e6;
  expectBadInfo(messages, InputFault::kUncalibrated,
                {kTopics.right_info, "without reasonable size"});

  messages = goodMessages();
  messages.left_info->width = 640;
  messages.left_info->height = 480;
  expectBadInfo(messages, InputFault::kCameraInfoSize, {kTopics.left_info, "640 x 480", "37 x 23"});
}

/// Numbers above some limit do not belong to a camera, and values computed from them do not fit
/// into a float.
TEST(Geometry, RejectsNumbersOfNoCamera) {
  for (const double value : {1e300, -1e10, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    for (const std::size_t entry : {0U, 2U, 3U, 5U, 6U, 11U}) {
      PairMessages messages = goodMessages();
      messages.right_info->P[entry] = value;
      expectBadInfo(messages, InputFault::kUncalibrated,
                    {kTopics.right_info, "P[" + std::to_string(entry) + "] = "});
    }
  }
  PairMessages messages = goodMessages();
  messages.left_info->P[5] = 1e-300;
  expectBadInfo(messages, InputFault::kUncalibrated, {kTopics.left_info, "P[5] = 1e-300"});
  messages = goodMessages();
  messages.right_info->P[3] = -1e-300;
  expectBadInfo(messages, InputFault::kUncalibrated, {kTopics.right_info, "P[3]"});
  messages = goodMessages();
  messages.left_info->width = std::numeric_limits<std::uint32_t>::max();
  expectBadInfo(messages, InputFault::kCameraInfoSize, {kTopics.left_info, "2147483647 x 23"});
}

TEST(Quoted, IsShortAndPrintable) {
  EXPECT_EQ(quoted("mono8"), "'mono8'");
  EXPECT_EQ(quoted(std::string("a\n\0\xff b", 6)), "'a??? b'");
  const std::string shown = quoted(std::string(100000, 'x'));
  EXPECT_LT(shown.size(), 100U);
  EXPECT_EQ(shown.substr(shown.size() - 5), "x...'");
}

TEST(Geometry, RectifiedInfoIsTheGeometry) {
  const StereoGeometry geometry{90, 0.25, 0, 110, 120, 60.5, 40.25};
  std_msgs::Header header;
  header.stamp = ros::Time(12, 34);
  header.frame_id = "left_camera";
  const sensor_msgs::CameraInfo info = toRectifiedInfo(geometry, kSize, header);
  EXPECT_EQ(info.header, header);
  EXPECT_EQ(cv::Size(static_cast<int>(info.width), static_cast<int>(info.height)), kSize);
  image_geometry::PinholeCameraModel model;
  model.fromCameraInfo(info);
  EXPECT_EQ(model.fx(), 110);
  EXPECT_EQ(model.fy(), 120);
  EXPECT_EQ(model.cx(), 60.5);
  EXPECT_EQ(model.cy(), 40.25);
  EXPECT_EQ(model.Tx(), 0);
  EXPECT_EQ(info.K[0], 110);  // for subscribers that use K instead of P
  EXPECT_EQ(info.K[2], 60.5);
  EXPECT_EQ(info.K[4], 120);
  EXPECT_EQ(info.K[5], 40.25);
  EXPECT_EQ(info.D, std::vector<double>(5, 0.0));
  EXPECT_EQ(info.binning_x, 0U);
  EXPECT_EQ(info.roi.width, 0U);
}

/// A result with one pixel of each kind: valid, invalid, and beyond infinity in a toed-in rig.
StereoResult smallResult() {
  StereoResult result;
  result.range = {-2, 8};
  result.disparity = (cv::Mat_<float>(2, 3) << -3, -2, 0.25F, 5, 3.5F, -3);
  result.confidence = (cv::Mat_<float>(2, 3) << 0, 0.125F, 0.25F, 0.5F, 0.75F, 1);
  result.disparity_sigma = (cv::Mat_<float>(2, 3) << 0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F);
  return result;
}

StereoGeometry smallGeometry() { return {120, 0.25, 1.5, 100, 90, 1.25, 0.5}; }

std_msgs::Header someHeader() {
  std_msgs::Header header;
  header.stamp = ros::Time(12, 34);
  header.frame_id = "left_camera";
  return header;
}

TEST(DisparityImage, HasEveryField) {
  const stereo_msgs::DisparityImage message =
      toDisparityImage(smallResult(), smallGeometry(), 0.5, someHeader());
  EXPECT_EQ(message.header, someHeader());
  EXPECT_EQ(message.image.header, someHeader());
  EXPECT_EQ(message.image.encoding, "32FC1");
  EXPECT_EQ(message.image.width, 3U);
  EXPECT_EQ(message.image.height, 2U);
  EXPECT_EQ(message.image.step, 12U);
  EXPECT_EQ(message.image.is_bigendian, 0);
  EXPECT_EQ(message.f, 120.0F);
  EXPECT_EQ(message.T, 0.25F);
  EXPECT_EQ(message.delta_d, 0.5F);
  EXPECT_EQ(message.min_disparity, -3.5F);
  EXPECT_EQ(message.max_disparity, 3.5F);
  const std::vector<float> expected = {-4.5F, -3.5F, -1.25F, 3.5F, 2, -4.5F};
  ASSERT_EQ(message.image.data.size(), expected.size() * sizeof(float));
  EXPECT_EQ(std::memcmp(message.image.data.data(), expected.data(), message.image.data.size()), 0);
}

TEST(DisparityImage, ValidWindowHoldsTheColumnsThatHaveAHypothesis) {
  for (const DisparityRange range :
       {DisparityRange{0, 5}, DisparityRange{3, 4}, DisparityRange{-6, 4}, DisparityRange{-2, 5},
        DisparityRange{20, 4}, DisparityRange{-30, 4}}) {
    StereoResult result;
    result.range = range;
    result.disparity = cv::Mat_<float>(4, 11, range.invalid());
    const auto window = toDisparityImage(result, smallGeometry(), 1, {}).valid_window;
    for (int x = 0; x < 11; ++x) {
      bool any = false;
      for (int d = range.min; d <= range.max(); ++d) {
        any = any || (x - d >= 0 && x - d < 11);
      }
      const bool inside = x >= static_cast<int>(window.x_offset) &&
                          x < static_cast<int>(window.x_offset + window.width);
      EXPECT_EQ(inside, any) << "column " << x << ", disparities from " << range.min;
    }
    EXPECT_LE(window.x_offset + window.width, 11U);
    EXPECT_EQ(window.y_offset, 0U);
    EXPECT_EQ(window.height, 4U);
    EXPECT_FALSE(window.do_rectify);
  }
}

TEST(DisparityImage, ValidWindowHoldsWhatWasFilledIn) {
  StereoResult result;
  result.range = {3, 4};
  result.disparity = cv::Mat_<float>(4, 11, result.range.invalid());
  result.disparity.at<float>(2, 1) = 4;  // no hypothesis is inside the image here
  auto window = toDisparityImage(result, smallGeometry(), 1, {}).valid_window;
  EXPECT_EQ(window.x_offset, 0U);
  EXPECT_EQ(window.width, 11U);
  result.range = {-6, 4};
  result.disparity.setTo(result.range.invalid());
  result.disparity.at<float>(2, 10) = -4;
  window = toDisparityImage(result, smallGeometry(), 1, {}).valid_window;
  EXPECT_EQ(window.x_offset, 0U);
  EXPECT_EQ(window.width, 11U);
}

TEST(PointCloud, HasEveryField) {
  const StereoGeometry geometry = smallGeometry();
  cv::Mat color(2, 3, CV_8UC3);
  cv::randu(color, 0, 256);
  const sensor_msgs::PointCloud2 cloud = toPointCloud(
      {toValidDisparity(smallResult(), geometry), color, {}, {}}, geometry, {}, someHeader());
  EXPECT_EQ(cloud.header, someHeader());
  EXPECT_EQ(cloud.width, 3U);
  EXPECT_EQ(cloud.height, 2U);
  EXPECT_EQ(cloud.point_step, 32U);
  EXPECT_EQ(cloud.row_step, 96U);
  EXPECT_EQ(cloud.is_bigendian, 0);
  EXPECT_EQ(cloud.is_dense, 0);
  ASSERT_EQ(cloud.data.size(), 192U);
  ASSERT_EQ(cloud.fields.size(), 4U);
  const std::array<const char*, 4> names = {"x", "y", "z", "rgb"};
  const std::array<std::uint32_t, 4> offsets = {0, 4, 8, 16};
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(cloud.fields[i].name, names[i]);
    EXPECT_EQ(cloud.fields[i].offset, offsets[i]);
    EXPECT_EQ(cloud.fields[i].datatype, sensor_msgs::PointField::FLOAT32);
    EXPECT_EQ(cloud.fields[i].count, 1U);
  }
  const StereoResult result = smallResult();
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      const std::uint8_t* bytes = &cloud.data[y * 96 + x * 32];
      std::array<float, 3> point;
      std::memcpy(point.data(), bytes, sizeof(point));
      const double d = result.disparity.at<float>(y, x) - 1.5;
      if (d > 0) {  // pixels without a disparity are below it, too
        const double z = 120 * 0.25 / d;
        EXPECT_FLOAT_EQ(point[0], static_cast<float>((x - 1.25) * z / 100));
        EXPECT_FLOAT_EQ(point[1], static_cast<float>((y - 0.5) * z / 90));
        EXPECT_FLOAT_EQ(point[2], static_cast<float>(z));
      } else {
        EXPECT_TRUE(std::isnan(point[0]) && std::isnan(point[1]) && std::isnan(point[2]));
      }
      const auto bgr = color.at<cv::Vec3b>(y, x);
      EXPECT_EQ(cv::Vec3b(bytes[16], bytes[17], bytes[18]), bgr);
      EXPECT_EQ(bytes[19], 0);
    }
  }
}

TEST(PointCloud, InvalidPixelsStayMissingWhereTheInvalidValueIsPositive) {
  StereoResult result;
  result.range = {5, 4};
  result.disparity = (cv::Mat_<float>(1, 2) << result.range.invalid(), 5);
  const StereoGeometry geometry{120, 0.25, 0, 100, 90, 1, 1};
  const auto cloud = toPointCloud(
      {toValidDisparity(result, geometry), cv::Mat(1, 2, CV_8UC3), {}, {}}, geometry, {}, {});
  float z = 0;
  std::memcpy(&z, &cloud.data[8], sizeof(z));
  EXPECT_TRUE(std::isnan(z));
  std::memcpy(&z, &cloud.data[40], sizeof(z));
  EXPECT_FLOAT_EQ(z, 6);
}

/// The float value of a field of point i.
float fieldOf(const sensor_msgs::PointCloud2& cloud, const std::string& name, std::size_t i) {
  for (const auto& field : cloud.fields) {
    if (field.name == name) {
      float value = 0;
      std::memcpy(&value, &cloud.data[i * cloud.point_step + field.offset], sizeof(value));
      return value;
    }
  }
  ADD_FAILURE() << "no field " << name;
  return 0;
}

/// Expects equal values, or both NaN.
void expectSameFloat(float found, float expected) {
  EXPECT_TRUE(found == expected || (std::isnan(found) && std::isnan(expected)))
      << found << ", expected " << expected;
}

TEST(PointCloud, LayoutsHoldTheSamePoints) {
  const StereoGeometry geometry = smallGeometry();
  const StereoResult result = smallResult();
  cv::Mat color(2, 3, CV_8UC3);
  cv::randu(color, 0, 256);
  const cv::Mat sigma = toDepthSigma(result, geometry);
  const CloudSource source{toValidDisparity(result, geometry), color, result.confidence, sigma};
  const auto stock = toPointCloud(source, geometry, {}, someHeader());
  struct Case {
    bool compact;
    bool with_confidence;
    bool with_sigma;
    std::uint32_t point_step;
    std::vector<std::pair<std::string, std::uint32_t>> fields;
  };
  for (const Case& wanted :
       {Case{true, false, false, 16, {{"rgb", 12}}},
        Case{true, true, false, 20, {{"rgb", 12}, {"confidence", 16}}},
        Case{true, false, true, 20, {{"rgb", 12}, {"sigma", 16}}},
        Case{true, true, true, 24, {{"rgb", 12}, {"confidence", 16}, {"sigma", 20}}},
        Case{false, true, false, 32, {{"rgb", 16}, {"confidence", 20}}},
        Case{false, false, true, 32, {{"rgb", 16}, {"sigma", 24}}},
        Case{false, true, true, 32, {{"rgb", 16}, {"confidence", 20}, {"sigma", 24}}}}) {
    CloudOptions options;
    options.compact = wanted.compact;
    options.with_confidence = wanted.with_confidence;
    options.with_sigma = wanted.with_sigma;
    const auto cloud = toPointCloud(source, geometry, options, someHeader());
    EXPECT_EQ(cloud.point_step, wanted.point_step);
    EXPECT_EQ(cloud.row_step, 3 * wanted.point_step);
    ASSERT_EQ(cloud.data.size(), 6U * wanted.point_step);
    ASSERT_EQ(cloud.fields.size(), 3 + wanted.fields.size());
    for (std::size_t i = 0; i < wanted.fields.size(); ++i) {
      EXPECT_EQ(cloud.fields[3 + i].name, wanted.fields[i].first);
      EXPECT_EQ(cloud.fields[3 + i].offset, wanted.fields[i].second);
      EXPECT_EQ(cloud.fields[3 + i].datatype, sensor_msgs::PointField::FLOAT32);
      EXPECT_EQ(cloud.fields[3 + i].count, 1U);
    }
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(std::memcmp(&cloud.data[i * wanted.point_step], &stock.data[i * 32], 12), 0);
      EXPECT_EQ(std::memcmp(&cloud.data[i * wanted.point_step + wanted.fields[0].second],
                            &stock.data[i * 32 + 16], 4),
                0);
      if (wanted.with_confidence) {
        EXPECT_EQ(fieldOf(cloud, "confidence", i),
                  result.confidence.at<float>(static_cast<int>(i)));
      }
      if (wanted.with_sigma) {
        expectSameFloat(fieldOf(cloud, "sigma", i), sigma.at<float>(static_cast<int>(i)));
      }
    }
  }
}

TEST(PointCloud, LimitsOfDepth) {
  const StereoGeometry geometry{120, 0.25, 0, 100, 90, 1, 1};            // f T = 30
  const cv::Mat disparity = (cv::Mat_<float>(1, 5) << 3, 5, 6, 10, 15);  // 10, 6, 5, 3, 2 m
  const CloudSource source{disparity, cv::Mat(1, 5, CV_8UC3), {}, {}};
  const auto is_there = [&](const CloudOptions& options) {
    const auto cloud = toPointCloud(source, geometry, options, {});
    std::string there;
    for (std::size_t i = 0; i < 5; ++i) {
      there += std::isnan(fieldOf(cloud, "x", i)) ? '-' : 'x';
    }
    return there;
  };
  const auto with_sigma = [&](const cv::Mat& sigma) {
    CloudOptions options{3, 6, false, false, true};
    const auto cloud = toPointCloud({disparity, source.color, {}, sigma}, geometry, options, {});
    std::vector<float> values;
    for (std::size_t i = 0; i < 5; ++i) {
      values.push_back(fieldOf(cloud, "sigma", i));
    }
    return values;
  };
  const std::vector<float> sigma = with_sigma(cv::Mat(1, 5, CV_32FC1, cv::Scalar(0.5)));
  const std::vector<float> unknown = with_sigma({});
  for (std::size_t i = 0; i < 5; ++i) {
    const bool is_inside = i > 0 && i < 4;
    expectSameFloat(sigma[i], is_inside ? 0.5F : std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(std::isnan(unknown[i]));
  }
  EXPECT_EQ(is_there({}), "xxxxx");
  EXPECT_EQ(is_there({3, 6, false, false}), "-xxx-");
  EXPECT_EQ(is_there({0, 5.5, false, false}), "--xxx");
  EXPECT_EQ(is_there({2.5, 0, false, false}), "xxxx-");
}

TEST(PointCloud, FarthestPlaneOfADenseDisparityStays) {
  StereoResult result;
  result.range = {4, 8};
  result.disparity = cv::Mat_<float>(2, 3, 4.0F);
  result.disparity.at<float>(1, 1) = 9;
  const StereoGeometry geometry{120, 0.25, 0, 100, 90, 1, 1};
  const auto message = toDisparityImage(result, geometry, 1, {});
  for (const cv::Mat& disparity :
       {toValidDisparity(result, geometry), toValidDisparity(message, "/disparity")}) {
    const auto cloud = toPointCloud({disparity, cv::Mat(2, 3, CV_8UC3), {}, {}}, geometry, {}, {});
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_FLOAT_EQ(fieldOf(cloud, "z", i), i == 4 ? 30.0F / 9 : 7.5F) << i;
    }
  }
}

TEST(ValidDisparity, OfAMessageLeavesOutEveryKindOfInvalidPixel) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  stereo_msgs::DisparityImage message;
  message.min_disparity = -2;
  message.max_disparity = 9;
  const cv::Mat sent = (cv::Mat_<float>(1, 8) << -3, -2.5F, nan, infinity, -infinity, -2, 0.5F, 9);
  message.image = *makeImage(sent, "32FC1", {});
  const cv::Mat valid = toValidDisparity(message, "/disparity");
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(std::isnan(valid.at<float>(i)), i < 5) << i;
  }
  EXPECT_EQ(valid.at<float>(5), -2);
  EXPECT_EQ(valid.at<float>(6), 0.5F);
  EXPECT_EQ(valid.at<float>(7), 9);

  message.image.encoding = "16UC1";
  expectInputError([&] { toValidDisparity(message, "/disparity"); },
                   InputFault::kUnsupportedEncoding, {"/disparity", "16UC1", "32FC1"});
  message.image.encoding = "32FC1";
  message.image.data.pop_back();
  expectInputError([&] { toValidDisparity(message, "/disparity"); }, InputFault::kTruncatedImage,
                   {"/disparity"});
}

TEST(DepthImage, IsMetresAndNotANumberWhereThereIsNone) {
  const StereoGeometry geometry = smallGeometry();
  const StereoResult result = smallResult();
  const sensor_msgs::Image message = toDepthImage(result, geometry, someHeader());
  EXPECT_EQ(message.header, someHeader());
  EXPECT_EQ(message.encoding, "32FC1");
  EXPECT_EQ(message.width, 3U);
  EXPECT_EQ(message.height, 2U);
  EXPECT_EQ(message.step, 12U);
  EXPECT_EQ(message.is_bigendian, 0);
  ASSERT_EQ(message.data.size(), 24U);
  for (int i = 0; i < 6; ++i) {
    float depth = 0;
    std::memcpy(&depth, &message.data[4 * static_cast<std::size_t>(i)], sizeof(depth));
    const float found = result.disparity.at<float>(i);
    if (found == result.range.invalid() || found <= 1.5F) {
      EXPECT_TRUE(std::isnan(depth)) << i;
    } else {
      EXPECT_FLOAT_EQ(depth, static_cast<float>(120 * 0.25 / (found - 1.5)));
    }
  }
}

TEST(DepthSigmaImage, IsMetresAndNotANumberWhereThereIsNoDepth) {
  const StereoGeometry geometry = smallGeometry();
  StereoResult result = smallResult();
  const sensor_msgs::Image message = toDepthSigmaImage(result, geometry, someHeader());
  const sensor_msgs::Image depths = toDepthImage(result, geometry, someHeader());
  EXPECT_EQ(message.header, someHeader());
  EXPECT_EQ(message.encoding, "32FC1");
  EXPECT_EQ(message.width, 3U);
  EXPECT_EQ(message.height, 2U);
  EXPECT_EQ(message.step, 12U);
  ASSERT_EQ(message.data.size(), 24U);
  int known = 0;
  for (int i = 0; i < 6; ++i) {
    float depth = 0;
    float sigma = 0;
    std::memcpy(&depth, &depths.data[4 * static_cast<std::size_t>(i)], sizeof(depth));
    std::memcpy(&sigma, &message.data[4 * static_cast<std::size_t>(i)], sizeof(sigma));
    ASSERT_EQ(std::isnan(sigma), std::isnan(depth)) << i;
    if (!std::isnan(depth)) {
      ++known;
      const double d = result.disparity.at<float>(i) - 1.5;
      EXPECT_FLOAT_EQ(sigma, static_cast<float>(30 * result.disparity_sigma.at<float>(i) / d / d));
    }
  }
  EXPECT_EQ(known, 2);
  result.disparity_sigma.release();
  EXPECT_TRUE(toDepthSigma(result, geometry).empty());
}

TEST(RawDepthImage, IsMillimetresAndZeroWhereThereIsNone) {
  StereoResult result;
  result.range = {0, 64};
  result.disparity = (cv::Mat_<float>(1, 6) << -1, 0, 7, 0.5F, 0.45F, 13.7F);
  const StereoGeometry geometry{120, 0.25, 0, 100, 90, 1, 1};  // f T = 30
  const sensor_msgs::Image message = toRawDepthImage(result, geometry, someHeader());
  EXPECT_EQ(message.header, someHeader());
  EXPECT_EQ(message.encoding, "16UC1");
  EXPECT_EQ(message.step, 12U);
  ASSERT_EQ(message.data.size(), 12U);
  std::array<std::uint16_t, 6> depth;
  std::memcpy(depth.data(), message.data.data(), 12);
  // 30 / 0.45 is 66.7 m, which does not fit into 16 bits.
  EXPECT_EQ(depth, (std::array<std::uint16_t, 6>{0, 0, 4286, 60000, 0, 2190}));
}

TEST(ValidMask, IsWhereTheDisparityIs) {
  const sensor_msgs::Image message = toValidMask(smallResult(), someHeader());
  EXPECT_EQ(message.header, someHeader());
  EXPECT_EQ(message.encoding, "mono8");
  EXPECT_EQ(message.width, 3U);
  EXPECT_EQ(message.height, 2U);
  EXPECT_EQ(message.step, 3U);
  EXPECT_EQ(message.data, (std::vector<std::uint8_t>{0, 255, 255, 255, 255, 0}));
}

TEST(ConfidenceImage, HasEveryField) {
  const StereoResult result = smallResult();
  const sensor_msgs::Image message = toConfidenceImage(result, someHeader());
  EXPECT_EQ(message.header, someHeader());
  EXPECT_EQ(message.encoding, "32FC1");
  EXPECT_EQ(message.width, 3U);
  EXPECT_EQ(message.height, 2U);
  EXPECT_EQ(message.step, 12U);
  EXPECT_EQ(message.is_bigendian, 0);
  ASSERT_EQ(message.data.size(), 24U);
  EXPECT_EQ(std::memcmp(message.data.data(), result.confidence.data, 24), 0);
}

TEST(DisparityColorImage, RunsFromBlueToRedAndIsBlackWhereThereIsNone) {
  const sensor_msgs::Image message = toDisparityColorImage(smallResult(), someHeader());
  EXPECT_EQ(message.header, someHeader());
  EXPECT_EQ(message.encoding, "rgb8");
  EXPECT_EQ(message.width, 3U);
  EXPECT_EQ(message.height, 2U);
  EXPECT_EQ(message.step, 9U);
  ASSERT_EQ(message.data.size(), 18U);
  const auto pixel = [&](int i) {
    return cv::Vec3b(message.data[3 * i], message.data[3 * i + 1], message.data[3 * i + 2]);
  };
  EXPECT_EQ(pixel(0), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(pixel(5), cv::Vec3b(0, 0, 0));
  EXPECT_GE(pixel(1)[2], pixel(1)[0]);  // the smallest disparity: more blue than red
  EXPECT_GT(pixel(3)[0], pixel(3)[2]);  // the largest: more red than blue
}

TEST(StatusMessage, HasEveryField) {
  StereoResult result = smallResult();
  result.times = {1, 2, 3, 4, 5, 6, 21.5};
  result.rectification.offset_px = 0.5;
  result.rectification.slope_x = 0.25;
  result.rectification.slope_y = 0.125;
  result.rectification.twist = 0.03125;
  result.rectification.curvature_x = 0.375;
  result.rectification.curvature_y = 0.625;
  result.rectification.offset_sigma_px = 0.0625;
  result.rectification.residual_px = 0.75;
  result.rectification.matches = 321;
  const cbmv_stereo::Status status =
      toStatus(result, {{10, 20, 30, 40}, "a.forest", 3, 12.5}, someHeader());
  EXPECT_EQ(status.header, someHeader());
  EXPECT_EQ(status.rectification_ms, 1);
  EXPECT_EQ(status.volume_ms, 2);
  EXPECT_EQ(status.aggregation_ms, 3);
  EXPECT_EQ(status.sgm_ms, 4);
  EXPECT_EQ(status.refinement_ms, 5);
  EXPECT_EQ(status.selection_ms, 6);
  EXPECT_EQ(status.total_ms, 21.5);
  EXPECT_EQ(status.age_ms, 12.5);
  EXPECT_EQ(status.frames_processed, 10U);
  EXPECT_EQ(status.dropped_busy, 20U);
  EXPECT_EQ(status.dropped_bad_input, 30U);
  EXPECT_EQ(status.dropped_failed, 40U);
  EXPECT_EQ(status.frames_dropped, 90U);
  EXPECT_EQ(status.vertical_offset_px, 0.5);
  EXPECT_EQ(status.vertical_offset_slope_x, 0.25);
  EXPECT_EQ(status.vertical_offset_slope_y, 0.125);
  EXPECT_EQ(status.vertical_offset_twist, 0.03125);
  EXPECT_EQ(status.vertical_offset_curvature_x, 0.375);
  EXPECT_EQ(status.vertical_offset_curvature_y, 0.625);
  EXPECT_EQ(status.vertical_offset_sigma_px, 0.0625);
  EXPECT_EQ(status.vertical_offset_residual_px, 0.75);
  EXPECT_EQ(status.vertical_offset_matches, 321);
  EXPECT_EQ(status.forest, "a.forest");
  EXPECT_EQ(status.threads, 3);
}

TEST(RectificationMessage, HasEveryField) {
  StereoResult result = smallResult();
  result.rectification.offset_px = 0.5;
  RectificationState state;
  state.age_s = 1.5;
  state.measurement.rms_before_px = 0.625;
  state.measurement.rms_after_px = 0.125;
  VerticalOffset& model = state.measurement.model;
  model.matches = 321;
  model.offset_px = 0.75;
  model.slope_x = 0.25;
  model.slope_y = 0.5;
  model.twist = 0.0625;
  model.curvature_x = 0.375;
  model.curvature_y = 0.625;
  model.offset_sigma_px = 0.03;
  model.slope_x_sigma = 0.04;
  model.slope_y_sigma = 0.05;
  model.twist_sigma = 0.06;
  model.curvature_x_sigma = 0.07;
  model.curvature_y_sigma = 0.08;
  const cbmv_stereo::Rectification message = toRectification(state, result, someHeader());
  EXPECT_EQ(message.header, someHeader());
  EXPECT_EQ(message.matches, 321);
  EXPECT_EQ(message.age_s, 1.5);
  EXPECT_EQ(message.offset_px, 0.75);
  EXPECT_EQ(message.slope_x, 0.25);
  EXPECT_EQ(message.slope_y, 0.5);
  EXPECT_EQ(message.twist, 0.0625);
  EXPECT_EQ(message.curvature_x, 0.375);
  EXPECT_EQ(message.curvature_y, 0.625);
  EXPECT_EQ(message.offset_sigma_px, 0.03);
  EXPECT_EQ(message.slope_x_sigma, 0.04);
  EXPECT_EQ(message.slope_y_sigma, 0.05);
  EXPECT_EQ(message.twist_sigma, 0.06);
  EXPECT_EQ(message.curvature_x_sigma, 0.07);
  EXPECT_EQ(message.curvature_y_sigma, 0.08);
  EXPECT_EQ(message.rms_px, model.rootMeanSquare(result.disparity.size()));
  EXPECT_EQ(message.rms_before_px, 0.625);
  EXPECT_EQ(message.rms_after_px, 0.125);
  EXPECT_TRUE(message.is_corrected);
}

TEST(RectificationMessage, IsZeroWhereNothingIsMeasured) {
  RectificationState state;
  state.age_s = 1.5;
  const auto message = toRectification(state, smallResult(), someHeader());
  EXPECT_EQ(message.matches, 0);
  EXPECT_EQ(message.age_s, 0);
  EXPECT_FALSE(message.is_corrected);
}

}  // namespace
}  // namespace cbmv
