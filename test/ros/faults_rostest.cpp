// Run by faults.test: invalid messages. The node must name the cause and process the next good pair
// correctly.

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "ros/fault_fixture.h"
#include "ros/rostest_main.h"

namespace cbmv {
namespace {

const std::string kLeft = "/left/image_rect";
const std::string kRight = "/right/image_rect";
const std::string kLeftInfo = "/left/camera_info";
const std::string kRightInfo = "/right/camera_info";
const std::string kUnchangedData = " has 2623 bytes of data";  // 61 x 43 pixels

using MessageFaults = FaultTest;

TEST_F(MessageFaults, SizesThatAreNone) {
  expectRejected([](PairMessages& m) { m.left_image->width = 0; }, kLeft + " has an empty image");
  expectRejected([](PairMessages& m) { m.right_image->height = 0; },
                 kRight + " has an empty image");
  expectRejected(
      [](PairMessages& m) {
        for (const auto& image : {m.left_image, m.right_image}) {
          image->width = image->height = image->step = 0;
          image->data.clear();
        }
      },
      "0 x 0 px");
}

TEST_F(MessageFaults, SizesThatAreNotThere) {
  const std::uint32_t huge = std::numeric_limits<std::uint32_t>::max();
  expectRejected([&](PairMessages& m) { m.left_image->width = huge; }, kLeft + " has a step of");
  expectRejected([&](PairMessages& m) { m.left_image->height = huge; }, kLeft + kUnchangedData);
  expectRejected([&](PairMessages& m) { m.left_image->step = huge; }, kLeft + kUnchangedData);
  expectRejected(
      [&](PairMessages& m) {
        for (const auto& image : {m.left_image, m.right_image}) {
          image->width = image->height = image->step = huge;
        }
      },
      kLeft + kUnchangedData);
  expectRejected([](PairMessages& m) { m.right_image->height *= 2; }, kRight + kUnchangedData);
}

TEST_F(MessageFaults, TooLittleDataAndWrongSteps) {
  expectRejected([](PairMessages& m) { m.left_image->data.clear(); },
                 kLeft + " has 0 bytes of data");
  expectRejected([](PairMessages& m) { m.right_image->data.pop_back(); },
                 kRight + " has 2622 bytes of data");
  expectRejected([](PairMessages& m) { m.right_image->data.push_back(0); },
                 kRight + " has 2624 bytes of data");
  expectRejected([](PairMessages& m) { --m.left_image->step; }, kLeft + " has a step of 60");
  expectRejected([](PairMessages& m) { ++m.left_image->step; }, kLeft + kUnchangedData);
  expectRejected([](PairMessages& m) { m.right_image->step = 0; }, kRight + " has a step of 0");
}

TEST_F(MessageFaults, UnknownEncodings) {
  const std::vector<std::string> encodings = {"",
                                              "mono9",
                                              "MONO8",
                                              "8UC0",
                                              "8UC-1",
                                              "8UC513",
                                              "8UC99999999999",
                                              "64FC1",
                                              "32FC1",
                                              "16SC1",
                                              "yuv422 ",
                                              "bayer",
                                              std::string("mono8\0", 6),
                                              "\xff\xfe",
                                              std::string(100000, 'x')};
  for (const std::string& encoding : encodings) {
    PairMessages messages = goodPair();
    messages.right_image->encoding = encoding;
    shared->client.cameras.publish(messages);
    expectDiagnostic("Calibration", Level::ERROR, kRight + " has ");
    expectRightAgain();
  }
}

/// Every known encoding, set for mono8 data. Any result is acceptable, but no crash.
TEST_F(MessageFaults, EncodingsThatDoNotFit) {
  for (const char* encoding : {"bgr8", "rgba8", "mono16", "bgr16", "bayer_rggb8", "bayer_gbrg16",
                               "yuv422", "8UC1", "16UC1", "8UC3", "32FC1", "64FC4"}) {
    SCOPED_TRACE(encoding);
    for (const std::uint32_t factor : {1U, 2U, 3U, 8U}) {
      PairMessages messages = goodPair();
      for (const auto& image : {messages.left_image, messages.right_image}) {
        image->encoding = encoding;
        image->width = std::max(1U, image->width / factor);
      }
      shared->client.cameras.publish(messages);
    }
    expectRightAgain();
  }
}

/// 16-bit values in the wrong byte order are valid gray values, so the error cannot be detected.
TEST_F(MessageFaults, WrongByteOrder) {
  const PairMessages eight = goodPair();
  for (const int order : {0, 1, 2, 255}) {
    PairMessages messages = goodPair();
    for (const auto& image : {messages.left_image, messages.right_image}) {
      image->is_bigendian = static_cast<std::uint8_t>(order);
    }
    const auto of_bytes = disparityOf(messages);
    ASSERT_TRUE(of_bytes);
    expectSame(*of_bytes);  // a byte has no byte order
    cv::Mat deep;
    shared->pair.left.convertTo(deep, CV_16U, 257);
    messages = goodPair();
    messages.left_image = makeImage(deep, "mono16", messages.left_image->header);
    messages.left_image->is_bigendian = static_cast<std::uint8_t>(order);
    EXPECT_TRUE(disparityOf(messages));
    expectRightAgain();
  }
}

TEST_F(MessageFaults, NumbersInCameraInfoThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {nan, infinity, -infinity, 1e300, -1e300}) {
    for (const int entry : {0, 2, 3, 5, 6, 10, 11}) {
      PairMessages messages = goodPair();
      (entry % 2 == 0 ? messages.left_info : messages.right_info)->P.at(entry) = value;
      const ros::Time stamp = messages.left_image->header.stamp;
      shared->client.cameras.publish(messages);
      expectRightAgain();  // it is from a later pair, so this one was not published
      EXPECT_FALSE(shared->client.disparity.has(stamp));
    }
    PairMessages messages = goodPair();
    messages.right_info->P.at(11) = value;
    shared->client.cameras.publish(messages);
    expectDiagnostic("Calibration", Level::ERROR, "has no usable projection matrix (P[11]");
  }
  for (const double value : {0.0, -1.0, 1e-300}) {
    expectRejected([&](PairMessages& m) { m.left_info->P[0] = value; },
                   kLeftInfo + " has no usable");
    expectRejected([&](PairMessages& m) { m.right_info->P[5] = value; },
                   kRightInfo + " has no usable");
    expectRejected([&](PairMessages& m) { m.right_info->P[3] = -value; },
                   kRightInfo + (value < 0 ? " have a negative baseline" : " have no baseline"));
  }
}

TEST_F(MessageFaults, NumbersThatNobodyReads) {
  PairMessages messages = goodPair();
  for (const auto& info : {messages.left_info, messages.right_info}) {
    info->K.assign(std::numeric_limits<double>::quiet_NaN());
    info->R.assign(std::numeric_limits<double>::infinity());
    info->D.assign(100000, -std::numeric_limits<double>::infinity());
    info->distortion_model = "none\n";
  }
  const auto disparity = disparityOf(messages);
  ASSERT_TRUE(disparity);
  expectSame(*disparity);
}

TEST_F(MessageFaults, SizesBinningAndRegionsThatDoNotFit) {
  const std::uint32_t huge = std::numeric_limits<std::uint32_t>::max();
  const std::string describes = kLeftInfo + " describes images of ";
  expectRejected([](PairMessages& m) { m.left_info->width = 0; }, describes + "0 x 43");
  expectRejected([&](PairMessages& m) { m.left_info->width = huge; },
                 describes + "2147483647 x 43");
  expectRejected([](PairMessages& m) { m.left_info->binning_x = 2; }, describes + "30 x 43");
  expectRejected([&](PairMessages& m) { m.left_info->binning_y = huge; }, describes + "61 x 0");
  expectRejected([](PairMessages& m) { m.left_info->roi.width = m.left_info->roi.height = 8; },
                 describes + "8 x 8");
  expectRejected([&](PairMessages& m) { m.left_info->roi.width = m.left_info->roi.height = huge; },
                 describes + "2147483647 x 2147483647");
}

TEST_F(MessageFaults, SizesChangeInMidStream) {
  for (int i = 0; i < 40; ++i) {
    cv::RNG random(static_cast<std::uint64_t>(i));
    const cv::Size size(random.uniform(1, 200), random.uniform(1, 150));
    const StereoPair pair = renderPair(size, 2, 5);
    const PairMessages messages = makeMessages(pair, {}, ros::Time::now());
    const auto disparity = disparityOf(messages);
    ASSERT_TRUE(disparity) << size;
    EXPECT_EQ(disparity->image.width, static_cast<unsigned>(size.width));
    EXPECT_EQ(disparity->image.height, static_cast<unsigned>(size.height));
    expectRightAgain();
  }
  expectRejected(
      [](PairMessages& m) {
        m.right_image =
            makeMessages(renderPair({60, 43}, 2, 5), {}, m.right_image->header.stamp).right_image;
      },
      "have different sizes (61 x 43 px and 60 x 43 px)");
}

TEST_F(MessageFaults, EncodingAndCalibrationChangeInMidStream) {
  for (int i = 0; i < 5; ++i) {
    PairMessages messages = goodPair();
    for (const auto& image : {messages.left_image, messages.right_image}) {
      cv::Mat color;
      cv::cvtColor(i % 2 == 0 ? shared->pair.left : shared->pair.right, color, cv::COLOR_GRAY2BGR);
      *image = *makeImage(color, "bgr8", image->header);
    }
    EXPECT_TRUE(disparityOf(messages));
    Rig rig;
    rig.focal_length_px = 100 + i;
    rig.baseline_m = 0.1 + 0.1 * i;
    rig.cx_right_px += i;
    const auto disparity = disparityOf(makeMessages(shared->pair, rig, ros::Time::now()));
    ASSERT_TRUE(disparity);
    EXPECT_EQ(disparity->f, static_cast<float>(rig.focal_length_px));
    EXPECT_EQ(disparity->T, static_cast<float>(rig.baseline_m));
    EXPECT_EQ(disparity->min_disparity, static_cast<float>(i));
    expectRightAgain();
  }
}

/// Every byte of the image description and of P can have any value.
TEST_F(MessageFaults, RandomFieldsDoNoHarm) {
  cv::RNG random(7);
  const auto spoil = [&random](auto& value) {
    cv::Mat bytes(1, sizeof(value), CV_8UC1, &value);
    if (random.uniform(0, 4) == 0) {
      random.fill(bytes, cv::RNG::UNIFORM, 0, 256);
    }
  };
  for (int i = 0; i < 300; ++i) {
    PairMessages messages = goodPair();
    for (const auto& image : {messages.left_image, messages.right_image}) {
      spoil(image->width);
      spoil(image->height);
      spoil(image->step);
      image->data.resize(static_cast<std::size_t>(random.uniform(0, 5000)));
    }
    for (const auto& info : {messages.left_info, messages.right_info}) {
      spoil(info->width);
      spoil(info->binning_x);
      spoil(info->roi);
      spoil(info->P[static_cast<std::size_t>(random.uniform(0, 12))]);
    }
    shared->client.cameras.publish(messages);
    wait(0.002);
  }
  expectRightAgain();
  expectDiagnostic("Output", Level::WARN, "frames dropped in the last 10 s: ");
}

TEST_F(MessageFaults, ImagesThatTheMachineHasNoMemoryFor) {
  StereoOptions options = testOptions();
  options.range.count = 4096;
  options.search.levels = 0;
  shared->client.setOptions(options);
  const cv::Mat large(4000, 8192, CV_8UC1, cv::Scalar(7));  // matching them needs 670 GB
  shared->client.cameras.publish(makeMessages({large, large, {}}, {}, ros::Time::now()));
  expectDiagnostic("Calibration", Level::ERROR, "but the machine has");
  shared->client.setOptions(testOptions());
  expectRightAgain();
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
