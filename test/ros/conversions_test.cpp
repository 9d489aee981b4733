#include "ros/conversions.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "ros/stereo_pair.h"

namespace cbmv {
namespace {

const StereoTopics kTopics = {"/s/left/image_rect", "/s/left/camera_info", "/s/right/image_rect",
                              "/s/right/camera_info"};
const cv::Size kSize(37, 23);

PairMessages goodMessages(const Rig& rig = {}) {
  return makeMessages(renderPair(kSize, 3, 6), rig, ros::Time(12, 34));
}

/// Expects InputError with that fault and a sentence that holds `words`.
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

void expectBadPair(const PairMessages& messages, InputFault fault,
                   const std::vector<std::string>& words) {
  expectInputError([&] { toGreyPair(messages.asConst(), kTopics, false); }, fault, words);
}

void expectBadInfo(const PairMessages& messages, InputFault fault,
                   const std::vector<std::string>& words) {
  expectInputError([&] { toGeometry(messages.asConst(), kTopics); }, fault, words);
}

TEST(GreyPair, KeepsMono8) {
  const StereoPair pair = renderPair(kSize, 3, 6);
  const PairMessages messages = goodMessages();
  const GreyPair grey = toGreyPair(messages.asConst(), kTopics, false);
  EXPECT_EQ(cv::norm(grey.left, pair.left, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(grey.right, pair.right, cv::NORM_INF), 0);
}

TEST(GreyPair, ReadsRowsWithPadding) {
  PairMessages messages = goodMessages();
  const StereoPair pair = renderPair(kSize, 3, 6);
  cv::Mat padded;
  cv::copyMakeBorder(pair.left, padded, 0, 0, 0, 5, cv::BORDER_CONSTANT, 99);
  messages.left_image = makeImage(padded, "mono8", messages.left_image->header);
  messages.left_image->width = kSize.width;
  const GreyPair grey = toGreyPair(messages.asConst(), kTopics, false);
  EXPECT_EQ(cv::norm(grey.left, pair.left, cv::NORM_INF), 0);
}

TEST(GreyPair, ConvertsColourAndSixteenBits) {
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
    const GreyPair grey = toGreyPair(messages.asConst(), kTopics, false);
    EXPECT_EQ(cv::norm(grey.left, pair.left, cv::NORM_INF), 0) << encoding;
    EXPECT_EQ(cv::norm(grey.right, pair.right, cv::NORM_INF), 0) << encoding;
  }
  PairMessages messages = goodMessages();
  cv::Mat deep;
  pair.left.convertTo(deep, CV_16U, 257);
  messages.left_image = makeImage(deep, "mono16", messages.left_image->header);
  pair.right.convertTo(deep, CV_16U, 257);
  messages.right_image = makeImage(deep, "mono16", messages.right_image->header);
  EXPECT_EQ(cv::norm(toGreyPair(messages.asConst(), kTopics, false).left, pair.left, cv::NORM_INF),
            0);
}

TEST(GreyPair, RefusesWhatDiffers) {
  PairMessages messages = goodMessages();
  messages.right_image =
      makeImage(cv::Mat(20, 37, CV_8UC1, cv::Scalar(7)), "mono8", messages.right_image->header);
  expectBadPair(messages, InputFault::kDifferentSizes,
                {kTopics.left_image, kTopics.right_image, "37 x 23", "37 x 20"});

  messages = goodMessages();
  messages.right_image->encoding = "8UC1";
  expectBadPair(messages, InputFault::kDifferentEncodings,
                {kTopics.left_image, kTopics.right_image, "mono8", "8UC1"});

  messages = goodMessages();
  messages.right_image->header.frame_id = "right_camera";
  expectBadPair(
      messages, InputFault::kDifferentFrameIds,
      {kTopics.left_image, kTopics.right_image, "'left_camera'", "'right_camera'", "allow_"});
  EXPECT_NO_THROW(toGreyPair(messages.asConst(), kTopics, true));
}

TEST(GreyPair, RefusesMalformedImages) {
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
  expectBadPair(messages, InputFault::kUnsupportedEncoding, {kTopics.left_image, "'32FC1'"});
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
  const cv::Mat grey(kSize, CV_8UC1, cv::Scalar(42));
  EXPECT_EQ(toColor(*makeImage(grey, "mono8", {}), "/color", kSize).at<cv::Vec3b>(3, 4),
            cv::Vec3b(42, 42, 42));
}

TEST(Color, RefusesOtherSizesAndEncodings) {
  const auto message = makeImage(cv::Mat(kSize, CV_8UC3), "bgr8", {});
  expectInputError(
      [&] {
        toColor(*message, "/color", {38, 23});
      },
      InputFault::kDifferentSizes, {"/color", "37 x 23", "38 x 23"});
  message->encoding = "yuv422";
  expectInputError([&] { toColor(*message, "/color", kSize); }, InputFault::kUnsupportedEncoding,
                   {"/color", "yuv422"});
}

TEST(Geometry, ReadsProjectionMatrices) {
  const Rig rig{120, 0.25, 62.5, 52.5, 40.25};
  const StereoGeometry geometry = toGeometry(goodMessages(rig).asConst(), kTopics);
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
  const StereoGeometry geometry = toGeometry(messages.asConst(), kTopics);
  EXPECT_DOUBLE_EQ(geometry.focal_length_px, 60);
  EXPECT_DOUBLE_EQ(geometry.baseline_m, 0.25);
  EXPECT_DOUBLE_EQ(geometry.left_cx_px, (62.5 - 12) / 2);
  EXPECT_DOUBLE_EQ(geometry.left_cy_px, (40.25 - 20) / 2);
  EXPECT_DOUBLE_EQ(geometry.disparity_offset_px, (8 - 12) / 2.0);
}

TEST(Geometry, RefusesUnusableCameras) {
  PairMessages messages = goodMessages();
  messages.right_info->P.assign(0);
  expectBadInfo(messages, InputFault::kUncalibrated, {kTopics.right_info, "P[0]"});

  messages = goodMessages();
  messages.left_info->P[2] = std::numeric_limits<double>::quiet_NaN();
  expectBadInfo(messages, InputFault::kUncalibrated, {kTopics.left_info});

  for (const double tx : {0.0, 30.0}) {
    messages = goodMessages();
    messages.right_info->P[3] = tx;
    expectBadInfo(messages, InputFault::kUncalibrated, {kTopics.right_info, "P[3]", "swapped"});
  }
  messages = goodMessages();
  messages.left_info->width = 640;
  messages.left_info->height = 480;
  expectBadInfo(messages, InputFault::kCameraInfoSize, {kTopics.left_info, "640 x 480", "37 x 23"});
}

/// A result with one pixel of each kind: found, invalid, and beyond infinity in a verged rig.
StereoResult smallResult() {
  StereoResult result;
  result.range = {-2, 8};
  result.disparity = (cv::Mat_<float>(2, 3) << -3, -2, 0.25F, 5, 3.5F, -3);
  result.confidence = (cv::Mat_<float>(2, 3) << 0, 0.125F, 0.25F, 0.5F, 0.75F, 1);
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

TEST(DisparityStep, IsWholePixelsOnlyWithoutSubpixelStages) {
  RefinementOptions options;
  options.subpixel = false;
  options.bilateral_sigma_px = 0;
  EXPECT_EQ(disparityStep({0, 64}, options), 1);
  options.bilateral_sigma_px = 2;
  EXPECT_EQ(disparityStep({0, 64}, options), std::ldexp(1.0, -18));  // floats from 32 to 64
  options = RefinementOptions();
  EXPECT_EQ(disparityStep({-100, 64}, options), std::ldexp(1.0, -17));
}

TEST(PointCloud, HasEveryField) {
  const StereoGeometry geometry = smallGeometry();
  cv::Mat color(2, 3, CV_8UC3);
  cv::randu(color, 0, 256);
  const sensor_msgs::PointCloud2 cloud = toPointCloud(smallResult(), geometry, color, someHeader());
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
  const auto cloud =
      toPointCloud(result, {120, 0.25, 0, 100, 90, 1, 1}, cv::Mat(1, 2, CV_8UC3), {});
  float z = 0;
  std::memcpy(&z, &cloud.data[8], sizeof(z));
  EXPECT_TRUE(std::isnan(z));
  std::memcpy(&z, &cloud.data[40], sizeof(z));
  EXPECT_FLOAT_EQ(z, 6);
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
  EXPECT_EQ(message.encoding, "bgr8");
  EXPECT_EQ(message.width, 3U);
  EXPECT_EQ(message.height, 2U);
  EXPECT_EQ(message.step, 9U);
  ASSERT_EQ(message.data.size(), 18U);
  const auto pixel = [&](int i) {
    return cv::Vec3b(message.data[3 * i], message.data[3 * i + 1], message.data[3 * i + 2]);
  };
  EXPECT_EQ(pixel(0), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(pixel(5), cv::Vec3b(0, 0, 0));
  EXPECT_GE(pixel(1)[0], pixel(1)[2]);  // the smallest disparity: more blue than red
  EXPECT_GT(pixel(3)[2], pixel(3)[0]);  // the largest: more red than blue
}

TEST(StatusMessage, HasEveryField) {
  StereoResult result = smallResult();
  result.times = {1, 2, 3, 4, 5, 15.5};
  result.rectification.offset_px = 0.5;
  result.rectification.slope_x = 0.25;
  result.rectification.slope_y = 0.125;
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
  EXPECT_EQ(status.total_ms, 15.5);
  EXPECT_EQ(status.age_ms, 12.5);
  EXPECT_EQ(status.frames_processed, 10U);
  EXPECT_EQ(status.dropped_busy, 20U);
  EXPECT_EQ(status.dropped_bad_input, 30U);
  EXPECT_EQ(status.dropped_failed, 40U);
  EXPECT_EQ(status.frames_dropped, 90U);
  EXPECT_EQ(status.vertical_offset_px, 0.5);
  EXPECT_EQ(status.vertical_offset_slope_x, 0.25);
  EXPECT_EQ(status.vertical_offset_slope_y, 0.125);
  EXPECT_EQ(status.vertical_offset_sigma_px, 0.0625);
  EXPECT_EQ(status.vertical_offset_residual_px, 0.75);
  EXPECT_EQ(status.vertical_offset_matches, 321);
  EXPECT_EQ(status.forest, "a.forest");
  EXPECT_EQ(status.threads, 3);
}

}  // namespace
}  // namespace cbmv
