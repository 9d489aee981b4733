// The command-line programs, run as by a user: their output files and their error messages.

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/disparity_error.h"
#include "evaluation/rendered_scene.h"
#include "forest/forest_file.h"
#include "io/camera_yaml.h"
#include "io/image_file.h"
#include "io/pfm.h"
#include "io/ply.h"
#include "search/range_finder.h"
#include "support/file_content.h"
#include "support/rendered_data_set.h"
#include "support/run_tool.h"
#include "support/temporary_folder.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv::test {
namespace {

const std::string kForest = CBMV_SOURCE_DIR "/models/middlebury.forest";

/// A folder with a rendered pair: left.png and right.png; text.png is not an image.
class ToolsTest : public testing::Test {
 protected:
  ToolsTest() : scene_(renderScene(160, 100, 1)) {
    writeImage(path("left.png"), scene_.left);
    writeImage(path("right.png"), scene_.right);
    std::ofstream(path("text.png")) << "not an image\n";
  }

  std::string path(const std::string& name) const { return folder_.file(name); }

  TemporaryFolder folder_;
  RenderedScene scene_;
};

TEST_F(ToolsTest, MatchWritesDisparityAndConfidence) {
  const Outcome outcome =
      run("cbmv_match", path("left.png") + " " + path("right.png") + " --forest " + kForest +
                            " --disparities 32 --output " + path("out/deep"));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const cv::Mat disparity = readPfm(path("out/deep/disparity.pfm"));
  EXPECT_LT(evaluateDisparity(disparity, scene_.truth, scene_.visible, -1).bad_1, 4.0);
  for (const char* name : {"out/deep/disparity.png", "out/deep/confidence.png"}) {
    EXPECT_EQ(readColorImage(path(name)).size(), scene_.left.size());
  }
}

/// The range from the command line, a preset, and a calibration without range.
TEST_F(ToolsTest, MatchFindsTheRange) {
  std::ofstream(path("calib.txt")) << "cam0=[200 0 80; 0 200 50; 0 0 1]\n"
                                      "cam1=[200 0 80; 0 200 50; 0 0 1]\n"
                                      "doffs=0\nbaseline=100\nwidth=160\nheight=100\nndisp=160\n";
  const std::string preset = folder_.write("auto.yaml", "disparity_range: 0\n");
  const std::string pair = path("left.png") + " " + path("right.png") + " --forest " + kForest +
                           " --output " + path("out") + " ";
  const auto found = RangeFinder().find(scene_.left, scene_.right, 0);
  ASSERT_TRUE(found);
  ASSERT_NE(found->count, StereoOptions().range.count);
  ASSERT_EQ(run("cbmv_match", pair + "--disparities " + std::to_string(found->count)).status, 0);
  const std::string expected = contentOf(path("out/disparity.pfm"));
  for (const std::string& how : {std::string("--disparities auto"), "--preset " + preset,
                                 "--calibration " + path("calib.txt")}) {
    const Outcome outcome = run("cbmv_match", pair + how);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_TRUE(contentOf(path("out/disparity.pfm")) == expected) << how;
  }
}

TEST_F(ToolsTest, MatchNamesTheFileThatIsWrong) {
  const std::string rest = " --forest " + kForest + " --output " + path("out");
  const std::string left = path("left.png");
  expectRejection(run("cbmv_match", path("text.png") + " " + left + rest), {path("text.png")});
  expectRejection(run("cbmv_match", left + " " + path("none.png") + rest), {path("none.png")});
  writeImage(path("small.png"), scene_.right.colRange(0, 50));
  expectRejection(run("cbmv_match", left + " " + path("small.png") + rest),
                  {path("small.png"), "size"});
  expectRejection(run("cbmv_match", left + " " + left + " --forest " + path("text.png") +
                                        " --output " + path("out")),
                  {path("text.png"), "not a forest"});
}

TEST_F(ToolsTest, MatchRejectsWhatNeedsTooMuchMemory) {
  const std::string preset = folder_.write("small.yaml", "max_memory_mb: 2\n");
  expectRejection(
      run("cbmv_match", path("left.png") + " " + path("right.png") + " --forest " + kForest +
                            " --preset " + preset + " --output " + path("out")),
      {"64 disparities need", "MB", "max_memory_mb allows 2"});
}

TEST_F(ToolsTest, MatchWarnsOfRowsThatAreApart) {
  const RenderedScene scene = renderScene(320, 240, 1);
  const auto rowsFrom = [](const cv::Mat& image, int first) {
    return image.rowRange(first, first + 230).clone();
  };
  writeImage(path("high.png"), rowsFrom(scene.left, 0));
  writeImage(path("aligned.png"), rowsFrom(scene.right, 0));
  writeImage(path("low.png"), rowsFrom(scene.right, 3));
  const std::string rest = " --forest " + kForest + " --preset realtime --output " + path("out");
  EXPECT_EQ(run("cbmv_match", path("high.png") + " " + path("aligned.png") + rest).output, "");
  const Outcome outcome = run("cbmv_match", path("high.png") + " " + path("low.png") + rest);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output, testing::HasSubstr("px (RMS), expected at most 1.00 px"));
  EXPECT_THAT(outcome.output, testing::HasSubstr(path("low.png")));
}

TEST_F(ToolsTest, MatchOptionsWinOverThePreset) {
  const std::string preset = folder_.write("wide.yaml", "max_memory_mb: 2\ndisparity_range: 99\n");
  const std::string pair = path("left.png") + " " + path("right.png") + " --forest " + kForest +
                           " --output " + path("out") + " --preset " + preset;
  expectRejection(run("cbmv_match", pair + " --disparities 24"),
                  {"24 disparities need", "allows 2"});
  expectRejection(run("cbmv_match", pair + " --max-memory-mb 3"),
                  {"99 disparities need", "allows 3"});
  EXPECT_EQ(run("cbmv_match", pair + " --disparities 24 --max-memory-mb 0").status, 0);
}

/// The image is shifted to the left by the amount by which the disparities are lower.
TEST_F(ToolsTest, MatchFindsNegativeDisparities) {
  const int shift = 20;
  writeImage(path("moved.png"), scene_.right.colRange(0, 160 - shift));
  writeImage(path("cut.png"), scene_.left.colRange(shift, 160));
  const Outcome outcome =
      run("cbmv_match", path("cut.png") + " " + path("moved.png") + " --forest " + kForest +
                            " --disparities 32 --min-disparity -20 --output " + path("out"));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  // Points farther to the right are outside the right image.
  const cv::Range seen(shift, 160 - shift);
  const cv::Mat truth = scene_.truth.colRange(seen) - shift;
  const cv::Mat disparity = readPfm(path("out/disparity.pfm")).colRange(0, truth.cols);
  EXPECT_LT(evaluateDisparity(disparity, truth, scene_.visible.colRange(seen), -21).bad_1, 4.0);
}

/// The vertices of a binary PLY file from writePly.
std::vector<ColoredPoint> readPly(const std::string& path) {
  const std::string content = contentOf(path);
  const std::string end = "end_header\n";
  const std::size_t begin = content.find(end) + end.size();
  std::vector<ColoredPoint> points((content.size() - begin) / 15);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::memcpy(&points[i], content.data() + begin + 15 * i, 15);
  }
  return points;
}

TEST_F(ToolsTest, MatchWritesDepthAndCloudOfACalibratedPair) {
  const std::string pair = path("left.png") + " " + path("right.png") + " --forest " + kForest +
                           " --disparities 32 --output ";
  const StereoCalibration rig{200, 80, 83, 50, 0.1, 160, 100, 32};
  writeMiddleburyCalibration(path("calib.txt"), rig);
  ASSERT_EQ(run("cbmv_match", pair + path("out") + " --calibration " + path("calib.txt")).status,
            0);
  const cv::Mat disparity = readPfm(path("out/disparity.pfm"));
  const cv::Mat depth = readPfm(path("out/depth.pfm"));
  const std::vector<ColoredPoint> points = readPly(path("out/cloud.ply"));
  EXPECT_NEAR(depth.at<float>(50, 90), 20 / (disparity.at<float>(50, 90) + 3), 1e-4);
  ASSERT_EQ(points.size(), depth.total());  // all pixels are filled
  EXPECT_NEAR(points[50 * 160 + 90].x, 10 * depth.at<float>(50, 90) / 200, 1e-5);

  CameraCalibration camera;
  camera.name = "left";
  camera.width = 160;
  camera.height = 100;
  camera.distortion_model = "plumb_bob";
  camera.projection = {200, 0, 80, 0, 0, 200, 50, 0, 0, 0, 1, 0};
  writeCameraYaml(path("left.yaml"), camera);
  camera.projection[2] = 83;
  camera.projection[3] = -20;
  writeCameraYaml(path("right.yaml"), camera);
  ASSERT_EQ(run("cbmv_match", pair + path("ros") + " --calibration " + path("left.yaml") +
                                  " --right-calibration " + path("right.yaml"))
                .status,
            0);
  EXPECT_EQ(contentOf(path("ros/cloud.ply")), contentOf(path("out/cloud.ply")));
}

TEST_F(ToolsTest, MatchSaysWhatIsWrongWithTheCalibration) {
  const std::string rest = path("left.png") + " " + path("right.png") + " --forest " + kForest +
                           " --output " + path("out") + " --calibration ";
  expectRejection(run("cbmv_match", rest + path("none.txt")), {path("none.txt"), "no such file"});
  expectRejection(run("cbmv_match", rest + path("text.png")), {path("text.png"), "cam0"});
  CameraCalibration camera;
  camera.width = 160;
  camera.height = 100;
  writeCameraYaml(path("left.yaml"), camera);
  expectRejection(run("cbmv_match", rest + path("left.yaml")), {"left.yaml", "right camera"});
  writeMiddleburyCalibration(path("calib.txt"), {200, 80, 83, 50, 0.1, 320, 200, 32});
  expectRejection(run("cbmv_match", rest + path("calib.txt")),
                  {path("calib.txt"), "320 x 200 px", path("left.png"), "160 x 100 px"});
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(ToolsTest, MatchTakesTheRangeOfTheCalibration) {
  writeMiddleburyCalibration(path("calib.txt"), {200, 80, 83, 50, 0.1, 160, 100, 17});
  const std::string rest = path("left.png") + " " + path("right.png") + " --forest " + kForest +
                           " --calibration " + path("calib.txt") + " --output ";
  ASSERT_EQ(run("cbmv_match", rest + path("told")).status, 0);
  ASSERT_EQ(run("cbmv_match", rest + path("asked") + " --disparities 17").status, 0);
  ASSERT_EQ(run("cbmv_match", rest + path("other") + " --disparities 30").status, 0);
  const std::string told = contentOf(path("told/disparity.pfm"));
  EXPECT_TRUE(told == contentOf(path("asked/disparity.pfm")));
  EXPECT_FALSE(told == contentOf(path("other/disparity.pfm")));
}

TEST_F(ToolsTest, WrongArgumentsGiveStatusTwo) {
  EXPECT_EQ(run("cbmv_match", "").status, 2);
  EXPECT_EQ(run("cbmv_match", "--no-such-option").status, 2);
  EXPECT_EQ(run("cbmv_train", "").status, 2);
  EXPECT_EQ(run("cbmv_match", "--help").status, 0);
  EXPECT_EQ(run("cbmv_train", "--help").status, 0);
}

TEST_F(ToolsTest, TrainWritesAForestThatWorks) {
  writeScene(path("data/One"), scene_);
  writeScene(path("data/Two"), renderScene(160, 100, 2));
  const Outcome trained =
      run("cbmv_train", "--dataset middlebury_v3:" + path("data") +
                            " --exclude Two --trees 8 --depth 4 --pixels-per-scene 3000 --output " +
                            path("new.forest"));
  ASSERT_EQ(trained.status, 0) << trained.output;
  const Forest forest = readForest(path("new.forest"));
  EXPECT_EQ(forest.trees.size(), 8U);
  EXPECT_EQ(forest.provenance.scenes, std::vector<std::string>{"One"});
  EXPECT_LT(forest.provenance.held_out_log_loss, 0.35);
}

TEST_F(ToolsTest, TrainGrowsARandomForestAndExportsItsSamples) {
  writeScene(path("data/One"), scene_);
  const Outcome trained =
      run("cbmv_train", "--dataset middlebury_v3:" + path("data") +
                            " --kind random-forest --trees 5 "
                            "--samples-per-leaf 50 --pixels-per-scene 1000 "
                            "--export-samples " +
                            path("samples.csv") + " --output " + path("new.forest"));
  ASSERT_EQ(trained.status, 0) << trained.output;
  const Forest forest = readForest(path("new.forest"));
  EXPECT_EQ(forest.general_trees.size(), 5U);
  EXPECT_LT(forest.provenance.held_out_log_loss, 0.35);
  std::ifstream samples(path("samples.csv"));
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(samples), {}, '\n'),
            forest.provenance.samples + 1);
  EXPECT_EQ(run("cbmv_train", "--kind dense --output " + path("new.forest")).status, 2);
}

TEST_F(ToolsTest, TrainRejectsBeforeItStarts) {
  writeScene(path("data/One"), scene_);
  const std::string rest = " --output " + path("new.forest");
  const std::string data = "--dataset middlebury_v3:" + path("data");
  expectRejection(run("cbmv_train", "--dataset other:" + path("data") + rest), {"middlebury_v3"});
  expectRejection(run("cbmv_train", "--dataset middlebury_v3:" + path("none") + rest),
                  {path("none")});
  expectRejection(run("cbmv_train", data + " --scenes Three" + rest), {"Three"});
  expectRejection(run("cbmv_train", data + " --exclude One" + rest), {path("data")});
  std::filesystem::resize_file(path("data/One/disp0GT.pfm"), 100);
  expectRejection(run("cbmv_train", data + rest), {path("data/One/disp0GT.pfm")});
  EXPECT_FALSE(std::filesystem::exists(path("new.forest")));
}

/// Outputs are checked first: the error is about the output although the data set does not exist
/// either.
TEST_F(ToolsTest, OutputsAreCheckedBeforeTheWorkBegins) {
  const std::string data = "--dataset middlebury_v3:" + path("no_data");
  const std::string place = path("none/output");
  const std::string forest = " --forest " + kForest;
  expectRejection(run("cbmv_train", data + " --output " + place), {place, "there is no folder"});
  expectRejection(run("cbmv_train", data + " --output a --export-samples " + place), {place});
  expectRejection(run("cbmv_tune", data + forest + " --output " + place), {place});
  for (const char* option : {"json", "csv", "markdown"}) {
    expectRejection(run("cbmv_eval", data + forest + " --" + option + " " + place), {place});
  }
  for (const char* option : {"maps", "report", "submission"}) {
    const std::string folder = path("text.png/folder");
    expectRejection(run("cbmv_eval", data + forest + " --" + option + " " + folder),
                    {folder, path("text.png") + " is not a folder"});
  }
}

/// An output must not overwrite an input forest, whatever path is used for it.
TEST_F(ToolsTest, NoOutputIsAnInput) {
  writeScene(path("data/One"), scene_);
  const std::string data = "--dataset middlebury_v3:" + path("data");
  const std::string forest = path("my.forest");
  const std::string preset = path("my.yaml");
  std::filesystem::copy_file(kForest, forest);
  std::ofstream(preset) << "disparity_range: 32\n";
  std::ofstream(path("list.txt")) << "left.png right.png data/One/disp0GT.pfm 1\n";
  std::filesystem::create_hard_link(forest, path("link"));
  const std::string list = "--dataset list:" + path("list.txt");
  const std::string with_forest = " --forest " + forest;
  const std::string lost = "would overwrite the input";
  for (const char* option : {"json", "csv", "markdown"}) {
    expectRejection(run("cbmv_eval", data + with_forest + " --" + option + " " + path("link")),
                    {path("link"), forest, lost});
  }
  expectRejection(run("cbmv_eval", data + with_forest + " --preset " + preset + " --csv " + preset),
                  {preset, lost});
  expectRejection(run("cbmv_eval", list + with_forest + " --json " + path("list.txt")), {lost});
  expectRejection(run("cbmv_train", list + " --output " + path("list.txt")), {lost});
  expectRejection(run("cbmv_tune", data + with_forest + " --output " + forest), {forest, lost});
  expectRejection(
      run("cbmv_tune", data + with_forest + " --start " + preset + " --output " + preset),
      {preset, lost});
  std::filesystem::copy_file(path("left.png"), path("disparity.png"));
  expectRejection(run("cbmv_match", path("disparity.png") + " " + path("right.png") + with_forest +
                                        " --output " + path("")),
                  {"disparity.png", lost});
  EXPECT_EQ(contentOf(forest), contentOf(kForest));
}

TEST_F(ToolsTest, TellTheBoundsOfNumbers) {
  const std::string match = "left right --forest f --output o ";
  const std::string tune = "--dataset d --forest f --output o ";
  for (const auto& [tool, arguments, message] : std::vector<std::array<std::string, 3>>{
           {"cbmv_match", match + "--disparities none",
            "--disparities: is \"none\", expected auto or a whole number from 1 to 4096"},
           {"cbmv_match", match + "--threads 1.5",
            "\"1.5\", expected a whole number from 0 to 1024"},
           {"cbmv_tune", tune + "--evaluations 0", "is \"0\", expected a whole number from 1 to 1"},
           {"cbmv_tune", tune + "--rows many", "--rows: is \"many\", expected a whole number"},
           {"cbmv_eval", "--dataset d --forest f --threads -1", "from 0 to 1024"},
           {"cbmv_train", "--dataset d --output o --max-samples 0", "a whole number from 1 to"}}) {
    const Outcome outcome = run(tool, arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.output, testing::HasSubstr(message));
    EXPECT_LT(outcome.output.size(), 200U);
  }
}

TEST_F(ToolsTest, TellTheirVersion) {
  for (const std::string tool : {"cbmv_match", "cbmv_eval", "cbmv_train", "cbmv_tune"}) {
    EXPECT_EQ(run(tool, "--version").status, 0);
    run(tool, "--version | tee " + path("version"));
    EXPECT_THAT(contentOf(path("version")), testing::MatchesRegex(tool + " [0-9]+[.0-9]+\n"));
  }
}

TEST_F(ToolsTest, KnowPresetsAndForestsByName) {
  writeScene(path("data/One"), scene_);
  const std::string data = "--dataset middlebury_v3:" + path("data");
  EXPECT_EQ(run("cbmv_eval",
                data + " --forest middlebury_small --preset realtime --csv " + path("report.csv"))
                .status,
            0);
  const std::string pair = path("left.png") + " " + path("right.png") + " --forest " + kForest;
  EXPECT_EQ(run("cbmv_match", pair + " --preset realtime --output " + path("out")).status, 0);
  expectRejection(run("cbmv_match", pair + " --preset fast --output " + path("out")),
                  {"unknown preset 'fast'", "balanced, ", "realtime", "path"});
  expectRejection(run("cbmv_eval", data + " --forest small"),
                  {"unknown forest 'small'", "middlebury_small", "path"});
  expectRejection(run("cbmv_tune", data + " --forest " + kForest + " --start fast --output " +
                                       path("tuned.yaml")),
                  {"unknown preset 'fast'"});
}

TEST_F(ToolsTest, TuneWritesAPreset) {
  writeScene(path("data/One"), scene_);
  const std::string rest = " --dataset middlebury_v3:" + path("data") + " --forest " + kForest +
                           " --parameters P1,P2 --evaluations 4 --output ";
  std::ofstream(path("start.yaml")) << "P1: 0.1\nbilateral_sigma: 1.5\n";
  const Outcome tuned =
      run("cbmv_tune", "--start " + path("start.yaml") + rest + path("tuned.yaml"));
  ASSERT_EQ(tuned.status, 0) << tuned.output;
  StereoOptions options;
  readPreset(path("tuned.yaml"), options);
  EXPECT_EQ(options.refinement.bilateral_sigma_px, 1.5F);
  expectRejection(run("cbmv_tune", rest + path("none/tuned.yaml")), {path("none")});
  expectRejection(run("cbmv_tune", "--start " + path("none.yaml") + rest + path("tuned.yaml")),
                  {path("none.yaml")});
  EXPECT_EQ(run("cbmv_tune", "").status, 2);
  EXPECT_EQ(run("cbmv_tune", "--help").status, 0);
}

}  // namespace
}  // namespace cbmv::test
