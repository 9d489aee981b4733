// Run by stereo_node.test and stereo_nodelet.test: compares all outputs of the running node with
// the core called in this process.

#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>

#include <gtest/gtest.h>

#include "ros/rostest_main.h"
#include "ros/stereo_client.h"
#include "support/forest_fixture.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {
namespace {

const cv::Size kSize(125, 81);
constexpr int kFarPx = 4;
constexpr int kNearPx = 9;

/// Fast and reproducible: the vertical offset is estimated from one pair only.
StereoOptions testOptions() {
  StereoOptions options;
  options.range = {0, 16};
  options.rectification.enabled = false;
  return options;
}

/// Result of the core, with the vertical offset that the node reports.
StereoResult expectedResult(const StereoPair& pair, const StereoOptions& options,
                            const VerticalOffset& offset = {}) {
  StereoMatcher matcher(std::make_shared<const Forest>(makeForestFixture()), options);
  return matcher.match(pair.left, pair.right, offset);
}

/// The image of a message as a matrix.
cv::Mat asMat(const sensor_msgs::Image& message, int type) {
  return cv::Mat(static_cast<int>(message.height), static_cast<int>(message.width), type,
                 const_cast<std::uint8_t*>(message.data.data()), message.step);
}

void expectImageFields(const sensor_msgs::Image& message, const PairMessages& sent,
                       const std::string& encoding, std::uint32_t bytes_per_pixel) {
  EXPECT_EQ(message.header.stamp, sent.left_image->header.stamp);
  EXPECT_EQ(message.header.frame_id, sent.left_image->header.frame_id);
  EXPECT_EQ(message.encoding, encoding);
  EXPECT_EQ(message.width, sent.left_image->width);
  EXPECT_EQ(message.height, sent.left_image->height);
  EXPECT_EQ(message.step, bytes_per_pixel * message.width);
  EXPECT_EQ(message.is_bigendian, 0);
  ASSERT_EQ(message.data.size(), static_cast<std::size_t>(message.step) * message.height);
}

void expectDisparity(const stereo_msgs::DisparityImage& message, const PairMessages& sent,
                     const StereoResult& expected, const Rig& rig) {
  const double offset = rig.cx_left_px - rig.cx_right_px;
  const DisparityRange& range = expected.range;
  EXPECT_EQ(message.header.stamp, sent.left_image->header.stamp);
  EXPECT_EQ(message.header.frame_id, sent.left_image->header.frame_id);
  expectImageFields(message.image, sent, "32FC1", 4);
  EXPECT_EQ(message.f, static_cast<float>(rig.focal_length_px));
  EXPECT_EQ(message.T, static_cast<float>(rig.baseline_m));
  EXPECT_EQ(message.min_disparity, static_cast<float>(range.min - offset));
  EXPECT_EQ(message.max_disparity, static_cast<float>(range.max() - offset));
  EXPECT_GT(message.delta_d, 0.0F);
  EXPECT_LT(message.delta_d, 1.0F / 16);
  EXPECT_LE(message.valid_window.x_offset, static_cast<unsigned>(std::max(0, range.min)));
  EXPECT_GE(message.valid_window.x_offset + message.valid_window.width,
            static_cast<unsigned>(kSize.width + std::min(0, range.max())));
  EXPECT_LE(message.valid_window.x_offset + message.valid_window.width,
            static_cast<unsigned>(kSize.width));
  EXPECT_EQ(message.valid_window.y_offset, 0U);
  EXPECT_EQ(message.valid_window.height, static_cast<unsigned>(kSize.height));
  EXPECT_FALSE(message.valid_window.do_rectify);

  const cv::Mat published = asMat(message.image, CV_32FC1);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const float d = expected.disparity.at<float>(y, x);
      const float wanted =
          d == range.invalid() ? message.min_disparity - 1 : static_cast<float>(d - offset);
      ASSERT_EQ(published.at<float>(y, x), wanted) << "at " << x << ", " << y;
      const bool inside =
          x >= static_cast<int>(message.valid_window.x_offset) &&
          x < static_cast<int>(message.valid_window.x_offset + message.valid_window.width);
      ASSERT_TRUE(inside || d == range.invalid()) << "at " << x << ", " << y;
    }
  }
}

void expectCloud(const sensor_msgs::PointCloud2& cloud, const PairMessages& sent,
                 const StereoResult& expected, const Rig& rig, const cv::Mat& bgr) {
  EXPECT_EQ(cloud.header.stamp, sent.left_image->header.stamp);
  EXPECT_EQ(cloud.header.frame_id, sent.left_image->header.frame_id);
  EXPECT_EQ(cloud.width, static_cast<unsigned>(kSize.width));
  EXPECT_EQ(cloud.height, static_cast<unsigned>(kSize.height));
  EXPECT_EQ(cloud.point_step, 32U);
  EXPECT_EQ(cloud.row_step, 32U * kSize.width);
  EXPECT_FALSE(cloud.is_bigendian);
  EXPECT_FALSE(cloud.is_dense);
  ASSERT_EQ(cloud.data.size(), static_cast<std::size_t>(32 * kSize.area()));
  ASSERT_EQ(cloud.fields.size(), 4U);
  std::string layout;
  for (const auto& field : cloud.fields) {
    layout += field.name + "@" + std::to_string(field.offset) + " ";
    EXPECT_EQ(field.datatype, sensor_msgs::PointField::FLOAT32);
    EXPECT_EQ(field.count, 1U);
  }
  EXPECT_EQ(layout, "x@0 y@4 z@8 rgb@16 ");

  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const std::uint8_t* bytes = &cloud.data[y * cloud.row_step + x * 32];
      std::array<float, 3> point;
      std::memcpy(point.data(), bytes, sizeof(point));
      const float found = expected.disparity.at<float>(y, x);
      const double d = found - (rig.cx_left_px - rig.cx_right_px);
      if (found == expected.range.invalid() || d <= 0) {
        ASSERT_TRUE(std::isnan(point[0]) && std::isnan(point[1]) && std::isnan(point[2]));
      } else {
        const double z = rig.focal_length_px * rig.baseline_m / d;
        ASSERT_FLOAT_EQ(point[0],
                        static_cast<float>((x - rig.cx_left_px) * z / rig.focal_length_px));
        ASSERT_FLOAT_EQ(point[1], static_cast<float>((y - rig.cy_px) * z / rig.focal_length_px));
        ASSERT_FLOAT_EQ(point[2], static_cast<float>(z));
      }
      ASSERT_EQ(cv::Vec3b(bytes[16], bytes[17], bytes[18]), bgr.at<cv::Vec3b>(y, x));
      ASSERT_EQ(bytes[19], 0);
    }
  }
}

void expectDisparityColor(const sensor_msgs::Image& message, const PairMessages& sent,
                          const StereoResult& expected) {
  expectImageFields(message, sent, "rgb8", 3);
  const cv::Mat published = asMat(message, CV_8UC3);
  cv::Mat levels(1, 256, CV_8UC1);
  std::iota(levels.begin<uchar>(), levels.end<uchar>(), 0);
  cv::Mat map;
  cv::applyColorMap(levels, map, cv::COLORMAP_TURBO);
  cv::cvtColor(map, map, cv::COLOR_BGR2RGB);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const float d = expected.disparity.at<float>(y, x);
      cv::Vec3b wanted(0, 0, 0);
      if (d != expected.range.invalid()) {
        const double share = (d - expected.range.min) / (expected.range.count - 1.0);
        wanted = map.at<cv::Vec3b>(0, cv::saturate_cast<uchar>(255 * share));
      }
      // Allows a difference of one level of rounding.
      ASSERT_LE(cv::norm(published.at<cv::Vec3b>(y, x), wanted, cv::NORM_INF), 12);
    }
  }
}

/// Compares both depth images and the mask pixel by pixel.
void expectDepth(const StereoClient& client, const PairMessages& sent, const StereoResult& expected,
                 const Rig& rig) {
  const ros::Time stamp = sent.left_image->header.stamp;
  expectImageFields(client.depth.at(stamp), sent, "32FC1", 4);
  expectImageFields(client.depth_raw.at(stamp), sent, "16UC1", 2);
  expectImageFields(client.valid_mask.at(stamp), sent, "mono8", 1);
  const cv::Mat depth = asMat(client.depth.at(stamp), CV_32FC1);
  const cv::Mat raw = asMat(client.depth_raw.at(stamp), CV_16UC1);
  const cv::Mat mask = asMat(client.valid_mask.at(stamp), CV_8UC1);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const float found = expected.disparity.at<float>(y, x);
      const double d = found - (rig.cx_left_px - rig.cx_right_px);
      const bool valid = found != expected.range.invalid();
      ASSERT_EQ(mask.at<uchar>(y, x), valid ? 255 : 0);
      if (!valid || d <= 0) {
        ASSERT_TRUE(std::isnan(depth.at<float>(y, x)));
        ASSERT_EQ(raw.at<std::uint16_t>(y, x), 0);
        continue;
      }
      const double z = rig.focal_length_px * rig.baseline_m / d;
      ASSERT_FLOAT_EQ(depth.at<float>(y, x), static_cast<float>(z));
      ASSERT_NEAR(raw.at<std::uint16_t>(y, x), z < 65.5355 ? z * 1000 : 0, 0.51);
    }
  }
}

void expectCameraInfo(const sensor_msgs::CameraInfo& info, const PairMessages& sent,
                      const Rig& rig) {
  EXPECT_EQ(info.header.stamp, sent.left_image->header.stamp);
  EXPECT_EQ(info.header.frame_id, sent.left_image->header.frame_id);
  EXPECT_EQ(info.width, static_cast<unsigned>(kSize.width));
  EXPECT_EQ(info.height, static_cast<unsigned>(kSize.height));
  EXPECT_EQ(info.P[0], rig.focal_length_px);
  EXPECT_EQ(info.P[2], rig.cx_left_px);
  EXPECT_EQ(info.P[3], 0);
  EXPECT_EQ(info.P[5], rig.focal_length_px);
  EXPECT_EQ(info.P[6], rig.cy_px);
}

class StereoTopics : public ::testing::Test {
 protected:
  /// One client for all tests, because connecting takes longer than the tests.
  static void SetUpTestSuite() {
    shared_client = std::make_unique<StereoClient>();
    StereoClient& client = *shared_client;
    client.setOptions(testOptions());  // wait until the node is up
    client.subscribeAll();
    ASSERT_TRUE(waitFor([&] {
      return client.cameras.pairIsWanted() && client.cameras.colorIsWanted() &&
             client.allConnected();
    }));
  }
  static void TearDownTestSuite() { shared_client.reset(); }

  void SetUp() override { options_ = client_.setOptions(testOptions()); }

  PairMessages makeGoodMessages() { return makeMessages(pair_, rig_, ros::Time::now()); }

  bool waitForOutputs(ros::Time stamp) {
    return waitFor([&] { return client_.allHave(stamp); });
  }

  /// Sends the pair and compares every field of every output.
  void expectOutputsOf(const StereoResult& expected) {
    const PairMessages sent = makeGoodMessages();
    client_.cameras.publish(sent);
    ASSERT_TRUE(waitForOutputs(sent.left_image->header.stamp));
    cv::Mat gray;
    cv::cvtColor(pair_.left, gray, cv::COLOR_GRAY2BGR);
    expectAll(sent, expected, gray);
  }

  void expectAll(const PairMessages& sent, const StereoResult& expected, const cv::Mat& color) {
    const ros::Time stamp = sent.left_image->header.stamp;
    expectDisparity(client_.disparity.at(stamp), sent, expected, rig_);
    expectCloud(client_.points.at(stamp), sent, expected, rig_, color);
    expectDepth(client_, sent, expected, rig_);
    expectCameraInfo(client_.camera_info.at(stamp), sent, rig_);
    const sensor_msgs::Image& confidence = client_.confidence.at(stamp);
    expectImageFields(confidence, sent, "32FC1", 4);
    EXPECT_EQ(cv::norm(asMat(confidence, CV_32FC1), expected.confidence, cv::NORM_INF), 0);
    expectDisparityColor(client_.disparity_color.at(stamp), sent, expected);
  }

  /// Checks that the pair after a bad one is processed correctly.
  void expectAlive() { expectOutputsOf(expectedResult(pair_, options_)); }

  std::uint64_t badInputsSoFar() {
    const PairMessages sent = makeGoodMessages();
    client_.cameras.publish(sent);
    EXPECT_TRUE(waitForOutputs(sent.left_image->header.stamp));
    return client_.status.at(sent.left_image->header.stamp).dropped_bad_input;
  }

  /// Sends the pair changed by `spoil`. Expects that it is dropped with a warning that contains
  /// `words`, and counted.
  void expectDropped(const std::function<void(PairMessages&)>& spoil,
                     const std::vector<std::string>& words) {
    const std::uint64_t before = badInputsSoFar();
    PairMessages messages = makeGoodMessages();
    spoil(messages);
    client_.cameras.publish(messages);
    EXPECT_TRUE(client_.log.waitForWarning(words)) << "no warning with '" << words.front() << "'";
    expectAlive();
    EXPECT_EQ(badInputsSoFar(), before + 1);
    EXPECT_FALSE(client_.disparity.has(messages.left_image->header.stamp));
  }

  static inline std::unique_ptr<StereoClient> shared_client;
  StereoClient& client_ = *shared_client;
  StereoPair pair_ = renderPair(kSize, kFarPx, kNearPx);
  Rig rig_;
  StereoOptions options_;
};

TEST_F(StereoTopics, EveryFieldOfEveryOutputIsTheCores) {
  const StereoResult expected = expectedResult(pair_, options_);
  int right = 0;  // ensures that the compared results are meaningful
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      right += std::abs(expected.disparity.at<float>(y, x) - pair_.disparity.at<int>(y, x)) < 1;
    }
  }
  EXPECT_GT(right, 0.85 * kSize.area());
  expectOutputsOf(expected);
}

TEST_F(StereoTopics, InvalidPixelsAreMarked) {
  StereoOptions options = testOptions();
  options.refinement.fill_occlusions = false;
  options.refinement.fill_mismatches = false;
  options_ = client_.setOptions(options);
  const StereoResult expected = expectedResult(pair_, options_);
  EXPECT_GT(cv::countNonZero(expected.disparity == expected.range.invalid()), 0);
  expectOutputsOf(expected);
}

TEST_F(StereoTopics, NegativeDisparities) {
  pair_ = renderPair(kSize, -5, 3);
  StereoOptions options = testOptions();
  options.range = {-8, 16};
  options_ = client_.setOptions(options);
  expectOutputsOf(expectedResult(pair_, options_));
}

TEST_F(StereoTopics, VergedRig) {
  rig_.cx_right_px = 68;  // matched disparities are 5.5 px less than those of parallel cameras
  expectOutputsOf(expectedResult(pair_, options_));
  const PairMessages sent = makeGoodMessages();
  client_.cameras.publish(sent);
  ASSERT_TRUE(waitForOutputs(sent.left_image->header.stamp));
  const auto& cloud = client_.points.at(sent.left_image->header.stamp);
  float z = 0;
  std::memcpy(&z, &cloud.data[40 * cloud.row_step + 62 * 32 + 8], sizeof(z));
  EXPECT_NEAR(z, 120 * 0.25 / (kNearPx + 5.5), 0.1);
}

TEST_F(StereoTopics, RectificationIsRefined) {
  cv::Mat shifted;
  const cv::Mat one_row_down = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, 1);
  cv::warpAffine(pair_.right, shifted, one_row_down, kSize, cv::INTER_NEAREST,
                 cv::BORDER_REPLICATE);
  pair_.right = shifted;
  StereoOptions options = testOptions();
  options.rectification.enabled = true;
  options_ = client_.setOptions(options);

  // Estimates run in parallel to the stream; the model takes effect a few frames after the first.
  PairMessages sent;
  ros::Time stamp;
  ASSERT_TRUE(waitFor([&] {
    sent = makeGoodMessages();
    stamp = sent.left_image->header.stamp;
    client_.cameras.publish(sent);
    return waitForOutputs(stamp) && client_.status.at(stamp).vertical_offset_matches > 0;
  }));
  const cbmv_stereo::Status& status = client_.status.at(stamp);
  EXPECT_NEAR(status.vertical_offset_px, 1, 0.1);
  EXPECT_GT(status.vertical_offset_sigma_px, 0);
  EXPECT_GT(status.vertical_offset_residual_px, 0);
  const cbmv_stereo::Rectification& watched = client_.rectification.at(stamp);
  EXPECT_GT(watched.matches, 0);
  EXPECT_NEAR(watched.offset_px, 1, 3 * watched.offset_sigma_px);
  EXPECT_NEAR(watched.slope_x, 0, 3 * watched.slope_x_sigma);
  EXPECT_NEAR(watched.slope_y, 0, 3 * watched.slope_y_sigma);
  EXPECT_NEAR(watched.twist, 0, 3 * watched.twist_sigma);
  EXPECT_NEAR(watched.rms_before_px, 1, 0.1);
  EXPECT_LT(watched.rms_after_px, 0.2);
  EXPECT_TRUE(watched.is_corrected);

  VerticalOffset offset;
  offset.offset_px = status.vertical_offset_px;
  offset.slope_x = status.vertical_offset_slope_x;
  offset.slope_y = status.vertical_offset_slope_y;
  offset.twist = status.vertical_offset_twist;
  offset.curvature_x = status.vertical_offset_curvature_x;
  offset.curvature_y = status.vertical_offset_curvature_y;
  cv::Mat gray;
  cv::cvtColor(pair_.left, gray, cv::COLOR_GRAY2BGR);
  expectAll(sent, expectedResult(pair_, options_, offset), gray);
}

TEST_F(StereoTopics, CloudTakesColorOfEachEncoding) {
  const StereoResult expected = expectedResult(pair_, options_);
  cv::Mat bgr(kSize, CV_8UC3);
  cv::randu(bgr, 0, 256);
  for (const auto& [encoding, code] :
       {std::pair("bgr8", -1), std::pair("rgb8", +cv::COLOR_BGR2RGB),
        std::pair("bgra8", +cv::COLOR_BGR2BGRA), std::pair("rgba8", +cv::COLOR_BGR2RGBA)}) {
    SCOPED_TRACE(encoding);
    cv::Mat color = bgr.clone();
    if (code >= 0) {
      cv::cvtColor(bgr, color, code);
    }
    const PairMessages sent = makeGoodMessages();
    client_.cameras.publishColor(makeImage(color, encoding, sent.left_image->header));
    wait(0.2);  // color is used only if it has arrived
    client_.cameras.publish(sent);
    ASSERT_TRUE(waitForOutputs(sent.left_image->header.stamp));
    expectAll(sent, expected, bgr);
  }
}

TEST_F(StereoTopics, CloudStaysGrayWithUnusableColor) {
  const PairMessages sent = makeGoodMessages();
  client_.cameras.publishColor(makeImage(cv::Mat(9, 9, CV_8UC3), "bgr8", sent.left_image->header));
  wait(0.2);
  client_.cameras.publish(sent);
  ASSERT_TRUE(waitForOutputs(sent.left_image->header.stamp));
  cv::Mat gray;
  cv::cvtColor(pair_.left, gray, cv::COLOR_GRAY2BGR);
  expectAll(sent, expectedResult(pair_, options_), gray);
  EXPECT_TRUE(client_.log.waitForWarning({"/stereo/left/image_rect_color", "9 x 9"}));
}

TEST_F(StereoTopics, StatusDescribesTheFrame) {
  const PairMessages first = makeGoodMessages();
  client_.cameras.publish(first);
  ASSERT_TRUE(waitForOutputs(first.left_image->header.stamp));
  const PairMessages second = makeGoodMessages();
  client_.cameras.publish(second);
  ASSERT_TRUE(waitForOutputs(second.left_image->header.stamp));
  const cbmv_stereo::Status& before = client_.status.at(first.left_image->header.stamp);
  const cbmv_stereo::Status& status = client_.status.at(second.left_image->header.stamp);
  EXPECT_EQ(status.header.frame_id, "left_camera");
  EXPECT_EQ(status.frames_processed, before.frames_processed + 1);
  EXPECT_EQ(status.frames_dropped,
            status.dropped_busy + status.dropped_bad_input + status.dropped_failed);
  EXPECT_EQ(status.frames_dropped, before.frames_dropped);
  EXPECT_EQ(status.dropped_failed, 0U);
  for (const double stage :
       {status.volume_ms, status.aggregation_ms, status.sgm_ms, status.refinement_ms}) {
    EXPECT_GT(stage, 0);
    EXPECT_LE(stage, status.total_ms);
  }
  EXPECT_GE(status.rectification_ms, 0);
  EXPECT_GT(status.age_ms, status.total_ms);
  EXPECT_LT(status.age_ms, 10000);
  EXPECT_EQ(status.vertical_offset_px, 0);
  EXPECT_EQ(status.vertical_offset_slope_x, 0);
  EXPECT_EQ(status.vertical_offset_slope_y, 0);
  EXPECT_EQ(status.vertical_offset_sigma_px, 0);
  EXPECT_EQ(status.vertical_offset_residual_px, 0);
  EXPECT_EQ(status.vertical_offset_matches, 0);
  EXPECT_EQ(status.forest, "fixture.forest");
  EXPECT_GE(status.threads, 1);
}

TEST_F(StereoTopics, NewestFrameWins) {
  const cbmv_stereo::Status before = [&] {
    const PairMessages sent = makeGoodMessages();
    client_.cameras.publish(sent);
    EXPECT_TRUE(waitForOutputs(sent.left_image->header.stamp));
    return client_.status.at(sent.left_image->header.stamp);
  }();
  StereoOptions slow = testOptions();
  slow.range.count = 120;
  slow.aggregation.iterations_before = 8;
  client_.setOptions(slow);
  constexpr int kFrames = 15;
  ros::Time last;
  for (int i = 0; i < kFrames; ++i) {
    wait(0.01);  // otherwise messages would queue up before the node
    last = ros::Time::now();
    client_.cameras.publish(makeMessages(pair_, rig_, last));
  }
  ASSERT_TRUE(waitForOutputs(last)) << "the newest frame was dropped";
  const cbmv_stereo::Status& status = client_.status.at(last);
  EXPECT_EQ(
      status.frames_processed - before.frames_processed + status.dropped_busy - before.dropped_busy,
      static_cast<std::uint64_t>(kFrames));
  EXPECT_GT(status.dropped_busy, before.dropped_busy);
}

TEST_F(StereoTopics, DropsBadInputWithAWarningAndLives) {
  const std::string left = "/stereo/left/image_rect";
  const std::string right = "/stereo/right/image_rect";
  expectDropped(
      [](PairMessages& m) {
        m.right_image =
            makeImage(cv::Mat(60, 125, CV_8UC1, cv::Scalar(7)), "mono8", m.right_image->header);
      },
      {left, right, "125 x 81", "125 x 60"});
  expectDropped([](PairMessages& m) { m.left_image->width = m.right_image->width = 0; },
                {left, "empty"});
  expectDropped([](PairMessages& m) { m.right_image->data.resize(10); },
                {right, "10 bytes", "10125"});
  expectDropped([](PairMessages& m) { m.left_image->encoding = m.right_image->encoding = "odd"; },
                {left, "'odd'"});
  expectDropped([](PairMessages& m) { m.right_info->P.assign(0); },
                {"/stereo/right/camera_info", "P[0]"});
  expectDropped([](PairMessages& m) { m.left_info->width = 640; },
                {"/stereo/left/camera_info", "640 x 81"});
}

TEST_F(StereoTopics, ImagesMayDifferInEncoding) {
  const PairMessages sent = makeGoodMessages();
  cv::Mat color;
  cv::cvtColor(pair_.right, color, cv::COLOR_GRAY2BGR);
  sent.right_image->encoding = "bgr8";
  sent.right_image->step *= 3;
  sent.right_image->data.assign(color.data, color.data + color.total() * color.elemSize());
  client_.cameras.publish(sent);
  ASSERT_TRUE(waitForOutputs(sent.left_image->header.stamp));
  cv::Mat gray;
  cv::cvtColor(pair_.left, gray, cv::COLOR_GRAY2BGR);
  expectAll(sent, expectedResult(pair_, options_), gray);
}

TEST_F(StereoTopics, RangeNeedNotBeAMultipleOfSixteen) {
  StereoOptions options = testOptions();
  options.range = {1, 13};
  options_ = client_.setOptions(options);
  EXPECT_EQ(options_.range.count, 13);
  expectOutputsOf(expectedResult(pair_, options_));
}

TEST_F(StereoTopics, UncertainPixelsAreInvalid) {
  constexpr float kMinConfidence = 0.6F;
  options_ = client_.setOptions(testOptions(), kMinConfidence);
  StereoResult expected = expectedResult(pair_, options_);
  const cv::Mat uncertain = expected.confidence < kMinConfidence;
  EXPECT_GT(cv::countNonZero(uncertain), 0);
  EXPECT_GT(cv::countNonZero(~uncertain), 0);
  expected.disparity.setTo(expected.range.invalid(), uncertain);
  expectOutputsOf(expected);
}

/// Regions of the sensors differ and are read out with binning: cx of the images differ more than
/// those of the cameras.
TEST_F(StereoTopics, RegionsOfInterestMayDiffer) {
  PairMessages sent = makeGoodMessages();
  for (const auto& info : {sent.left_info, sent.right_info}) {
    info->width = 400;
    info->height = 300;
    info->binning_x = info->binning_y = 2;
    info->roi.width = 2 * 125;
    info->roi.height = 2 * 81;
    info->roi.y_offset = 10;
    info->P[0] = info->P[5] = 2 * rig_.focal_length_px;
    info->P[2] = 200;
    info->P[6] = 91;
  }
  sent.right_info->P[3] = -2 * rig_.focal_length_px * rig_.baseline_m;
  sent.left_info->roi.x_offset = 74;
  sent.right_info->roi.x_offset = 80;
  rig_.cx_left_px = (200 - 74) / 2.0;
  rig_.cx_right_px = (200 - 80) / 2.0;
  rig_.cy_px = (91 - 10) / 2.0;
  client_.cameras.publish(sent);
  ASSERT_TRUE(waitForOutputs(sent.left_image->header.stamp));
  cv::Mat gray;
  cv::cvtColor(pair_.left, gray, cv::COLOR_GRAY2BGR);
  expectAll(sent, expectedResult(pair_, options_), gray);
}

TEST_F(StereoTopics, RangeWiderThanTheImageIsClipped) {
  StereoOptions options = testOptions();
  options.range.count = 200;
  client_.setOptions(options);
  options.range.count = kSize.width;
  expectOutputsOf(expectedResult(pair_, options));
  EXPECT_TRUE(client_.log.waitForWarning({"disparity_range is 200", "125 px"}));

  options.range = {200, 16};
  client_.setOptions(options);
  client_.cameras.publish(makeGoodMessages());
  EXPECT_TRUE(client_.log.waitForWarning({"200 ... 215 px", "125 px"}));
  options_ = client_.setOptions(testOptions());
  expectAlive();
}

/// The first pair of a size is measured; the published range is the searched range.
TEST_F(StereoTopics, AnAutomaticRangeIsFound) {
  StereoOptions options = testOptions();
  options.range.count = 0;
  options_ = client_.setOptions(options);
  EXPECT_TRUE(options_.range.isAutomatic());
  const StereoResult expected = expectedResult(pair_, options_);
  EXPECT_GT(expected.range.max(), kNearPx);
  EXPECT_LT(expected.range.max(), 4 * kNearPx);
  expectOutputsOf(expected);
}

TEST_F(StereoTopics, FramesThatNeedTooMuchMemoryAreDropped) {
  StereoOptions options = testOptions();
  options.max_memory_mb = 1;
  client_.setOptions(options);
  client_.cameras.publish(makeGoodMessages());
  EXPECT_TRUE(client_.log.waitForWarning(
      {"/stereo/left/image_rect", "125x81 pixels", "max_memory_mb allows 1", "frame dropped"}));
  options_ = client_.setOptions(testOptions());
  expectAlive();
}

TEST_F(StereoTopics, ParametersAreCorrectedAndTheCorrectionIsReported) {
  StereoOptions options = testOptions();
  options.sgm.p1 = 5;
  options.sgm.p2 = 2;
  options.refinement.median_size_px = 4;
  options_ = client_.setOptions(options);
  EXPECT_EQ(describeOptions(options_), [&] {
    correctOptions(options);
    return describeOptions(options);
  }());
  EXPECT_LE(options_.sgm.p1, options_.sgm.p2);
  EXPECT_TRUE(client_.log.waitForWarning({"P1", "P2"}));
  EXPECT_TRUE(client_.log.waitForWarning({"median_size"}));
  expectAlive();
}

TEST(LazySubscription, InputsAreSubscribedOnlyWhileAnOutputIs) {
  StereoClient client;
  client.setOptions(testOptions());  // wait until the node is up
  EXPECT_FALSE(waitFor([&] { return client.cameras.anyIsWanted(); }, 0.3));
  ros::NodeHandle nh;
  client.withEach([&](auto& output, const std::string& topic) {
    SCOPED_TRACE(topic);
    output.subscribe(nh, topic);
    EXPECT_TRUE(waitFor([&] { return client.cameras.pairIsWanted(); }));
    const bool colored = topic == "points2";
    EXPECT_EQ(waitFor([&] { return client.cameras.colorIsWanted(); }, colored ? 10 : 0.1), colored);
    output.unsubscribe();
    EXPECT_TRUE(waitFor([&] { return !client.cameras.anyIsWanted(); }));
  });
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
