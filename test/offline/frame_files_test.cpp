#include "offline/frame_files.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/camera_yaml.h"
#include "io/pfm.h"
#include "recording.h"
#include "support/error_text.h"
#include "support/file_content.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

using Row = std::vector<std::string>;

/// Fields without quotes. In these tests only the last one, the failure, contains commas.
std::vector<Row> readIndex(const std::string& path) {
  std::ifstream file(path);
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream text(line);
    Row row;
    for (std::string field; std::getline(text, field, ',');) {
      row.push_back(field);
    }
    rows.push_back(row);
  }
  return rows;
}

/// All files of a folder with their content.
std::map<std::string, std::string> filesIn(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    if (file.is_regular_file()) {
      files[fs::relative(file.path(), folder).string()] = contentOf(file.path().string());
    }
  }
  return files;
}

class FrameFilesTest : public testing::Test {
 protected:
  FrameFilesTest() {
    bag_.outputs = folder_options_.outputs = fixtureOutputs();
    folder_options_.files = DisparityFormat::kPfm;
    for (BagProcessingOptions* options :
         {&bag_, &folder_options_}) {  // some pixels have no disparity
      options->matching.stereo.refinement.fill_occlusions = false;
      options->matching.stereo.refinement.fill_mismatches = false;
    }
  }
  /// Four frames; the third fails.
  void writeInput() {
    PairMessages bad = recordedFrame(2, {80, 64});
    bad.right_image = recordedFrame(2).right_image;
    writeRecording(input_, 2, [&](rosbag::Bag& bag) {
      writeFrame(bag, bad);
      writeFrame(bag, recordedFrame(3));
    });
  }
  BagProcessingSummary process(const BagProcessingOptions& options,
                               const BagProcessingEvents& events = {}) {
    return processBags(options, fixtureForest(), events);
  }
  template <typename Message>
  std::vector<boost::shared_ptr<Message>> messages(const std::string& output) {
    return readTopic<Message>(bag_.output, "/stereo/" + output);
  }
  /// Files of an output in frame order, without failed frames.
  std::vector<std::string> files(const std::string& output) {
    const std::vector<Row> rows = readIndex(folder_options_.output + "/index.csv");
    const auto column = static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), output) -
                                                 rows[0].begin());
    std::vector<std::string> paths;
    for (std::size_t row = 1; row < rows.size(); ++row) {
      if (!rows[row].at(column).empty()) {
        paths.push_back(folder_options_.output + "/" + rows[row][column]);
      }
    }
    return paths;
  }
  template <typename Message, typename Compare>
  void compare(const std::string& output, const Compare& compare_one) {
    const std::vector<boost::shared_ptr<Message>> expected = messages<Message>(output);
    const std::vector<std::string> paths = files(output);
    ASSERT_EQ(paths.size(), 3U) << output;
    ASSERT_EQ(expected.size(), 3U) << output;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      SCOPED_TRACE(paths[i]);
      compare_one(paths[i], *expected[i]);
    }
  }

  TemporaryFolder folder_;
  std::string input_ = folder_.file("in.bag");
  BagProcessingOptions bag_ = processingOf(input_, folder_.file("out.bag"));
  BagProcessingOptions folder_options_ = processingOf(input_, folder_.file("out"));
};

template <typename Value>
cv::Mat_<Value> pixels(const sensor_msgs::Image& image) {
  cv::Mat_<Value> copy(static_cast<int>(image.height), static_cast<int>(image.width));
  CV_Assert(image.data.size() == copy.total() * copy.elemSize());
  std::memcpy(copy.data, image.data.data(), image.data.size());
  return copy;
}

/// Compares bits, including NaN.
template <typename Value>
void expectSame(const cv::Mat& found, const cv::Mat_<Value>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_EQ(found.type(), expected.type());
  EXPECT_EQ(std::memcmp(found.data, expected.data, expected.total() * expected.elemSize()), 0);
}

TEST_F(FrameFilesTest, HoldWhatTheMessagesOfABagHold) {
  writeInput();
  process(bag_);
  EXPECT_EQ(process(folder_options_).failed, 1U);

  compare<stereo_msgs::DisparityImage>("disparity", [](const auto& path, const auto& message) {
    cv::Mat_<float> expected = pixels<float>(message.image);
    for (float& value : expected) {
      value = value < message.min_disparity ? std::numeric_limits<float>::infinity() : value;
    }
    EXPECT_LT(cv::countNonZero(expected < 1e6F), static_cast<int>(expected.total()));
    expectSame(readPfm(path), expected);
  });
  for (const char* output : {"depth", "confidence"}) {
    compare<sensor_msgs::Image>(output, [](const auto& path, const auto& message) {
      expectSame(readPfm(path), pixels<float>(message));
    });
  }
  compare<sensor_msgs::Image>("depth_raw", [](const auto& path, const auto& message) {
    expectSame(cv::imread(path, cv::IMREAD_UNCHANGED), pixels<std::uint16_t>(message));
  });
  compare<sensor_msgs::Image>("valid_mask", [](const auto& path, const auto& message) {
    expectSame(cv::imread(path, cv::IMREAD_UNCHANGED), pixels<std::uint8_t>(message));
  });
  compare<sensor_msgs::Image>("disparity_color", [](const auto& path, const auto& message) {
    cv::Mat rgb;
    cv::cvtColor(cv::imread(path), rgb, cv::COLOR_BGR2RGB);
    expectSame(rgb, pixels<cv::Vec3b>(message));
  });
  compare<sensor_msgs::CameraInfo>("camera_info", [](const auto& path, const auto& message) {
    const CameraCalibration camera = readCameraYaml(path);
    EXPECT_EQ(camera.name, "left_camera");
    EXPECT_EQ(camera.width, static_cast<int>(message.width));
    EXPECT_EQ(camera.height, static_cast<int>(message.height));
    EXPECT_EQ(camera.distortion, message.D);
    EXPECT_TRUE(std::equal(message.P.begin(), message.P.end(), camera.projection.begin()));
    EXPECT_TRUE(std::equal(message.K.begin(), message.K.end(), camera.camera_matrix.begin()));
  });
}

TEST_F(FrameFilesTest, CloudsHoldThePointsThatThereAre) {
  writeInput();
  bag_.outputs = folder_options_.outputs = {"cloud"};
  process(bag_);
  process(folder_options_);
  compare<sensor_msgs::PointCloud2>("points2", [&](const auto& path, const auto& message) {
    const std::vector<ColoredPoint> points = fromPointCloud(message);
    ASSERT_GT(points.size(), 100U);
    ASSERT_LT(points.size(), static_cast<std::size_t>(message.width) * message.height);
    writePly(folder_.file("expected.ply"), points);
    EXPECT_EQ(contentOf(path), contentOf(folder_.file("expected.ply")));
  });
}

TEST_F(FrameFilesTest, IndexNamesFramesAndFailures) {
  writeInput();
  folder_options_.outputs = {"disparity", "confidence"};
  process(folder_options_);
  const std::vector<Row> rows = readIndex(folder_options_.output + "/index.csv");
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(rows[0], (Row{"frame", "stamp", "frame_id", "disparity", "confidence", "failure"}));
  EXPECT_EQ(rows[2],
            (Row{"1", "100.100000000", "\"left_camera\"", "disparity/00000001_100.100000000.pfm",
                 "confidence/00000001_100.100000000.pfm"}));
  ASSERT_GE(rows[3].size(), 6U);
  EXPECT_EQ(rows[3][1], "100.200000000");
  EXPECT_EQ(rows[3][3], "");
  EXPECT_TRUE(mentions(rows[3][5], {"different sizes"}));
  EXPECT_EQ(rows[4][0], "3");
  EXPECT_EQ(filesIn(folder_options_.output).size(), 7U) << "something is left";
}

TEST_F(FrameFilesTest, DisparitiesForKitti) {
  writeInput();
  bag_.outputs = folder_options_.outputs = {"disparity"};
  folder_options_.files = DisparityFormat::kKitti;
  process(bag_);
  process(folder_options_);
  compare<stereo_msgs::DisparityImage>("disparity", [](const auto& path, const auto& message) {
    const cv::Mat_<float> published = pixels<float>(message.image);
    const cv::Mat_<std::uint16_t> found = cv::imread(path, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(found.size(), published.size());
    for (int y = 0; y < found.rows; ++y) {
      for (int x = 0; x < found.cols; ++x) {
        const float value = published(y, x);
        const double expected =
            value < message.min_disparity ? 0 : std::max(1.0, std::round(256.0 * value));
        ASSERT_EQ(found(y, x), expected) << x << " " << y;
      }
    }
  });
}

TEST_F(FrameFilesTest, StopsAndResumesWithTheSameContent) {
  writeInput();
  process(folder_options_);
  const auto whole = filesIn(folder_options_.output);
  for (const int frames : {1, 3}) {
    folder_options_.output = folder_.file("stopped" + std::to_string(frames));
    folder_options_.earlier = EarlierParts::kReject;
    int asked = 0;
    BagProcessingEvents events;
    events.should_stop = [&] { return ++asked > frames; };
    EXPECT_TRUE(process(folder_options_, events).interrupted);
    EXPECT_FALSE(fs::exists(folder_options_.output + "/index.csv"));
    EXPECT_TRUE(mentions(errorText([&] { process(folder_options_); }), {"--resume"}));
    folder_options_.earlier = EarlierParts::kResume;
    const BagProcessingSummary resumed = process(folder_options_);
    EXPECT_EQ(resumed.resumed, static_cast<std::size_t>(frames));
    EXPECT_EQ(resumed.failed, 1U);
    EXPECT_TRUE(filesIn(folder_options_.output) == whole);
    EXPECT_TRUE(process(folder_options_).was_complete);
  }
}

TEST_F(FrameFilesTest, BeginningAnewLeavesNothingOfBefore) {
  writeInput();
  folder_options_.outputs = {"disparity"};
  process(folder_options_);
  const std::string note = folder_options_.output + "/disparity/note.txt";
  std::ofstream(note) << "mine";
  EXPECT_TRUE(
      mentions(errorText([&] { process(folder_options_); }), {"index.csv exists", "--overwrite"}));
  folder_options_.earlier = EarlierParts::kOverwrite;
  folder_options_.files = DisparityFormat::kKitti;
  folder_options_.plan.every = 2;
  process(folder_options_);
  EXPECT_TRUE(fs::exists(note));
  EXPECT_EQ(filesIn(folder_options_.output).size(),
            3U);  // includes the index; the other frame failed
}

TEST_F(FrameFilesTest, RejectsWithOneLine) {
  writeInput();
  folder_options_.copy = true;
  EXPECT_TRUE(mentions(errorText([&] { process(folder_options_); }), {"--copy"}));
  folder_options_.copy = false;
  folder_options_.compression = "lz4";
  EXPECT_TRUE(mentions(errorText([&] { process(folder_options_); }), {"--compression"}));
  folder_options_.compression = "none";
  folder_.write("file", "");
  folder_options_.output = folder_.file("file");
  EXPECT_TRUE(mentions(errorText([&] { process(folder_options_); }), {"folder", "file"}));
  EXPECT_EQ(filesIn(fs::path(input_).parent_path().string()).size(), 2U);
}

}  // namespace
}  // namespace cbmv
