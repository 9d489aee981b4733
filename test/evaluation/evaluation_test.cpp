#include "evaluation/evaluation.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/image_file.h"
#include "io/pfm.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

using Names = std::vector<std::string>;

/// Three scenes of 8x4 pixels with true disparity 1, and the events of their evaluation.
class Evaluation : public testing::Test {
 protected:
  Evaluation() {
    for (const char* name : {"Piano", "Shelves", "Teddy"}) {
      const std::string base = folder_.file(name) + "/";
      std::filesystem::create_directory(base);
      writeImage(base + "im0.png", cv::Mat::zeros(4, 8, CV_8UC1));
      writeImage(base + "im1.png", cv::Mat::zeros(4, 8, CV_8UC1));
      writePfm(base + "disp0GT.pfm", cv::Mat::ones(4, 8, CV_32FC1));
      writeMiddleburyCalibration(base + "calib.txt", {500, 4, 4, 2, 0.1, 8, 4, 4});
    }
    events_.progress = [this](const std::string& line) { progress_.push_back(line); };
    events_.failure = [this](const std::string& line) { failures_.push_back(line); };
    events_.maps = [this](const StereoScene& scene, const SceneMaps&) {
      mapped_.push_back(scene.name);
    };
    events_.scored = [this](const EvaluationReport& report) {
      sizes_.push_back(report.scenes.size());
    };
  }

  int evaluate(EvaluationReport& report) {
    const DataSet data_set = DataSet::open("middlebury_v3:" + folder_.file(""), truth_);
    const DisparitySource perfect = [this](const StereoScene& scene) {
      matched_.push_back(scene.name);
      SceneMaps maps;
      maps.disparity = cv::Mat(scene.left.size(), CV_32FC1, cv::Scalar(1.0 + offset_));
      return maps;
    };
    return evaluateScenes(data_set, {"Teddy", "Shelves", "Piano"}, perfect, events_, report);
  }

  const TemporaryFolder folder_;
  EvaluationEvents events_;
  Truth truth_ = Truth::kRequired;
  double offset_ = 0.0;  ///< error of all disparities, px
  Names progress_, failures_, matched_, mapped_;
  std::vector<std::size_t> sizes_;
};

TEST_F(Evaluation, ScoresAllScenesWithTheirWeights) {
  EvaluationReport report;
  EXPECT_EQ(evaluate(report), 0);
  ASSERT_EQ(report.scenes.size(), 3U);
  EXPECT_EQ(report.scenes[0].scene, "Piano");
  EXPECT_EQ(report.find("Teddy")->weight, 1.0);
  EXPECT_EQ(report.find("Shelves")->weight, 0.5);
  EXPECT_EQ(report.find("Teddy")->noc[0], 0.0);
  EXPECT_EQ(matched_, (Names{"Teddy", "Shelves", "Piano"}));
  EXPECT_EQ(mapped_, matched_);
  EXPECT_EQ(sizes_, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(progress_[0], "Teddy: bad 1 0.00 % of the non-occluded, 0.00 % of all pixels");
}

TEST_F(Evaluation, ScoresByTheReportsScoring) {
  EvaluationReport report;
  report.scoring.scale = 3.0;
  offset_ = 1.0;
  EXPECT_EQ(evaluate(report), 0);
  EXPECT_EQ(report.find("Teddy")->noc[6], 3.0);  // average error, px
}

TEST_F(Evaluation, NamesBadScenesAndGoesOn) {
  std::filesystem::remove(folder_.file("Shelves/im1.png"));
  EvaluationReport report;
  EXPECT_EQ(evaluate(report), 1);
  EXPECT_EQ(matched_, (Names{"Teddy", "Piano"}));
  EXPECT_EQ(report.scenes.size(), 2U);
  ASSERT_EQ(failures_.size(), 1U);
  EXPECT_TRUE(mentions(failures_[0], {"scene Shelves", folder_.file("Shelves/im1.png")}));
}

TEST_F(Evaluation, MatchesScenesWithoutTruthButDoesNotScoreThem) {
  std::filesystem::remove(folder_.file("Shelves/disp0GT.pfm"));
  truth_ = Truth::kOptional;
  EvaluationReport report;
  report.fingerprint = "same";
  EXPECT_EQ(evaluate(report), 0);
  EXPECT_EQ(report.scenes.size(), 2U);
  EXPECT_EQ(report.unscored, std::set<std::string>{"Shelves"});
  EXPECT_EQ(mapped_, (Names{"Teddy", "Shelves", "Piano"}));
  EXPECT_EQ(progress_[1], "Shelves: matched, not scored as it has no ground truth");
  matched_.clear();
  EvaluationReport resumed;
  resumed.fingerprint = "same";
  const DataSet data_set = DataSet::open("middlebury_v3:" + folder_.file(""));
  EXPECT_EQ(resumeReport(report, data_set, {"Teddy", "Shelves"}, resumed), 2);
  EXPECT_EQ(evaluate(resumed), 0);
  EXPECT_EQ(matched_, Names{"Piano"});
}

TEST_F(Evaluation, LeavesAloneWhatIsScoredAlready) {
  EvaluationReport earlier;
  earlier.fingerprint = "same";
  EXPECT_EQ(evaluate(earlier), 0);
  earlier.scenes.erase(earlier.scenes.begin());  // Piano
  earlier.scenes[0].noc[0] = 77.0;               // Shelves
  earlier.scenes[0].weight = 1.0;
  matched_.clear();
  const DataSet data_set = DataSet::open("middlebury_v3:" + folder_.file(""));
  EvaluationReport report;
  report.fingerprint = "same";
  EXPECT_EQ(resumeReport(earlier, data_set, {"Piano", "Shelves"}, report), 1);
  EXPECT_EQ(evaluate(report), 0);
  EXPECT_EQ(matched_, (Names{"Teddy", "Piano"}));
  EXPECT_EQ(report.find("Shelves")->noc[0], 77.0);
  EXPECT_EQ(report.find("Shelves")->weight, 0.5);
  EvaluationReport scaled;
  scaled.fingerprint = "same";
  scaled.scoring.scale = 2.0;
  EXPECT_EQ(resumeReport(earlier, data_set, {"Teddy"}, scaled), -1);
  EvaluationReport other;
  other.fingerprint = "other";
  EXPECT_EQ(resumeReport(earlier, data_set, {"Teddy"}, other), -1);
  EXPECT_TRUE(other.scenes.empty());
}

}  // namespace
}  // namespace cbmv
