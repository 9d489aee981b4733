// Run by configuration.test: nodelets whose private parameters differ from those of the launch
// files.

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <utility>

#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ros/cameras.h"
#include "ros/collector.h"
#include "ros/diagnostics_reader.h"
#include "ros/local_nodelet.h"
#include "ros/log_reader.h"
#include "ros/parameter_server.h"
#include "ros/rostest_main.h"
#include "ros/wait_for.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

const cv::Size kSize(125, 81);
constexpr int kFarPx = 4;
constexpr int kNearPx = 9;

class StereoNodelet : public LocalNodelet {
 public:
  explicit StereoNodelet(const std::string& name_space)
      : LocalNodelet(name_space, "cbmv_stereo/stereo") {
    parameters().setParam("forest", CBMV_TEST_FOREST);
    parameters().setParam("disparity_range", 16);
  }
};

TEST(Startup, ForestIsRequired) {
  const std::string damaged = CBMV_TEST_FOREST ".damaged";
  std::ofstream(damaged) << "this is not a forest";
  for (const std::string& path : {std::string(), std::string("/nonexistent/a.forest"), damaged}) {
    StereoNodelet nodelet("forest_test");
    nodelet.parameters().setParam("forest", path);
    EXPECT_FALSE(nodelet.load()) << path;
  }
  StereoNodelet nodelet("forest_test");
  EXPECT_TRUE(nodelet.load());
}

TEST(Startup, LoadsTheForestOfThePackage) {
  StereoNodelet nodelet("package_forest_test");
  nodelet.parameters().setParam("forest", CBMV_SOURCE_DIR "/models/middlebury.forest");
  EXPECT_TRUE(nodelet.load());
}

TEST(Startup, NodeWithoutForestExitsWithAnError) {
  const pid_t child = fork();
  if (child == 0) {
    execl(CBMV_STEREO_NODE, "cbmv_stereo_node", "__name:=no_forest",
          "_forest:=/nonexistent/a.forest", nullptr);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1);
}

TEST(Startup, PresetYieldsToExplicitParameters) {
  const std::string preset = CBMV_TEST_FOREST ".yaml";
  std::ofstream(preset) << "P1: 3\nsgm_iterations: 1\nsubpixel: false\n";
  StereoNodelet nodelet("preset_test");
  nodelet.parameters().setParam("preset", preset);
  nodelet.parameters().setParam("sgm_iterations", 3);
  ASSERT_TRUE(nodelet.load());
  double p1 = 0;
  int iterations = 0;
  bool subpixel = true;
  EXPECT_TRUE(nodelet.parameters().getParam("P1", p1));
  EXPECT_TRUE(nodelet.parameters().getParam("sgm_iterations", iterations));
  EXPECT_TRUE(nodelet.parameters().getParam("subpixel", subpixel));
  EXPECT_EQ(p1, 3);
  EXPECT_EQ(iterations, 3);
  EXPECT_FALSE(subpixel);
}

/// The configuration after one call of set_parameters with the values in `request`.
cbmv_stereo::StereoConfig reconfigured(StereoNodelet& nodelet,
                                       const dynamic_reconfigure::Config& request) {
  dynamic_reconfigure::Reconfigure call;
  call.request.config = request;
  EXPECT_TRUE(ros::service::call(nodelet.parameters().resolveName("set_parameters"), call));
  auto config = cbmv_stereo::StereoConfig::__getDefault__();
  config.__fromMessage__(call.response.config);
  return config;
}

dynamic_reconfigure::Config presetRequest(const std::string& preset) {
  dynamic_reconfigure::Config request;
  request.strs.resize(1);
  request.strs[0].name = "preset";
  request.strs[0].value = preset;
  return request;
}

/// Text with all parameters of the method.
std::string optionsText(const cbmv_stereo::StereoConfig& config) {
  StereoOptions options;
  applyConfig(config, options);
  return describeOptions(options);
}

std::string expectedText(const std::string& preset) {
  StereoOptions options;
  options.range.count = 16;  // same as in StereoNodelet
  readPreset(CBMV_SOURCE_DIR "/config/" + preset + ".yaml", options);
  return describeOptions(options);
}

TEST(Presets, AreTakenAtRunTime) {
  StereoNodelet nodelet("live_preset_test");
  ASSERT_TRUE(nodelet.load());
  for (const char* name : {"quality", "realtime"}) {
    const auto config = reconfigured(nodelet, presetRequest(name));
    EXPECT_EQ(config.preset, name);
    EXPECT_EQ(optionsText(config), expectedText(name));
  }
  dynamic_reconfigure::Config other;
  other.doubles.resize(1);
  other.doubles[0].name = "P1";
  other.doubles[0].value = 0.75;
  const auto custom = reconfigured(nodelet, other);
  EXPECT_EQ(custom.preset, "custom");
  EXPECT_EQ(custom.P1, 0.75);
  EXPECT_EQ(custom.sgm_iterations, 1);  // still that of realtime
  EXPECT_EQ(optionsText(reconfigured(nodelet, presetRequest("realtime"))),
            expectedText("realtime"));
}

TEST(Presets, UnknownOnesChangeNothing) {
  LogReader log;
  StereoNodelet nodelet("unknown_preset_test");
  ASSERT_TRUE(nodelet.load());
  const auto before = reconfigured(nodelet, presetRequest("balanced"));
  const auto after = reconfigured(nodelet, presetRequest("no_such_preset"));
  EXPECT_EQ(after.preset, "balanced");
  EXPECT_EQ(optionsText(after), optionsText(before));
  EXPECT_TRUE(
      log.waitForWarning({"unknown preset 'no_such_preset'", "realtime", "keep their values"}));
}

TEST(Presets, AreCorrectedAndTheCorrectionIsReported) {
  LogReader log;
  const std::string preset = CBMV_TEST_FOREST ".inconsistent.yaml";
  std::ofstream(preset) << "P1: 5\nP2: 2\n";
  StereoNodelet nodelet("corrected_preset_test");
  ASSERT_TRUE(nodelet.load());
  const auto config = reconfigured(nodelet, presetRequest(preset));
  EXPECT_EQ(config.P1, 2);
  EXPECT_EQ(config.P2, 2);
  EXPECT_TRUE(log.waitForWarning({"P1 (5) was lowered to P2 (2)"}));
}

TEST(Presets, CanBeNamedAtTheStart) {
  StereoNodelet nodelet("named_preset_test");
  nodelet.parameters().setParam("preset", "kitti");
  ASSERT_TRUE(nodelet.load());
  const auto config = reconfigured(nodelet, {});
  EXPECT_EQ(config.preset, "kitti");
  EXPECT_EQ(optionsText(config), expectedText("kitti"));
}

TEST(Startup, RejectsBadPrivateParameters) {
  for (const auto& [name, value] : {std::pair("queue_size", 0), std::pair("threads", -1),
                                    std::pair("approximate_sync_max_interval_s", -1),
                                    std::pair("approximate_sync", 1),  // neither true nor false
                                    std::pair("points_max_depth_m", -1)}) {
    StereoNodelet nodelet("bad_parameter_test");
    nodelet.parameters().setParam(name, value);
    EXPECT_FALSE(nodelet.load()) << name;
  }
  StereoNodelet nodelet("bad_parameter_test");
  nodelet.parameters().setParam("points_min_depth_m", 5);
  nodelet.parameters().setParam("points_max_depth_m", 4.5);
  EXPECT_FALSE(nodelet.load());
}

TEST(Startup, RangeErrorsNameTheRange) {
  LogReader log;
  wait(0.3);  // until the subscription is established
  StereoNodelet nodelet("range_test");
  nodelet.parameters().setParam("points_max_depth_m", 2e6);
  EXPECT_FALSE(nodelet.load());
  EXPECT_TRUE(log.waitForWarning(
      {"/range_test/nodelet/points_max_depth_m is 2000000, expected 0 to 1000000 m"}));
}

TEST(Startup, UnknownPrivateParametersAreNamed) {
  LogReader log;
  wait(0.3);  // until the subscription is established
  StereoNodelet nodelet("typo_test");
  nodelet.parameters().setParam("dispartiy_range", 96);
  nodelet.parameters().setParam("diagnostic_period", 1.0);
  nodelet.parameters().setParam("compressed/mode", "gray");  // parameter of an image transport
  nodelet.parameters().setParam("unknown_arguments", "fores : forest preset");
  ASSERT_TRUE(nodelet.load());
  EXPECT_TRUE(log.waitForWarning(
      {"/typo_test/nodelet/dispartiy_range is not a parameter", "Did you mean disparity_range?"}));
  EXPECT_TRUE(log.waitForWarning({"fores is not an argument", "Did you mean forest?"}));
  for (const char* known : {"diagnostic_period is", "mode is", "forest is", "preset is"}) {
    EXPECT_FALSE(log.waitForWarning({known}, 0.1)) << known;
  }
}

TEST(Startup, TwoInputsMayNotBeOneTopic) {
  LogReader log;
  wait(0.3);  // until the subscription is established
  StereoNodelet remapped("same_topic_test");
  EXPECT_FALSE(remapped.load({{"/same_topic_test/left/image_rect", "right/image_rect"}}));
  EXPECT_TRUE(log.waitForWarning(
      {"cannot start", "same topic /same_topic_test/right/image_rect", "remaps"}));
  StereoNodelet configured("same_info_test");
  configured.parameters().setParam("right_info_topic", "left/camera_info");
  EXPECT_FALSE(configured.load());
  EXPECT_TRUE(log.waitForWarning({"same topic /same_info_test/left/camera_info"}));
}

TEST(Startup, ParametersOfStereoImageProcWithAnotherMeaningAreReported) {
  LogReader log;
  wait(0.3);  // until the subscription is established
  StereoNodelet nodelet("stock_parameters_test");
  nodelet.parameters().setParam("P1", 200.0);
  nodelet.parameters().setParam("uniqueness_ratio", 15.0);
  ASSERT_TRUE(nodelet.load());
  EXPECT_TRUE(log.waitForWarning({"stock_parameters_test/nodelet/P1 is 200", "0 to 60"}));
  EXPECT_TRUE(log.waitForWarning({"stock_parameters_test/nodelet/uniqueness_ratio", "ignored"}));
}

/// Publishes a pair to the inputs of a namespace until a message arrives; null if none arrives.
template <typename Message>
std::shared_ptr<Message> outputOf(const std::string& name_space, const std::string& topic,
                                  const std::function<void(PairMessages&)>& change,
                                  double timeout_s = 10) {
  ros::NodeHandle nh("/" + name_space);
  Cameras cameras(nh);
  Collector<Message> output;
  output.subscribe(nh, topic);
  const auto comes = [&] {
    PairMessages messages = makeMessages(renderPair(kSize, kFarPx, kNearPx), {}, ros::Time::now());
    change(messages);
    cameras.publish(messages);
    wait(0.1);
    return output.count() > 0;
  };
  return waitFor(comes, timeout_s) ? std::make_shared<Message>(output.newest()) : nullptr;
}

void changeNothing(PairMessages&) {}

bool disparityComes(const std::string& name_space,
                    const std::function<void(PairMessages&)>& change = changeNothing,
                    double timeout_s = 10) {
  return outputOf<stereo_msgs::DisparityImage>(name_space, "disparity", change, timeout_s) !=
         nullptr;
}

std::function<void(PairMessages&)> delayRight(double delay_s) {
  return [delay_s](PairMessages& messages) {
    messages.right_image->header.stamp += ros::Duration(delay_s);
    messages.right_info->header.stamp += ros::Duration(delay_s);
  };
}

/// Cameras whose camera_info is published separately from the images.
class CameraInfos : public ::testing::Test {
 protected:
  static constexpr std::size_t kFrames = 20;
  /// When nothing waits any more, two pairs arrive at once.
  static constexpr std::size_t kMayBeReplaced = 1;

  void start(const std::string& name_space) {
    nh_ = ros::NodeHandle("/" + name_space);
    nodelet_ = std::make_unique<StereoNodelet>(name_space);
    ASSERT_TRUE(nodelet_->load());
    left_image_ = nh_.advertise<sensor_msgs::Image>("left/image_rect", 20);
    right_image_ = nh_.advertise<sensor_msgs::Image>("right/image_rect", 20);
    left_info_ = nh_.advertise<sensor_msgs::CameraInfo>("left/camera_info", 20, true);
    right_info_ = nh_.advertise<sensor_msgs::CameraInfo>("right/camera_info", 20, true);
  }
  void listen() {
    output_.subscribe(nh_, "disparity");
    ASSERT_TRUE(waitFor([&] {
      return left_image_.getNumSubscribers() > 0 && right_image_.getNumSubscribers() > 0 &&
             left_info_.getNumSubscribers() > 0 && right_info_.getNumSubscribers() > 0 &&
             output_.isConnected();
    }));
    wait(0.2);  // until latched messages have arrived
  }
  PairMessages messages() const { return makeMessages(pair_, {}, ros::Time::now()); }
  void publishImages(const PairMessages& messages) {
    left_image_.publish(messages.left_image);
    right_image_.publish(messages.right_image);
  }
  void publishInfos(const PairMessages& messages) {
    left_info_.publish(messages.left_info);
    right_info_.publish(messages.right_info);
  }
  bool haveCome(std::size_t count) {
    return waitFor([&] { return output_.count() >= count; });
  }

  ros::NodeHandle nh_;
  std::unique_ptr<StereoNodelet> nodelet_;
  StereoPair pair_ = renderPair({61, 43}, kFarPx, kNearPx);
  ros::Publisher left_image_;
  ros::Publisher right_image_;
  ros::Publisher left_info_;
  ros::Publisher right_info_;
  Collector<stereo_msgs::DisparityImage> output_;
};

TEST_F(CameraInfos, ThatAreLatchedServeEveryPair) {
  start("latched_test");
  PairMessages calibration = messages();
  calibration.left_info->header.stamp = calibration.right_info->header.stamp = ros::Time();
  publishInfos(calibration);
  listen();
  for (std::size_t i = 1; i <= kFrames; ++i) {
    publishImages(messages());
    wait(0.1);
    EXPECT_GE(output_.count(), i > 6 ? i - 2 : 0);  // none waits once the topic's kind is known
  }
  EXPECT_TRUE(haveCome(kFrames - kMayBeReplaced)) << output_.count();
}

TEST_F(CameraInfos, ThatAreLatchedServeTheOnlyPair) {
  start("latched_once_test");
  publishInfos(messages());
  listen();
  publishImages(messages());
  EXPECT_TRUE(haveCome(1));
}

TEST_F(CameraInfos, MayComeSeldom) {
  start("seldom_test");
  listen();
  for (std::size_t i = 0; i < kFrames; ++i) {
    if (i % 7 == 0) {
      publishInfos(messages());
    }
    publishImages(messages());
    wait(0.1);
  }
  EXPECT_TRUE(haveCome(kFrames - kMayBeReplaced)) << output_.count();
}

/// They arrive after their images, and each frame has another focal length.
TEST_F(CameraInfos, OfEveryImageAreWaitedFor) {
  start("late_info_test");
  listen();
  std::map<ros::Time, float> focal_lengths;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const float focal_length = 100.0F + static_cast<float>(i);
    PairMessages frame = messages();
    for (const auto& info : {frame.left_info, frame.right_info}) {
      info->P[0] = info->P[5] = focal_length;
    }
    focal_lengths[frame.left_image->header.stamp] = focal_length;
    publishImages(frame);
    wait(0.02);
    publishInfos(frame);
    wait(0.08);
  }
  ASSERT_TRUE(haveCome(kFrames)) << output_.count();
  for (const auto& [stamp, focal_length] : focal_lengths) {
    EXPECT_EQ(output_.at(stamp).f, focal_length);
  }
}

TEST(Synchronization, SaysWhyNothingComes) {
  LogReader log;
  StereoNodelet nodelet("sync_report_test");
  ASSERT_TRUE(nodelet.load());
  EXPECT_FALSE(disparityComes("sync_report_test", delayRight(0.002), 5.5));
  EXPECT_TRUE(log.waitForWarning({"no synchronized", "/sync_report_test/left/image_rect ", " Hz",
                                  "/sync_report_test/right/image_rect ", "(stamps 2.0 ms",
                                  "approximate_sync_max_interval_s to 0.003"}));
}

TEST(Synchronization, ApproximateSyncPairsCloseStampsOnly) {
  StereoNodelet nodelet("sync_test");
  nodelet.parameters().setParam("approximate_sync", true);
  nodelet.parameters().setParam("approximate_sync_max_interval_s", 0.01);
  ASSERT_TRUE(nodelet.load());
  // Frames are 0.1 s apart, so the nearest right image is 50 ms away.
  EXPECT_FALSE(disparityComes("sync_test", delayRight(0.05), 1.5));
  EXPECT_TRUE(disparityComes("sync_test", delayRight(0.002)));
}

TEST(Synchronization, ZeroIsNoBound) {
  StereoNodelet nodelet("unbounded_sync_test");
  nodelet.parameters().setParam("approximate_sync", true);
  nodelet.parameters().setParam("approximate_sync_max_interval_s", 0);
  ASSERT_TRUE(nodelet.load());
  EXPECT_TRUE(disparityComes("unbounded_sync_test", delayRight(0.05)));
}

void renameRightFrame(PairMessages& messages) {
  messages.right_image->header.frame_id = messages.right_info->header.frame_id = "right_camera";
}

TEST(FrameIds, MayDiffer) {
  StereoNodelet nodelet("frame_id_test");
  ASSERT_TRUE(nodelet.load());
  const auto disparity =
      outputOf<stereo_msgs::DisparityImage>("frame_id_test", "disparity", renameRightFrame);
  ASSERT_TRUE(disparity);
  EXPECT_EQ(disparity->header.frame_id, "left_camera");
}

TEST(FrameIds, AreRejectedIfTheyMayNotDiffer) {
  LogReader log;
  StereoNodelet nodelet("rejected_frame_id_test");
  nodelet.parameters().setParam("allow_different_frame_ids", false);
  ASSERT_TRUE(nodelet.load());
  EXPECT_FALSE(disparityComes("rejected_frame_id_test", renameRightFrame, 1));
  EXPECT_TRUE(log.waitForWarning({"/rejected_frame_id_test/left/image_rect",
                                  "/rejected_frame_id_test/right/image_rect", "'left_camera'",
                                  "'right_camera'", "allow_different_frame_ids"}));
}

TEST(Topics, CanBeRemapped) {
  StereoNodelet nodelet("remap_test");
  ASSERT_TRUE(nodelet.load({{"/remap_test/disparity", "/remap_test/renamed"},
                            {"/remap_test/left/image_rect", "/elsewhere/left/image_rect"},
                            {"/remap_test/left/camera_info", "/elsewhere/left/camera_info"},
                            {"/remap_test/right/image_rect", "/elsewhere/right/image_rect"},
                            {"/remap_test/right/camera_info", "/elsewhere/right/camera_info"}}));
  EXPECT_TRUE(
      outputOf<stereo_msgs::DisparityImage>("elsewhere", "/remap_test/renamed", changeNothing));
}

TEST(Topics, AreTheParameters) {
  StereoNodelet nodelet("topic_parameter_test");
  nodelet.parameters().setParam("left_image_topic", "/named/left/image_rect");
  nodelet.parameters().setParam("left_info_topic", "/named/left/camera_info");
  nodelet.parameters().setParam("right_image_topic", "/no/such/image");
  nodelet.parameters().setParam("right_info_topic", "names/right_info");
  ASSERT_TRUE(nodelet.load({
      {"/topic_parameter_test/right/image_rect", "/named/right/image_rect"},  // has priority
      {"/topic_parameter_test/names/right_info", "/named/right/camera_info"},
  }));
  EXPECT_TRUE(outputOf<stereo_msgs::DisparityImage>("named", "/topic_parameter_test/disparity",
                                                    changeNothing));
}

/// Remaps that exchange the cameras must not be applied twice.
TEST(Topics, MayBeExchanged) {
  StereoNodelet nodelet("exchange_test");
  ASSERT_TRUE(
      nodelet.load({{"/exchange_test/left/image_rect", "/exchange_test/right/image_rect"},
                    {"/exchange_test/left/camera_info", "/exchange_test/right/camera_info"},
                    {"/exchange_test/right/image_rect", "/exchange_test/left/image_rect"},
                    {"/exchange_test/right/camera_info", "/exchange_test/left/camera_info"}}));
  EXPECT_TRUE(disparityComes("exchange_test", [](PairMessages& messages) {
    std::swap(messages.left_image, messages.right_image);
    std::swap(messages.left_info, messages.right_info);
  }));
  EXPECT_FALSE(disparityComes("exchange_test", changeNothing, 1));
}

TEST(Topics, ImageTransportIsTheParameters) {
  LogReader log;
  StereoNodelet nodelet("transport_test");
  nodelet.parameters().setParam("image_transport", "no_such_transport");
  ASSERT_TRUE(nodelet.load());
  EXPECT_FALSE(disparityComes("transport_test", changeNothing, 0.5));
  EXPECT_TRUE(log.waitForWarning({"image_transport", "'no_such_transport'"}));
}

TEST(Points, LayoutIsTheParameters) {
  StereoNodelet nodelet("cloud_test");
  nodelet.parameters().setParam("points_compact", true);
  nodelet.parameters().setParam("points_confidence", true);
  nodelet.parameters().setParam("points_sigma", true);
  nodelet.parameters().setParam("points_max_depth_m", 5);  // f T = 30: disparities of at least 6 px
  ASSERT_TRUE(nodelet.load());
  const auto cloud = outputOf<sensor_msgs::PointCloud2>("cloud_test", "points2", changeNothing);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->point_step, 24U);
  ASSERT_EQ(cloud->fields.size(), 6U);
  EXPECT_EQ(cloud->fields[4].name, "confidence");
  EXPECT_EQ(cloud->fields[5].name, "sigma");
  const auto depth_at = [&](std::size_t x, std::size_t y) {
    float z = 0;
    std::memcpy(&z, &cloud->data[y * cloud->row_step + x * cloud->point_step + 8], sizeof(z));
    return z;
  };
  EXPECT_NEAR(depth_at(62, 40), 30.0 / kNearPx, 0.2);
  EXPECT_TRUE(std::isnan(depth_at(62, 8)));
}

TEST(Diagnostics, FollowTheStream) {
  using diagnostic_msgs::DiagnosticStatus;
  DiagnosticsReader reader("diagnostics_test/nodelet");
  StereoNodelet nodelet("diagnostics_test");
  nodelet.parameters().setParam("warn_silence_s", 1.0);
  nodelet.parameters().setParam("warn_vertical_offset_px", 0.5);
  nodelet.parameters().setParam("rectification_interval", 0.0);
  ASSERT_TRUE(nodelet.load());
  EXPECT_TRUE(reader.waitFor("Input", DiagnosticStatus::OK, "idle"));

  ros::NodeHandle nh("/diagnostics_test");
  Cameras cameras(nh);
  Collector<stereo_msgs::DisparityImage> output;
  output.subscribe(nh, "disparity");
  EXPECT_TRUE(reader.waitFor("Input", DiagnosticStatus::ERROR, "no pair of images for"));

  StereoPair pair = renderPair(kSize, kFarPx, kNearPx);
  const auto publish = [&] { cameras.publish(makeMessages(pair, {}, ros::Time::now())); };
  EXPECT_TRUE(reader.waitFor("Input", DiagnosticStatus::OK, "pairs of images at", publish));
  EXPECT_TRUE(reader.waitFor("Output", DiagnosticStatus::OK, "results at", publish));
  EXPECT_TRUE(reader.waitFor("Calibration", DiagnosticStatus::OK, "baseline 0.2500 m", publish));
  EXPECT_TRUE(reader.waitFor("Method", DiagnosticStatus::OK, "ms per frame", publish));
  EXPECT_TRUE(
      reader.waitFor("Rectification", DiagnosticStatus::OK, "the rows are aligned", publish));

  LogReader log;
  const cv::Mat one_row_down = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, 1);
  cv::warpAffine(pair.right.clone(), pair.right, one_row_down, kSize, cv::INTER_NEAREST,
                 cv::BORDER_REPLICATE);
  EXPECT_TRUE(reader.waitFor("Rectification", DiagnosticStatus::WARN,
                             "the residual vertical offset is", publish));
  EXPECT_TRUE(
      log.waitForWarning({"the residual vertical offset is", "warn_vertical_offset_px = 0.50"}));

  EXPECT_TRUE(reader.waitFor("Calibration", DiagnosticStatus::ERROR, "P[3]", [&] {
    PairMessages swapped = makeMessages(pair, {}, ros::Time::now());
    swapped.right_info->P[3] = -swapped.right_info->P[3];
    cameras.publish(swapped);
  }));
  EXPECT_TRUE(reader.waitFor("Output", DiagnosticStatus::WARN, "dropped in the last 10 s"));
}

TEST(Shutdown, UnloadsWhileAFrameIsInWork) {
  for (int round = 0; round < 5; ++round) {
    StereoNodelet nodelet("unload_test");
    nodelet.parameters().setParam("disparity_range", 64);
    ASSERT_TRUE(nodelet.load());
    ASSERT_TRUE(disparityComes("unload_test"));
    EXPECT_TRUE(nodelet.unload());
  }
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
