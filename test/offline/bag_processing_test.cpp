#include "offline/bag_processing.h"

#include <filesystem>
#include <fstream>

#include <boost/make_shared.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <image_geometry/pinhole_camera_model.h>
#include <opencv2/imgcodecs.hpp>
#include <sensor_msgs/CompressedImage.h>
#include <std_msgs/String.h>

#include "evaluation/rendered_scene.h"
#include "io/camera_yaml.h"
#include "offline/frame_outputs.h"
#include "recording.h"
#include "ros/conversions.h"
#include "support/error_text.h"
#include "support/file_content.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class BagProcessingTest : public testing::Test {
 protected:
  BagProcessingSummary process(const BagProcessingOptions& options) {
    return processBags(options, forest_, {});
  }
  ProcessedFrame processLive(const PairMessages& messages) {
    FrameProcessor processor(forest_, options_.matching.stereo);
    FollowedOffset offset;
    return processor.match(processor.prepare(toStereoInput(messages.asConst(), {}, false)), offset);
  }
  /// Makes the cloud of one pair of 96×64 pixels of one color (blue, green, red).
  void expectCloudOfColor(int blue, int green, int red) {
    options_.outputs = {"cloud"};
    options_.matching.stereo.range = {2, 3};  // textureless, so any disparity is acceptable
    process(options_);
    const auto clouds = readTopic<sensor_msgs::PointCloud2>(output_, "/points2");
    ASSERT_EQ(clouds.size(), 1U);
    const std::uint8_t* center = &clouds[0]->data[(32 * 96 + 48) * clouds[0]->point_step + 16];
    EXPECT_EQ(center[0], blue);
    EXPECT_EQ(center[1], green);
    EXPECT_EQ(center[2], red);
  }
  std::string disparityLive(const PairMessages& messages) {
    const ProcessedFrame frame = processLive(messages);
    return bytesOf(toDisparityImage(frame.result, frame.geometry, frame.disparity_step_px,
                                    messages.left_image->header));
  }
  std::vector<stereo_msgs::DisparityImagePtr> disparities(const std::string& path) {
    return readTopic<stereo_msgs::DisparityImage>(path, "/stereo/disparity");
  }

  TemporaryFolder folder_;
  std::string input_ = folder_.file("in.bag");
  std::string output_ = folder_.file("out.bag");
  BagProcessingOptions options_ = processingOf(input_, output_);
  std::shared_ptr<const Forest> forest_ = fixtureForest();
};

TEST_F(BagProcessingTest, WritesWhatTheLiveNodePublishes) {
  writeRecording(input_, 4);
  options_.outputs = {"disparity", "depth", "confidence", "cloud"};
  const BagProcessingSummary summary = process(options_);
  EXPECT_TRUE(summary.isComplete());
  EXPECT_EQ(summary.processed, 4U);
  const Content content = messagesOf(output_);
  ASSERT_EQ(content.size(), 16U);
  for (int index = 0; index < 4; ++index) {
    const PairMessages messages = recordedFrame(index);
    const ProcessedFrame frame = processLive(messages);
    const std_msgs::Header& header = messages.left_image->header;
    cv::Mat color;
    cv::cvtColor(frame.left_gray, color, cv::COLOR_GRAY2BGR);
    const CloudSource cloud{toValidDisparity(frame.result, frame.geometry), color, {}, {}};
    const std::map<std::string, std::string> expected = {
        {"/stereo/disparity", disparityLive(messages)},
        {"/stereo/depth", bytesOf(toDepthImage(frame.result, frame.geometry, header))},
        {"/stereo/confidence", bytesOf(toConfidenceImage(frame.result, header))},
        {"/stereo/points2", bytesOf(toPointCloud(cloud, frame.geometry, {}, header))}};
    for (int i = 4 * index; i < 4 * index + 4; ++i) {
      const auto& [topic, time, bytes] = content[static_cast<std::size_t>(i)];
      EXPECT_TRUE(bytes == expected.at(topic)) << topic << " of frame " << index;
      EXPECT_NEAR(time, header.stamp.toSec() + 0.02, 1e-9);
    }
  }
}

TEST_F(BagProcessingTest, EveryOutputCanBeAskedFor) {
  writeRecording(input_, 1);
  options_.outputs = fixtureOutputs();
  process(options_);
  EXPECT_EQ(messagesOf(output_).size(), fixtureOutputs().size());
  options_.outputs = {"disparity", "flow"};
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"'flow'", "disparity, depth"}));
}

TEST_F(BagProcessingTest, DepthSigmaNeedsASecondForest) {
  writeRecording(input_, 1);
  options_.outputs = {"disparity", "depth_sigma"};
  EXPECT_TRUE(
      mentions(errorText([&] { process(options_); }), {"depth_sigma", "second forest", "--write"}));
}

TEST_F(BagProcessingTest, ThreadsChangeNothing) {
  writeRecording(input_, 7);
  options_.matching.stereo.threads = 1;
  process(options_);
  options_.output = folder_.file("many.bag");
  options_.matching.stereo.threads = 4;
  process(options_);
  EXPECT_EQ(messagesOf(output_).size(), 7U);
  EXPECT_TRUE(messagesOf(output_) == messagesOf(options_.output));
}

/// The range is found per frame, independent of earlier frames: a near object in the middle of the
/// bag.
TEST_F(BagProcessingTest, AnAutomaticRangeIsThatOfTheFrame) {
  const cv::Size size(160, 96);
  const auto message = [&](int index) {
    return makeMessages(renderPair(size, 3, index == 2 ? 40 : 8, 5), Rig{},
                        ros::Time(100 + 0.1 * index));
  };
  {
    rosbag::Bag bag(input_, rosbag::bagmode::Write);
    for (int index = 0; index < 5; ++index) {
      writeFrame(bag, message(index));
    }
  }
  options_.matching.stereo.range.count = 0;
  EXPECT_EQ(process(options_).processed, 5U);
  const auto found = disparities(output_);
  ASSERT_EQ(found.size(), 5U);
  for (int index = 0; index < 5; ++index) {
    EXPECT_EQ(bytesOf(*found[index]), disparityLive(message(index))) << index;
  }
  EXPECT_GE(found[2]->max_disparity, 40);
  EXPECT_LT(found[3]->max_disparity, 40);
  options_.output = folder_.file("one.bag");
  options_.matching.stereo.threads = 1;
  process(options_);
  EXPECT_TRUE(messagesOf(output_) == messagesOf(options_.output));
}

TEST_F(BagProcessingTest, CountsWhatHasNoPartner) {
  const PairMessages late = recordedFrame(20);
  const PairMessages lone = recordedFrame(30);
  writeRecording(input_, 3, [&](rosbag::Bag& bag) {
    late.right_image->header.stamp += ros::Duration(0.01);
    writeFrame(bag, late);
    bag.write("/stereo/right/image_rect", ros::Time(104), lone.right_image);
    bag.write("/stereo/left/image_rect", ros::Time(105), recordedFrame(1).left_image);
  });
  const BagProcessingSummary exact = process(options_);
  EXPECT_EQ(exact.processed, 3U);
  EXPECT_EQ(exact.plan.left_alone, 1U);
  EXPECT_EQ(exact.plan.right_alone, 2U);
  EXPECT_EQ(exact.plan.repeated_stamps, 1U);
  EXPECT_NEAR(exact.plan.smallest_gap_s, 0.01, 1e-6);

  options_.earlier = EarlierParts::kOverwrite;
  options_.plan.max_stamp_difference_s = 0.05;
  const BagProcessingSummary close = process(options_);
  EXPECT_EQ(close.processed, 4U);
  EXPECT_EQ(close.plan.left_alone, 0U);
  EXPECT_EQ(close.plan.infos_of_other_stamps, 1U);
  EXPECT_EQ(bytesOf(*disparities(output_).back()), disparityLive(recordedFrame(20)));
}

TEST_F(BagProcessingTest, TakesAPartOfTheRecording) {
  writeRecording(input_, 10);
  options_.plan.start_s = 0.15;  // recorded every 0.1 s
  options_.plan.duration_s = 0.6;
  options_.plan.every = 2;
  process(options_);
  const auto found = disparities(output_);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR(found[0]->header.stamp.toSec(), 100.2, 1e-6);
  EXPECT_NEAR(found[2]->header.stamp.toSec(), 100.6, 1e-6);
}

TEST_F(BagProcessingTest, SplitRecordingsAreOne) {
  writeRecording(input_, 2);
  const std::string second = folder_.file("second.bag");
  rosbag::Bag bag(second, rosbag::bagmode::Write);
  writeFrame(bag, recordedFrame(2));
  bag.close();
  options_.inputs = {second, input_};
  EXPECT_EQ(process(options_).processed, 3U);
  EXPECT_EQ(disparities(output_).front()->header.stamp, ros::Time(100));
}

TEST_F(BagProcessingTest, CopiesTheOtherTopics) {
  std_msgs::String word;
  word.data = "word";
  const auto fill = [&](rosbag::Bag& bag) {
    bag.write("/words", ros::Time(100.15), word);
    bag.write("/words", ros::Time(101), word);
  };
  writeRecording(input_, 3, fill);
  options_.copy = true;
  options_.compression = "lz4";
  process(options_);
  const Content content = messagesOf(output_);
  Content copied;
  std::copy_if(content.begin(), content.end(), std::back_inserter(copied),
               [](const auto& message) { return std::get<0>(message) != "/stereo/disparity"; });
  Content expected = messagesOf(input_);
  std::sort(copied.begin(), copied.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_TRUE(copied == expected);
  EXPECT_EQ(content.size(), expected.size() + 3);
  EXPECT_TRUE(std::is_sorted(content.begin(), content.end(), [](const auto& a, const auto& b) {
    return std::get<1>(a) < std::get<1>(b);
  }));
}

sensor_msgs::CompressedImage compress(const sensor_msgs::Image& image, const std::string& kind,
                                      const std::string& format) {
  sensor_msgs::CompressedImage message;
  message.header = image.header;
  message.format = format;
  const cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
                       const_cast<std::uint8_t*>(image.data.data()));
  cv::imencode(kind, pixels, message.data);
  return message;
}

void writeCompressed(const std::string& path, const PairMessages& messages,
                     const std::string& kind) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  const ros::Time time = messages.left_image->header.stamp;
  const std::string format = "mono8; " + kind.substr(1) + " compressed ";
  bag.write("/cam/left/image_rect/compressed", time, compress(*messages.left_image, kind, format));
  bag.write("/cam/right/image_rect/compressed", time,
            compress(*messages.right_image, kind, format));
  bag.write("/cam/left/camera_info", time, messages.left_info);
  bag.write("/cam/right/camera_info", time, messages.right_info);
}

TEST_F(BagProcessingTest, ReadsCompressedImages) {
  const PairMessages messages = recordedFrame(0);
  writeCompressed(input_, messages, ".png");
  process(options_);
  const auto found = readTopic<stereo_msgs::DisparityImage>(output_, "/cam/disparity");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(bytesOf(*found[0]), disparityLive(messages));

  PairMessages lossy = recordedFrame(0);
  for (const auto& image : {lossy.left_image, lossy.right_image}) {
    const cv::Mat pixels =
        cv::imdecode(compress(*image, ".jpg", "jpeg").data, cv::IMREAD_GRAYSCALE);
    image->data.assign(pixels.data, pixels.data + pixels.total());
  }
  options_.earlier = EarlierParts::kOverwrite;
  writeCompressed(input_, messages, ".jpg");
  process(options_);
  const auto of_jpeg = readTopic<stereo_msgs::DisparityImage>(output_, "/cam/disparity");
  EXPECT_EQ(bytesOf(*of_jpeg.at(0)), disparityLive(lossy));
}

TEST(DecompressImage, KeepsBayerAndNamesWhatIsBroken) {
  const PairMessages messages = recordedFrame(0);
  const auto bayer =
      decompressImage(compress(*messages.left_image, ".png", "bayer_rggb8; png compressed "), "t");
  EXPECT_EQ(bayer->encoding, "bayer_rggb8");
  EXPECT_EQ(bayer->data, messages.left_image->data);
  sensor_msgs::CompressedImage broken;
  broken.format = "jpeg";
  for (const auto& bytes : {std::vector<std::uint8_t>{}, std::vector<std::uint8_t>(40, 7)}) {
    broken.data = bytes;
    EXPECT_TRUE(mentions(errorText([&] { decompressImage(broken, "/t"); }), {"/t", "'jpeg'"}));
  }
}

/// Adds distortion; the right camera is rotated.
void bendLens(sensor_msgs::CameraInfo& info, double angle) {
  info.distortion_model = "plumb_bob";
  info.D = {-0.2, 0.05, 0.001, -0.002, 0};
  info.K = {110, 0, 48, 0, 111, 32, 0, 0, 1};
  info.R = {std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle)};
}

TEST_F(BagProcessingTest, RectifiesRawImages) {
  PairMessages messages = recordedFrame(0);
  messages.right_image->encoding = "8UC1";
  bendLens(*messages.left_info, 0);
  bendLens(*messages.right_info, 0.01);
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  const ros::Time time(100);
  bag.write("/left/image_raw", time, messages.left_image);
  bag.write("/right/image_raw", time, messages.right_image);
  bag.write("/left/camera_info", time, messages.left_info);
  bag.write("/right/camera_info", time, messages.right_info);
  bag.close();
  options_.matching.stereo.rectification.enabled = false;
  process(options_);

  const auto rectify = [](sensor_msgs::Image& image, const sensor_msgs::CameraInfo& info) {
    image_geometry::PinholeCameraModel camera;
    camera.fromCameraInfo(info);
    const cv::Mat raw(64, 96, CV_8UC1, image.data.data());
    cv::Mat rectified;
    camera.rectifyImage(raw, rectified);
    ASSERT_GT(cv::countNonZero(raw != rectified), 1000);
    image.data.assign(rectified.data, rectified.data + rectified.total());
  };
  rectify(*messages.left_image, *messages.left_info);
  rectify(*messages.right_image, *messages.right_info);
  const auto found = readTopic<stereo_msgs::DisparityImage>(output_, "/disparity");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(bytesOf(*found[0]), disparityLive(messages));
}

TEST_F(BagProcessingTest, CloudsOfRawColorAreColored) {
  PairMessages messages = recordedFrame(0);
  bendLens(*messages.left_info, 0);
  bendLens(*messages.right_info, 0);
  const cv::Mat blue(64, 96, CV_8UC3, cv::Scalar(200, 100, 0));
  const std_msgs::Header header = messages.left_image->header;
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  for (const std::string side : {"left", "right"}) {
    const bool left = side == "left";
    bag.write("/" + side + "/image_raw", header.stamp, makeImage(blue, "bgr8", header));
    bag.write("/" + side + "/camera_info", header.stamp,
              left ? messages.left_info : messages.right_info);
  }
  bag.close();
  expectCloudOfColor(200, 100, 0);
}

TEST_F(BagProcessingTest, ListsWhatIsThereIfThereIsNoPair) {
  const PairMessages messages = recordedFrame(0);
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  bag.write("/mono/image_raw", ros::Time(1), messages.left_image);
  bag.close();
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }),
                       {"in.bag", "no stereo pair", "/mono/image_raw  sensor_msgs/Image  1"}));
  options_.topics.left = options_.topics.right = "/mono/image_raw";
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"are both /mono/image_raw"}));
  options_.topics.right = "/other/image_raw";
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"no images on /other/image_raw"}));
  options_.topics.right.clear();
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"--left and --right"}));
  EXPECT_FALSE(fs::exists(output_ + ".part.json"));
}

/// Pairs named image_raw that are already rectified, with the raw calibration, as written by
/// kitti2bag.
class RectifiedAsRaw : public BagProcessingTest {
 protected:
  RectifiedAsRaw() {
    rosbag::Bag bag(input_, rosbag::bagmode::Write);
    RenderOptions render;
    const RenderedScene scene = renderScene(320, 240, 1, render);
    PairMessages messages = makeMessages({scene.left, scene.right, {}},
                                         {300, 0.1, 159.5, 159.5, 119.5}, ros::Time(100));
    for (const bool left : {true, false}) {
      sensor_msgs::CameraInfo& info = left ? *messages.left_info : *messages.right_info;
      info.distortion_model = "plumb_bob";
      info.D = {left ? -0.3 : -0.25, 0.1, 0, 0, 0};
      info.K = {left ? 305.0 : 310.0, 0, 158, 0, left ? 305.0 : 310.0,
                left ? 121.0 : 124.0, 0, 0,   1};
    }
    const ros::Time time(100);
    bag.write("/kitti/left/image_raw", time, messages.left_image);
    bag.write("/kitti/left/camera_info", time, messages.left_info);
    bag.write("/kitti/right/image_raw", time, messages.right_image);
    bag.write("/kitti/right/camera_info", time, messages.right_info);
    options_.matching.stereo.range = {0, 40};
    live_ = processLive(messages).result.disparity;
  }
  cv::Mat disparity() {
    const auto found = readTopic<stereo_msgs::DisparityImage>(output_, "/kitti/disparity");
    return found.size() == 1 ? toValidDisparity(*found[0], "") : cv::Mat();
  }

  cv::Mat live_;
};

TEST_F(RectifiedAsRaw, AreWarnedOf) {
  const BagProcessingSummary summary = process(options_);
  EXPECT_TRUE(summary.plan.topics.left.raw);
  EXPECT_TRUE(mentions(describeSummary(summary),
                       {"/kitti/left/image_raw and /kitti/right/image_raw are treated as raw and "
                        "rectified first: not both names contain \"rect\"",
                        "warning", "probably rectified already; use --rectified yes"}));
  EXPECT_TRUE(mentions(summaryJson(summary), {"\"rectified_by_us\": true"}));
}

TEST_F(RectifiedAsRaw, AreTakenAsTheyAreIfTheUserSaysSo) {
  options_.topics.rectified = Rectified::kYes;
  const BagProcessingSummary summary = process(options_);
  EXPECT_TRUE(summary.warnings.empty());
  EXPECT_TRUE(mentions(describeSummary(summary), {"are treated as rectified: --rectified yes"}));
  EXPECT_TRUE(mentions(summaryJson(summary), {"\"rectified_by_us\": false"}));
  ASSERT_EQ(disparity().size(), live_.size());
  EXPECT_EQ(cv::norm(disparity(), live_, cv::NORM_INF), 0);
}

/// The output would mix both kinds of frames.
TEST_F(RectifiedAsRaw, AreNotResumedWithAnotherChoice) {
  BagProcessingEvents events;
  events.should_stop = [] { return true; };
  processBags(options_, forest_, events);
  options_.earlier = EarlierParts::kResume;
  options_.topics.rectified = Rectified::kYes;
  EXPECT_TRUE(
      mentions(errorText([&] { process(options_); }), {"started with other input or options"}));
  options_.topics.rectified = Rectified::kNo;  // the choice derived from the name
  EXPECT_TRUE(process(options_).was_written);
}

TEST_F(RectifiedAsRaw, AreToldOfBeforeTheWork) {
  BagProcessingEvents events;
  std::size_t told = 0;
  events.begin = [&](const BagProcessingSummary& summary) {
    ++told;
    EXPECT_EQ(summary.processed, 0U);
    EXPECT_THAT(summary.plan.topics.rectification,
                HasSubstr("are treated as raw and rectified first"));
    EXPECT_THAT(summary.warnings, ElementsAre(HasSubstr("use --rectified yes")));
  };
  processBags(options_, forest_, events);
  EXPECT_EQ(told, 1U);
}

TEST_F(RectifiedAsRaw, MayBeNamedRelatively) {
  options_.topics.left = "kitti/left/image_raw";
  options_.topics.right = "kitti/right/image_raw";
  options_.topics.rectified = Rectified::kYes;
  EXPECT_TRUE(process(options_).isComplete());
}

/// Used without camera_info, or instead of it.
TEST_F(BagProcessingTest, CalibrationsMayBeFiles) {
  const PairMessages messages = recordedFrame(0);
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  bag.write("/cam0/image_rect", ros::Time(100), messages.left_image);
  bag.write("/cam1/image_rect", ros::Time(100), messages.right_image);
  bag.close();
  options_.topics.left = "/cam0/image_rect";
  options_.topics.right = "/cam1/image_rect";
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }),
                       {"/cam0/camera_info is missing", "--left-calibration"}));
  sensor_msgs::CameraInfo right = *messages.right_info;
  right.P[3] *= 2;
  writeCameraYaml(folder_.file("left.yaml"), toCameraCalibration(*messages.left_info));
  writeCameraYaml(folder_.file("right.yaml"), toCameraCalibration(right));
  options_.topics.left_calibration = folder_.file("left.yaml");
  options_.topics.right_calibration = folder_.file("right.yaml");
  options_.topics.camera_namespace = "stereo";
  EXPECT_TRUE(process(options_).isComplete());
  ASSERT_EQ(disparities(output_).size(), 1U);
  EXPECT_FLOAT_EQ(disparities(output_)[0]->T, 0.5F);
}

/// A bag without camera_info, with images of these names, and calibration files.
class CalibratedByFiles : public BagProcessingTest {
 protected:
  void write(const std::string& image, const cv::Mat& pixels, const std::string& encoding) {
    const PairMessages messages = recordedFrame(0);
    rosbag::Bag bag(input_, rosbag::bagmode::Write);
    for (const char* camera : {"/cam0/", "/cam1/"}) {
      bag.write(camera + image, ros::Time(100),
                makeImage(pixels, encoding, messages.left_image->header));
    }
    bag.close();
    options_.topics.left = "/cam0/" + image;
    options_.topics.right = "/cam1/" + image;
    options_.topics.left_calibration = folder_.file("left.yaml");
    options_.topics.right_calibration = folder_.file("right.yaml");
    writeFiles(*messages.left_info, *messages.right_info);
  }
  void writeFiles(const sensor_msgs::CameraInfo& left, const sensor_msgs::CameraInfo& right) {
    writeCameraYaml(options_.topics.left_calibration, toCameraCalibration(left));
    writeCameraYaml(options_.topics.right_calibration, toCameraCalibration(right));
  }
  std::string failure() {
    const BagProcessingSummary summary = process(options_);
    return summary.failures.empty() ? "" : summary.failures.begin()->first;
  }
};

TEST_F(CalibratedByFiles, AreNotResumedWithAnotherCalibration) {
  write("image_rect", renderPair({96, 64}, 3, 8).left, "mono8");
  BagProcessingEvents events;
  events.should_stop = [] { return true; };
  processBags(options_, forest_, events);
  sensor_msgs::CameraInfo right = *recordedFrame(0).right_info;
  right.P[3] *= 1 + 1e-9;
  writeFiles(*recordedFrame(0).left_info, right);
  options_.earlier = EarlierParts::kResume;
  EXPECT_TRUE(
      mentions(errorText([&] { process(options_); }), {"started with other input or options"}));
  writeFiles(*recordedFrame(0).left_info, *recordedFrame(0).right_info);
  EXPECT_TRUE(process(options_).was_written);
}

TEST_F(CalibratedByFiles, NameTheFileThatCannotBeUsed) {
  write("image_raw", renderPair({96, 64}, 3, 8).left, "mono8");
  sensor_msgs::CameraInfo left = *recordedFrame(0).left_info;
  left.distortion_model = "fisheye";
  left.D.assign(4, 0.0);
  writeFiles(left, *recordedFrame(0).right_info);
  EXPECT_TRUE(mentions(failure(), {"/cam0/image_raw is raw, but ",
                                   "left.yaml has an unknown distortion model 'fisheye'"}));
}

/// Middlebury's calib.txt has no data for raw images.
TEST_F(CalibratedByFiles, OfRectifiedImagesRectifyNothing) {
  write("image_raw", renderPair({96, 64}, 3, 8).left, "mono8");
  options_.topics.left_calibration = folder_.file("calib.txt");
  options_.topics.right_calibration.clear();
  std::ofstream(options_.topics.left_calibration)
      << "cam0=[120 0 62.5; 0 120 40.25; 0 0 1]\ncam1=[120 0 62.5; 0 120 40.25; 0 0 1]\n"
         "doffs=0\nbaseline=250\nwidth=96\nheight=64\nndisp=16\n";
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }),
                       {"calib.txt", "describes rectified images, but /cam0/image_raw",
                        "to use them as they are, use --rectified yes"}));
  options_.topics.rectified = Rectified::kYes;
  EXPECT_TRUE(process(options_).was_written);
}

/// For rectified images with other names, image_rect_color beside them is the color source of
/// clouds.
TEST_F(CalibratedByFiles, CloudsTakeTheColorsOfImagesThatAreNotNamedRectified) {
  write("image_raw", cv::Mat(64, 96, CV_8UC3, cv::Scalar(200, 100, 0)), "bgr8");
  options_.topics.rectified = Rectified::kYes;
  expectCloudOfColor(200, 100, 0);
}

TEST_F(BagProcessingTest, ChoosesAmongCameras) {
  const PairMessages messages = recordedFrame(0);
  writeRecording(input_, 2, [&](rosbag::Bag& bag) {
    for (const std::string side : {"left", "right"}) {
      const bool left = side == "left";
      bag.write("/rear/" + side + "/image_rect", ros::Time(100),
                left ? messages.left_image : messages.right_image);
      bag.write("/rear/" + side + "/camera_info", ros::Time(100),
                left ? messages.left_info : messages.right_info);
    }
  });
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"--namespace", "/rear", "/stereo"}));
  options_.topics.camera_namespace = "rear/";
  EXPECT_EQ(process(options_).processed, 1U);
  EXPECT_EQ(std::get<0>(messagesOf(output_).at(0)), "/rear/disparity");
}

TEST_F(BagProcessingTest, GoesOnAfterFramesThatFail) {
  writeRecordingWithABadFrame(input_);
  const BagProcessingSummary summary = process(options_);
  EXPECT_EQ(summary.failed, 1U);
  EXPECT_FALSE(summary.isComplete());
  ASSERT_EQ(summary.failures.size(), 1U);
  EXPECT_TRUE(
      mentions(describeSummary(summary), {"3 of 4 frames done, 1 failed", "different sizes"}));
  ASSERT_EQ(disparities(output_).size(), 3U);
  EXPECT_EQ(bytesOf(*disparities(output_)[2]), disparityLive(recordedFrame(3)));
}

TEST_F(BagProcessingTest, NothingPairedIsNoSuccess) {
  writeRecording(input_, 0, [](rosbag::Bag& bag) {
    for (int index = 0; index < 3; ++index) {
      PairMessages messages = recordedFrame(index);
      messages.right_image->header.stamp += ros::Duration(0.001);
      writeFrame(bag, messages);
    }
  });
  const BagProcessingSummary summary = process(options_);
  EXPECT_FALSE(summary.isComplete());
  EXPECT_FALSE(summary.was_written);
  EXPECT_FALSE(fs::exists(output_));
  ASSERT_EQ(summary.problems.size(), 1U);
  EXPECT_TRUE(mentions(summary.problems[0],
                       {"no pair", "3 left images", "--max-stamp-difference-s 0.0011"}));
  options_.plan.max_stamp_difference_s = 0.0011;
  EXPECT_TRUE(process(options_).isComplete());
}

TEST_F(BagProcessingTest, AnEmptyPartOfTheRecordingIsNoSuccess) {
  writeRecording(input_, 2);
  options_.plan.start_s = 1000;
  const BagProcessingSummary summary = process(options_);
  EXPECT_FALSE(summary.isComplete());
  ASSERT_EQ(summary.problems.size(), 1U);
  EXPECT_TRUE(mentions(summary.problems[0], {"/stereo/left/image_rect", "--start"}));
}

TEST_F(BagProcessingTest, WithoutAnyResultNoBagIsWritten) {
  writeRecording(input_, 0, [](rosbag::Bag& bag) {
    PairMessages messages = recordedFrame(0);
    messages.right_info->P[3] = 0;
    writeFrame(bag, messages);
  });
  const BagProcessingSummary summary = process(options_);
  EXPECT_FALSE(summary.isComplete());
  EXPECT_FALSE(fs::exists(output_));
  EXPECT_TRUE(mentions(describeSummary(summary), {"0 of 1 frames done, 1 failed", "baseline"}));
}

/// For drivers that do not set stamps. The node pairs images in order of arrival, too.
TEST_F(BagProcessingTest, StampsThatRepeatArePairedInTheOrderOfTheRecording) {
  writeRecording(input_, 0, [](rosbag::Bag& bag) {
    for (int index = 0; index < 3; ++index) {
      PairMessages messages = recordedFrame(index);
      const ros::Time time(100 + index);
      for (std_msgs::Header* header :
           {&messages.left_image->header, &messages.left_info->header,
            &messages.right_image->header, &messages.right_info->header}) {
        header->stamp = ros::Time(0, 0);
      }
      messages.right_info->P[3] *= index + 1;  // a different baseline each time
      bag.write("/stereo/left/camera_info", time, messages.left_info);
      bag.write("/stereo/right/camera_info", time, messages.right_info);
      bag.write("/stereo/left/image_rect", time, messages.left_image);
      bag.write("/stereo/right/image_rect", time, messages.right_image);
    }
  });
  const BagProcessingSummary summary = process(options_);
  EXPECT_TRUE(summary.isComplete());
  EXPECT_EQ(summary.plan.equal_stamps, 2U);
  EXPECT_TRUE(
      mentions(describeSummary(summary), {"2 pairs have the same stamp as the previous pair"}));
  const auto found = disparities(output_);
  ASSERT_EQ(found.size(), 3U);
  for (int index = 0; index < 3; ++index) {
    EXPECT_FLOAT_EQ(found[index]->T, 0.25F * static_cast<float>(index + 1));
  }
}

/// A camera that was recalibrated during the recording and publishes camera_info rarely.
TEST_F(BagProcessingTest, CalibrationsOfTheFutureDoNotCount) {
  writeRecording(input_, 0, [](rosbag::Bag& bag) {
    for (int index = 0; index < 10; ++index) {
      PairMessages messages = recordedFrame(index);
      const ros::Time time = messages.left_image->header.stamp;
      bag.write("/stereo/left/image_rect", time, messages.left_image);
      bag.write("/stereo/right/image_rect", time, messages.right_image);
      if (index == 2 || index == 6) {
        messages.right_info->P[3] *= index;
        bag.write("/stereo/left/camera_info", time, messages.left_info);
        bag.write("/stereo/right/camera_info", time, messages.right_info);
      }
    }
  });
  const BagProcessingSummary summary = process(options_);
  EXPECT_EQ(summary.plan.infos_of_other_stamps, 8U);
  const auto found = disparities(output_);
  ASSERT_EQ(found.size(), 10U);
  for (int index = 0; index < 10; ++index) {
    EXPECT_FLOAT_EQ(found[index]->T, 0.25F * (index < 6 ? 2.0F : 6.0F)) << index;
  }
}

TEST_F(BagProcessingTest, WarningsOfTheCalibrationAreInTheSummary) {
  writeRecording(input_, 0, [](rosbag::Bag& bag) {
    PairMessages messages = recordedFrame(0);
    messages.right_info->P[3] *= 1000;  // mm
    writeFrame(bag, messages);
  });
  const BagProcessingSummary summary = process(options_);
  EXPECT_TRUE(summary.isComplete());
  EXPECT_TRUE(mentions(describeSummary(summary), {"warning", "baseline of 250 m", "mm"}));
  EXPECT_TRUE(mentions(summaryJson(summary), {"\"warnings\"", "baseline of 250 m"}));
}

TEST_F(BagProcessingTest, RowsThatAreApartAreInTheSummary) {
  writeRecording(input_, 0, [](rosbag::Bag& bag) {
    const RenderedScene scene = renderScene(320, 240, 1);
    const StereoPair pair{
        scene.left.rowRange(0, 230).clone(), scene.right.rowRange(3, 233).clone(), {}};
    writeFrame(bag, makeMessages(pair, Rig{}, ros::Time(100)));
  });
  options_.matching.stereo.range = {0, 48};
  EXPECT_TRUE(mentions(describeSummary(process(options_)),
                       {"warning", "px, expected at most 1.00 px", "--rectified no"}));
}

TEST_F(BagProcessingTest, AnOutputThatIsAnInputIsRejected) {
  writeRecording(input_, 1);
  const std::string content = contentOf(input_);
  fs::create_symlink(input_, folder_.file("link.bag"));
  fs::create_hard_link(input_, folder_.file("hard.bag"));
  fs::create_directory(folder_.file("sub"));
  options_.earlier = EarlierParts::kOverwrite;
  writeRecording(folder_.file("other.bag"), 1);
  options_.inputs = {folder_.file("other.bag"), input_};
  for (const std::string name : {"in.bag", "./in.bag", "sub/../in.bag", "link.bag", "hard.bag"}) {
    options_.output = folder_.file(name);
    EXPECT_TRUE(
        mentions(errorText([&] { process(options_); }), {"would overwrite the input", "in.bag"}))
        << name;
  }
  options_.inputs = {folder_.file("out.bag.part.0-3")};
  options_.output = folder_.file("out.bag");
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"would overwrite the input"}));
  EXPECT_EQ(contentOf(input_), content);
}

TEST_F(BagProcessingTest, FrameIdsMayDifferUnlessThatIsRejected) {
  writeRecording(input_, 1, [](rosbag::Bag& bag) {
    PairMessages messages = recordedFrame(1);
    messages.right_image->header.frame_id = "right_camera";
    writeFrame(bag, messages);
  });
  EXPECT_TRUE(process(options_).isComplete());
  ASSERT_EQ(disparities(output_).size(), 2U);
  EXPECT_EQ(disparities(output_)[1]->header.frame_id, "left_camera");

  options_.matching.allow_different_frame_ids = false;
  options_.output = folder_.file("rejected.bag");
  EXPECT_FALSE(process(options_).isComplete());
  EXPECT_EQ(disparities(options_.output).size(), 1U);
}

TEST_F(BagProcessingTest, ProcessesWhatIsReadableOfATruncatedBag) {
  writeRecording(input_, 6);
  fs::resize_file(input_, fs::file_size(input_) * 6 / 10);
  const BagProcessingSummary summary = process(options_);
  EXPECT_GE(summary.processed, 2U);
  EXPECT_LT(summary.processed, 6U);
  EXPECT_FALSE(summary.isComplete());
  EXPECT_TRUE(mentions(describeSummary(summary), {"in.bag", "rosbag reindex"}));
  EXPECT_EQ(bytesOf(*disparities(output_).at(1)), disparityLive(recordedFrame(1)));
}

TEST_F(BagProcessingTest, StopsAndResumesWithTheSameContent) {
  writeRecording(input_, 8);
  process(options_);
  options_.output = folder_.file("resumed.bag");
  int asked = 0;
  BagProcessingEvents events;
  events.should_stop = [&] { return ++asked > 5; };
  const BagProcessingSummary stopped = processBags(options_, forest_, events);
  EXPECT_TRUE(stopped.interrupted);
  EXPECT_EQ(stopped.processed, 5U);
  EXPECT_FALSE(fs::exists(options_.output));

  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"resumed.bag", "--resume"}));
  options_.earlier = EarlierParts::kResume;
  options_.matching.stereo.sgm.p2 += 1;
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }),
                       {"started with other input or options", "--overwrite"}));
  options_.matching.stereo.sgm.p2 -= 1;
  const BagProcessingSummary resumed = process(options_);
  EXPECT_EQ(resumed.resumed, 5U);
  EXPECT_EQ(resumed.processed, 3U);
  EXPECT_TRUE(resumed.isComplete());
  EXPECT_TRUE(messagesOf(output_) == messagesOf(options_.output));
  EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(output_).parent_path()), {}), 3)
      << "parts are left";
  EXPECT_TRUE(process(options_).was_complete);
}

/// The offset comes from a frame that was processed before the run was stopped, or that is skipped.
TEST_F(BagProcessingTest, VerticalOffsetDoesNotDependOnWhereProcessingBegins) {
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  for (int index = 0; index < 6; ++index) {
    StereoPair pair = renderPair({320, 240}, 5, 11, static_cast<std::uint64_t>(index) + 1);
    const int rows = 2 + index % 2;  // the first pair of a second determines the offset
    pair.right = pair.right(cv::Rect(0, rows, 320, 236)).clone();
    pair.left = pair.left(cv::Rect(0, 0, 320, 236)).clone();
    writeFrame(bag, makeMessages(pair, Rig{}, ros::Time(100 + 0.3 * index)));
  }
  bag.close();
  process(options_);
  const std::string whole = output_;
  for (const int frames : {1, 2, 5}) {
    options_.output = folder_.file("stopped" + std::to_string(frames) + ".bag");
    options_.earlier = EarlierParts::kReject;
    int asked = 0;
    BagProcessingEvents events;
    events.should_stop = [&] { return ++asked > frames; };
    EXPECT_TRUE(processBags(options_, forest_, events).interrupted);
    options_.earlier = EarlierParts::kResume;
    process(options_);
    EXPECT_TRUE(messagesOf(options_.output) == messagesOf(whole)) << frames;
  }
  const Content all = messagesOf(whole);
  for (const double start_s : {0.2, 0.5, 1.0}) {
    options_.output = folder_.file("begins" + std::to_string(start_s) + ".bag");
    options_.earlier = EarlierParts::kReject;
    options_.plan.start_s = start_s;
    process(options_);
    const Content late = messagesOf(options_.output);
    ASSERT_FALSE(late.empty());
    EXPECT_TRUE(std::equal(late.rbegin(), late.rend(), all.rbegin())) << start_s;
  }
  options_.output = folder_.file("some.bag");
  options_.plan.start_s = 0.2;
  options_.plan.every = 2;
  process(options_);
  const Content some = messagesOf(options_.output);
  ASSERT_EQ(some.size(), 3U);
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_TRUE(some[i] == all[1 + 2 * i]) << i;
  }
  options_.plan = {};
  options_.output = folder_.file("each.bag");
  options_.earlier = EarlierParts::kReject;
  options_.matching.stereo.rectification.interval_s = 0;
  process(options_);
  EXPECT_FALSE(messagesOf(options_.output) == messagesOf(whole)) << "nothing depends on offsets";
}

TEST_F(BagProcessingTest, RejectsToReplaceABag) {
  writeRecording(input_, 1);
  std::ofstream(output_) << "precious";
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"out.bag exists", "--overwrite"}));
  options_.output = folder_.file("none/out.bag");
  EXPECT_TRUE(mentions(errorText([&] { process(options_); }), {"folder does not exist"}));
}

TEST_F(BagProcessingTest, SummaryIsJsonWithTheCounts) {
  writeRecording(input_, 2);
  EXPECT_TRUE(mentions(summaryJson(process(options_)),
                       {"\"frames_processed\": 2", "\"complete\": true", "\"frames_failed\": 0"}));
}

TEST(Segments, KeepAllFramesOfAFullDisk) {
  const TemporaryFolder folder;
  const std::string output = folder.file("out.bag");
  std_msgs::String word;
  std::uint64_t free_bytes = std::uint64_t{1} << 30;
  {
    Segments segments(output, "origin", EarlierParts::kReject,
                      [&](const std::string&) { return free_bytes; });
    for (int frame = 0; frame < 4; ++frame) {
      segments.write({toRawMessage(word, "/words")}, ros::Time(1 + frame));
    }
    free_bytes = 1000;
    EXPECT_TRUE(
        mentions(errorText([&] { segments.write({toRawMessage(word, "/words")}, ros::Time(9)); }),
                 {"out.bag", "full", "4 frames are kept", "--resume"}));
    EXPECT_TRUE(mentions(errorText([&] { Segments(output, "origin", EarlierParts::kResume); }),
                         {"another process"}));
  }
  const Segments resumed(output, "origin", EarlierParts::kResume);
  ASSERT_EQ(resumed.framesDone(), 4U);
  EXPECT_EQ(messagesOf(resumed.paths().at(0)).size(), 4U);
}

}  // namespace
}  // namespace cbmv
