// cbmv_eval and the program that creates its page, run as by a user.

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/json_report.h"
#include "evaluation/rendered_scene.h"
#include "io/pfm.h"
#include "support/file_content.h"
#include "support/rendered_data_set.h"
#include "support/run_tool.h"
#include "support/temporary_folder.h"

namespace cbmv::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const std::string kForest = CBMV_SOURCE_DIR "/models/middlebury.forest";

/// Number of occurrences of the pattern.
long count(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  return std::distance(std::sregex_iterator(text.begin(), text.end(), expression), {});
}

/// Two rendered scenes, One and Two, in testQ/.
class EvalTest : public testing::Test {
 protected:
  EvalTest() {
    writeScene(path("testQ/One"), renderScene(120, 60, 1));
    writeScene(path("testQ/Two"), renderScene(120, 60, 2));
  }

  std::string path(const std::string& name) const { return folder_.file(name); }

  Outcome evaluate(const std::string& arguments, const std::string& environment = "") const {
    return run(
        "cbmv_eval",
        "--dataset middlebury_v3:" + path("testQ") + " --forest " + kForest + " " + arguments,
        environment);
  }

  /// Expects one line for scene Two with the file name, and a final line; One is scored.
  void expectOnlyOne(const std::string& file, const std::string& what) const {
    expectRejection(evaluate("--json " + path("r.json")),
                    {"scene Two failed", path(file), what, "1 of 2 scenes failed"}, 2);
    const EvaluationReport report = readJsonReport(path("r.json"));
    ASSERT_EQ(report.scenes.size(), 1U);
    EXPECT_EQ(report.scenes[0].scene, "One");
  }

  TemporaryFolder folder_;
};

TEST_F(EvalTest, ReportIsAPageThatNeedsNoOtherFile) {
  fs::rename(path("testQ/Two"), path("testQ/Two & <b>"));
  const Outcome outcome = evaluate("--report \"" + path("a page's; folder") + "\"");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const std::string page = contentOf(path("a page's; folder/index.html"));
  EXPECT_THAT(page, HasSubstr("<h3>One<"));
  EXPECT_THAT(page, HasSubstr("<h3>Two &amp; &lt;b&gt;<"));
  EXPECT_THAT(page, HasSubstr("middlebury.forest"));
  EXPECT_EQ(count(page, "<td>One</td>"), 2);  // noc and all pixels
  EXPECT_EQ(count(page, "<img [^>]*src=\"data:image/jpeg;base64,"), 2 * 5);
  EXPECT_EQ(count(page, "<svg"),
            1 + 1 + 2 + 2);  // means, reliability, two bar charts, one per scene
  EXPECT_EQ(count(page, "<td>min_confidence 0\\.[3579]</td>"), 4);
  EXPECT_EQ(count(page, "most confident [0-9]"), 0);  // not requested
  EXPECT_EQ(count(page, "Standard deviation"), 1);
  EXPECT_EQ(count(page, "src=\"(?!data:)"), 0);
  EXPECT_EQ(count(page, "href=\"(?!#)"), 0);
  EXPECT_EQ(count(page, "url\\((?!#)"), 0);
  EXPECT_EQ(count(page, "@import|<link|<iframe"), 0);
}

TEST_F(EvalTest, ReportOfReadyMapsHasNoSparsification) {
  fs::create_directory(path("maps"));
  for (const char* scene : {"One", "Two"}) {
    fs::copy_file(path(std::string("testQ/") + scene + "/disp0GT.pfm"),
                  path(std::string("maps/") + scene + ".pfm"));
  }
  const Outcome outcome =
      run("cbmv_eval", "--dataset middlebury_v3:" + path("testQ") + " --disparities " +
                           path("maps") + " --report " + path("page"));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const std::string page = contentOf(path("page/index.html"));
  EXPECT_THAT(page, HasSubstr("ready disparity maps"));
  EXPECT_EQ(count(page, "most confident pixels kept"), 0);
  EXPECT_EQ(count(page, "<img "), 2 * 4);  // without confidence
}

/// The true disparities plus 0.45 px, with confidence 1 and a sigma of 0.4 px.
TEST_F(EvalTest, ReadyMapsHaveOperatingPointsAndSigma) {
  for (const char* scene : {"One", "Two"}) {
    const cv::Mat truth = readPfm(path(std::string("testQ/") + scene + "/disp0GT.pfm"));
    const std::string base = path(std::string("maps/") + scene);
    fs::create_directories(path("maps"));
    writePfm(base + ".pfm", truth + 0.45F);
    writePfm(base + "_confidence.pfm", cv::Mat::ones(truth.size(), CV_32FC1));
    writePfm(base + "_sigma.pfm", cv::Mat(truth.size(), CV_32FC1, cv::Scalar(0.4)));
  }
  const Outcome outcome = run(
      "cbmv_eval", "--dataset middlebury_v3:" + path("testQ") + " --disparities " + path("maps") +
                       " --density 80 --error-scale 4 --json " + path("r.json") + " --markdown " +
                       path("r.md") + " --maps " + path("page/maps") + " --report " + path("page"));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const EvaluationReport report = readJsonReport(path("r.json"));
  EXPECT_EQ(report.scoring.scale, 4.0);
  EXPECT_EQ(report.find("One")->noc[1], 100.0);  // bad 1, of 0.45 px at scale 4
  EXPECT_EQ(report.find("One")->noc[2], 0.0);    // bad 2
  EXPECT_EQ(report.find("One")->noc[13], 0.0);   // ece: 0.45 px of the images is correct
  EXPECT_EQ(report.find("One")->noc[15], 0.0);   // sigma_1
  EXPECT_EQ(report.find("One")->noc[16], 100.0);
  EXPECT_THAT(contentOf(path("r.md")), HasSubstr("correct up to 4 px"));
  EXPECT_THAT(contentOf(path("r.md")), HasSubstr("most confident 80 %, one threshold"));
  const std::string page = contentOf(path("page/index.html"));
  EXPECT_EQ(count(page, "<td>most confident 80 %, (one threshold|a threshold per scene)</td>"), 2);
  EXPECT_THAT(page, HasSubstr("Standard deviation of disparities"));
  EXPECT_THAT(page, HasSubstr("off by more than 4 px"));
}

TEST_F(EvalTest, FoldsCanBeTrainedOnAnotherFolder) {
  fs::rename(path("testQ"), path("oldQ"));
  fs::create_directory(path("testQ"));
  fs::rename(path("oldQ/One"), path("testQ/Teddy"));  // a scene of the first fold
  writeScene(path("trainQ/Piano"), renderScene(120, 60, 3));
  writeScene(path("trainQ/Teddy"), renderScene(120, 60, 4));
  const std::string data = "--dataset middlebury_v3:" + path("testQ") + " ";
  const std::string training = " --train-dataset middlebury_v3:" + path("trainQ") +
                               " --trees 4 --depth 3 --pixels-per-scene 500";
  const Outcome outcome = run("cbmv_eval", data + "--folds 3 --json " + path("r.json") + training);
  ASSERT_EQ(outcome.status, 0) << outcome.output;  // testQ has no scene of another fold
  EXPECT_EQ(readJsonReport(path("r.json")).scenes.size(), 1U);
  expectRejection(run("cbmv_eval", data + "--forest " + kForest + training), {"--train-dataset"},
                  2);
  writeScene(path("two_view/Piano"), renderScene(120, 60, 3));
  expectRejection(run("cbmv_eval", data + "--folds 3 --train-dataset eth3d:" + path("two_view")),
                  {"eth3d", "expected middlebury_v3"});
}

TEST_F(EvalTest, WithoutMatplotlibAllButThePageIsThere) {
  fs::create_directory(path("python"));
  std::ofstream(path("python/matplotlib.py")) << "raise ImportError('none here')\n";
  expectRejection(evaluate("--report " + path("page"), "PYTHONPATH=" + path("python")),
                  {"The page cannot be written", "python3-matplotlib"});
  EXPECT_FALSE(fs::exists(path("page/index.html")));
  EXPECT_EQ(readJsonReport(path("page/report.json")).scenes.size(), 2U);
  EXPECT_TRUE(fs::exists(path("page/maps/Two_error.jpg")));
}

TEST_F(EvalTest, ThePageProgramRejectsOtherFiles) {
  const auto rejects = [&](const std::string& json, const std::string& what) {
    std::ofstream(path("r.json")) << json;
    expectRejection(run("cbmv_evaluation_report", path("r.json") + " --output " + path("p.html")),
                    {path("r.json"), what});
  };
  rejects("", "not a JSON report");
  rejects("[]", "not a JSON report");
  rejects("{\"scenes\": [{\"scene\": \"One\"}]}", "not a JSON report");
  rejects("{\"forest\": null, \"scenes\": [], \"mean\": null, \"weighted_mean\": null}",
          "no scene");
  expectRejection(run("cbmv_evaluation_report", path("none.json") + " --output " + path("p.html")),
                  {path("none.json"), "No such file"});
  EvaluationReport report;
  report.scenes.resize(1);
  report.scenes[0].scene = "One";
  report.scenes[0].curves.sparsification = {1, 2, 3};
  writeJsonReport(report, path("r.json"));
  expectRejection(run("cbmv_evaluation_report", path("r.json") + " --output " + path("p.html")),
                  {path("r.json"), "not a JSON report"});
  report.scenes[0].curves = {};
  writeJsonReport(report, path("r.json"));
  expectRejection(run("cbmv_evaluation_report",
                      path("r.json") + " --maps " + path("testQ") + " --output " + path("p.html")),
                  {path("testQ"), "picture of One"});
  expectRejection(
      run("cbmv_evaluation_report", path("r.json") + " --output " + path("none/p.html")),
      {path("none/p.html"), "No such file"});
  EXPECT_FALSE(fs::exists(path("p.html")));
}

TEST_F(EvalTest, SubmissionHasTheScenesWithoutTruthToo) {
  fs::remove(path("testQ/Two/disp0GT.pfm"));
  const std::string arguments = "--json " + path("r.json") + " --submission " + path("upload");
  const Outcome outcome = evaluate(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const EvaluationReport report = readJsonReport(path("r.json"));
  EXPECT_EQ(report.scenes.size(), 1U);
  EXPECT_EQ(report.unscored, std::set<std::string>{"Two"});
  for (const std::string scene : {"One", "Two"}) {
    const std::string base = path("upload/testQ/" + scene);
    EXPECT_EQ(readPfm(base + "/disp0CBMV.pfm").size(), cv::Size(120, 60));
    double seconds = 0.0;
    std::ifstream(base + "/timeCBMV.txt") >> seconds;
    EXPECT_GT(seconds, 0.0);
  }
  fs::remove(path("upload/testQ/Two/disp0CBMV.pfm"));  // is then written again
  const auto one = fs::last_write_time(path("upload/testQ/One/disp0CBMV.pfm"));
  ASSERT_EQ(evaluate(arguments + " --resume").status, 0);
  EXPECT_TRUE(fs::exists(path("upload/testQ/Two/disp0CBMV.pfm")));
  EXPECT_EQ(fs::last_write_time(path("upload/testQ/One/disp0CBMV.pfm")), one);
}

TEST_F(EvalTest, TestScenesAloneHaveAnUploadButNoPage) {
  fs::remove(path("testQ/One/disp0GT.pfm"));
  fs::remove(path("testQ/Two/disp0GT.pfm"));
  expectRejection(evaluate("--json " + path("r.json")),
                  {"scene One failed", "Two/disp0GT.pfm", "2 of 2"}, 3);
  const Outcome outcome = evaluate("--submission " + path("upload") + " --report " + path("page"));
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(fs::exists(path("upload/testQ/Two/disp0CBMV.pfm")));
  EXPECT_FALSE(fs::exists(path("page/index.html")));
}

TEST_F(EvalTest, NamesTheSceneThatIsWrongAndGoesOn) {
  const std::string truth = contentOf(path("testQ/Two/disp0GT.pfm"));
  fs::resize_file(path("testQ/Two/disp0GT.pfm"), 1000);
  expectOnlyOne("testQ/Two/disp0GT.pfm", "1000 bytes");
  writePfm(path("testQ/Two/disp0GT.pfm"), cv::Mat::ones(60, 119, CV_32FC1));
  expectOnlyOne("testQ/Two/disp0GT.pfm", "119x60");
  fs::remove(path("testQ/Two/disp0GT.pfm"));
  expectOnlyOne("testQ/Two/disp0GT.pfm", "no such file");
  std::ofstream(path("testQ/Two/disp0GT.pfm"), std::ios::binary) << truth;
  fs::rename(path("testQ/Two/im1.png"), path("im1.png"));
  expectOnlyOne("testQ/Two/im1.png", "no such file");
  fs::rename(path("im1.png"), path("testQ/Two/im1.png"));
  writeMiddleburyCalibration(path("testQ/Two/calib.txt"), {200, 0, 0, 0, 0.1, 120, 60, 121});
  expectOnlyOne("testQ/Two/calib.txt", "ndisp is 121");
}

TEST_F(EvalTest, ResumesWhatWasCutOff) {
  fs::resize_file(path("testQ/Two/disp0GT.pfm"), 1000);
  expectRejection(evaluate("--report " + path("page")), {"scene Two", "1 of 2"}, 2);
  EXPECT_THAT(contentOf(path("page/index.html")), HasSubstr("<h3>One<"));
  const auto one = fs::last_write_time(path("page/maps/One.pfm"));
  writeScene(path("testQ/Two"), renderScene(120, 60, 2));
  const Outcome outcome =
      evaluate("--resume --json " + path("page/report.json") + " --maps " + path("page/maps"));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_EQ(fs::last_write_time(path("page/maps/One.pfm")), one);
  EXPECT_TRUE(fs::exists(path("page/maps/Two.pfm")));
  EXPECT_EQ(readJsonReport(path("page/report.json")).scenes.size(), 2U);
}

TEST_F(EvalTest, ResumesTheSameDataSetOnly) {
  ASSERT_EQ(evaluate("--report " + path("page")).status, 0);
  const auto one = fs::last_write_time(path("page/maps/One.pfm"));
  const auto resume = [&](const std::string& folder) {
    const Outcome outcome =
        run("cbmv_eval", "--dataset middlebury_v3:" + folder + " --forest " + kForest +
                             " --resume --json " + path("page/report.json") + " --maps " +
                             path("page/maps"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
  };
  resume(path("testQ/../testQ/."));
  EXPECT_EQ(fs::last_write_time(path("page/maps/One.pfm")), one);
  const EvaluationReport first = readJsonReport(path("page/report.json"));
  writeScene(path("otherQ/One"), renderScene(120, 60, 3));
  writeScene(path("otherQ/Two"), renderScene(120, 60, 4));
  resume(path("otherQ"));
  EXPECT_NE(fs::last_write_time(path("page/maps/One.pfm")), one);
  const EvaluationReport other = readJsonReport(path("page/report.json"));
  ASSERT_EQ(other.scenes.size(), 2U);
  EXPECT_NE(other.scenes[0].noc, first.scenes[0].noc);
  EXPECT_NE(other.scenes[1].noc, first.scenes[1].noc);
  EXPECT_THAT(contentOf(path("page/report.json")), Not(HasSubstr("otherQ")));
}

TEST_F(EvalTest, ReportsOfOlderVersionsAreNotResumed) {
  std::ofstream(path("r.json")) << R"({"forest": null, "preset": null, "fingerprint": "01234567",
                                       "scenes": [], "mean": null, "weighted_mean": null})";
  expectRejection(evaluate("--resume --json " + path("r.json")),
                  {path("r.json"), "version 1", "without --resume"});
  EXPECT_EQ(evaluate("--json " + path("r.json")).status, 0);
}

TEST_F(EvalTest, RejectsBeforeItStarts) {
  for (const char* percent : {"0", "101", "x"}) {
    expectRejection(evaluate(std::string("--density ") + percent), {"--density", "up to 100"}, 2);
  }
  expectRejection(evaluate("--error-scale 0"), {"--error-scale", "above 0"}, 2);
  expectRejection(evaluate("--resume"), {"--resume needs --json or --report"});
  fs::rename(path("testQ"), path("renamed"));
  const std::string rest = path("renamed") + " --forest " + kForest + " --submission " + path("u");
  expectRejection(run("cbmv_eval", "--dataset middlebury_v3:" + rest), {"renamed", "Q, H or F"});
  expectRejection(run("cbmv_eval", "--dataset middlebury_2005:" + rest), {"has no scene"});
  std::ofstream(path("file")) << "no folder\n";
  expectRejection(run("cbmv_eval", "--dataset eth3d:" + rest + " --report " + path("file")),
                  {path("file")});
}

}  // namespace
}  // namespace cbmv::test
