#include "evaluation/json_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support/error_text.h"
#include "support/evaluation_report.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

void expectSame(const MetricValues& a, const MetricValues& b) {
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    EXPECT_TRUE(a[m] == b[m] || (std::isnan(a[m]) && std::isnan(b[m]))) << kMetrics[m].name;
  }
}

TEST(JsonReport, ComesBackFromJson) {
  const TemporaryFolder folder;
  EvaluationReport report = makeReport();
  report.scenes[1].seconds = kNotMeasured;
  report.scenes[1].noc[11] = kNotMeasured;
  report.scoring = {3.0, 2.0};
  writeJsonReport(report, folder.file("r.json"));
  const EvaluationReport read = readJsonReport(folder.file("r.json"));
  EXPECT_EQ(read.forest, report.forest);
  EXPECT_EQ(read.preset, report.preset);
  EXPECT_EQ(read.fingerprint, report.fingerprint);
  EXPECT_TRUE(read.scoring == report.scoring);
  ASSERT_EQ(read.scenes.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(read.scenes[s].scene, report.scenes[s].scene);
    expectSame(read.scenes[s].noc, report.scenes[s].noc);
    expectSame(read.scenes[s].all, report.scenes[s].all);
    EXPECT_EQ(read.scenes[s].density, 99.5);
  }
  EXPECT_EQ(read.scenes[0].seconds, 1.25);
  EXPECT_EQ(read.scenes[0].ns_per_hypothesis, 40.0);
  EXPECT_TRUE(std::isnan(read.scenes[1].seconds));
  EXPECT_FALSE(std::filesystem::exists(folder.file("r.json.part")));
}

TEST(JsonReport, JsonHasTheAgreedEntries) {
  const TemporaryFolder folder;
  EvaluationReport report = makeReport();
  report.scenes[0].noc.fill(0.5);
  report.scenes[0].all.fill(1.5);
  report.scenes.pop_back();
  report.preset = "";
  writeJsonReport(report, folder.file("r.json"));
  std::string text = contentOf(folder.file("r.json"));
  text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == ' ' || c == '\n'; }),
             text.end());
  const auto metrics = [](const std::string& value) {
    std::string object;
    for (const char* name :
         {"bad_0.5", "bad_1", "bad_2", "bad_3", "bad_4", "d1", "avg", "rms", "a50", "a90", "a99",
          "auc", "auc_optimal", "ece", "brier", "sigma_1", "sigma_2", "sigma_rms"}) {
      object += (object.empty() ? "{\"" : ",\"") + std::string(name) + "\":" + value;
    }
    return object + "}";
  };
  const std::string pixels = "\"noc\":" + metrics("0.5") + ",\"all\":" + metrics("1.5");
  const std::string mean =  // without sums, so without pooled metrics
      "{" +
      std::regex_replace(pixels, std::regex("\"(ece|sigma_[a-z0-9]+)\":[0-9.]+"), "\"$1\":null") +
      "}";
  EXPECT_EQ(text,
            "{\"version\":3,\"forest\":\"my.forest\",\"preset\":null,\"fingerprint\":\"01234567\","
            "\"correct_px\":1.0,\"error_scale\":1.0,\"scenes\":[{\"scene\":\"Teddy\"," +
                pixels +
                ",\"density\":99.5,\"seconds\":1.25,\"ns_per_hypothesis\":40.0}],\"mean\":" + mean +
                ",\"weighted_mean\":" + mean + "}");
}

TEST(JsonReport, HasCurvesAndUnscoredScenesWhereThereAreSome) {
  const TemporaryFolder folder;
  EvaluationReport report = makeReport();
  report.unscored = {"Crusade"};
  report.scenes[0].curves.sparsification = std::vector<double>(21, 1.23449);
  report.scenes[0].curves.error_histogram = std::vector<double>(17, 2.5);
  writeJsonReport(report, folder.file("r.json"));
  EXPECT_TRUE(
      mentions(contentOf(folder.file("r.json")),
               {"\"axes\"", "\"kept_percent\"", "\"error_px\"", "\"unscored\"", " 1.234,"}));
  const EvaluationReport read = readJsonReport(folder.file("r.json"));
  EXPECT_EQ(read.scenes[0].curves.sparsification, std::vector<double>(21, 1.234));
  EXPECT_TRUE(read.scenes[0].curves.sparsification_optimal.empty());
  EXPECT_EQ(read.scenes[0].curves.error_histogram, report.scenes[0].curves.error_histogram);
  EXPECT_TRUE(read.scenes[1].curves.error_histogram.empty());
  EXPECT_EQ(read.unscored, report.unscored);
  EXPECT_TRUE(read.has("Crusade") && read.has("Teddy") && !read.has("Art"));
}

TEST(JsonReport, WithoutScenesHasNoMean) {
  const TemporaryFolder folder;
  writeJsonReport({}, folder.file("r.json"));
  EXPECT_TRUE(mentions(contentOf(folder.file("r.json")),
                       {"\"scenes\": []", "\"mean\": null", "\"weighted_mean\": null"}));
  EXPECT_TRUE(readJsonReport(folder.file("r.json")).scenes.empty());
}

TEST(JsonReport, IsWrittenThroughLinksAndIntoPipes) {
  const TemporaryFolder folder;
  const std::string target = folder.write("r.json", "old");
  std::filesystem::create_symlink(target, folder.file("link.json"));
  writeJsonReport(makeReport(), folder.file("link.json"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.json")));
  EXPECT_EQ(readJsonReport(target).scenes.size(), 2U);

  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDWR);  // so that writing does not block
  writeJsonReport({}, pipe);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  close(reader);
}

TEST(JsonReport, NamesTheFileThatIsWrong) {
  const TemporaryFolder folder;
  const char* const half_a_scene = R"({"version": 3, "forest": null, "preset": null,
                                       "fingerprint": null, "correct_px": 1, "error_scale": 1,
                                       "scenes": [{"scene": "A"}]})";
  for (const char* content : {"", "{", "[]", R"({"version": 3, "forest": 3})", half_a_scene}) {
    const std::string path = folder.write("r.json", content);
    EXPECT_TRUE(mentions(errorText([&] { readJsonReport(path); }), {path, "not a report"}));
  }
  const std::string deep = folder.write("r.json", std::string(65, '['));
  EXPECT_TRUE(mentions(errorText([&] { readJsonReport(deep); }), {deep, "64 nesting levels"}));
  std::filesystem::resize_file(deep, (64 << 20) + 1);
  EXPECT_TRUE(mentions(errorText([&] { readJsonReport(deep); }), {deep, "at most 67108864"}));
  const std::string absent = folder.file("no/r.json");
  EXPECT_TRUE(mentions(errorText([&] { readJsonReport(absent); }), {absent, "no such file"}));
  EXPECT_TRUE(mentions(errorText([&] { writeJsonReport({}, absent); }), {absent}));
  EXPECT_TRUE(mentions(errorText([&] { writeCsvReport({}, absent); }), {absent}));
  EXPECT_TRUE(mentions(errorText([&] { writeMarkdownReport({}, absent); }), {absent}));
}

TEST(JsonReport, SumsComeBackSoThatMeansAreTheSame) {
  const TemporaryFolder folder;
  EvaluationReport report = makeReport();
  for (SceneScore& score : report.scenes) {
    score.weight = 1.0;
    score.noc_sums.confidence = halfWrongProfile(4.0);
    score.all_sums.confidence = halfWrongProfile(40.0);
    score.all_sums.confidence.squared_error = 7.125;
    score.all_sums.sigma.pixels = 40.0;
    score.all_sums.sigma.addInliers(20.0, 0.5);
    score.all_sums.sigma.addInliers(10.0, 2.5);
  }
  writeJsonReport(report, folder.file("r.json"));
  const EvaluationReport read = readJsonReport(folder.file("r.json"));
  const PixelSums& sums = read.scenes[1].all_sums;
  EXPECT_EQ(sums.confidence.pixels, 40.0);
  EXPECT_EQ(sums.confidence.squared_error, 7.125);
  ASSERT_EQ(sums.confidence.bins.size(), kConfidenceBins);
  EXPECT_EQ(sums.confidence.bins[90].pixels, 20.0);
  EXPECT_EQ(sums.confidence.bins[90].confidence, 9.0);
  EXPECT_EQ(sums.confidence.bins[90].wrong, 20.0);
  EXPECT_EQ(sums.confidence.bins[90].bad_1, 20.0);
  EXPECT_EQ(sums.confidence.bins[90].bad_3, 0.0);
  EXPECT_EQ(sums.sigma.inliers, 30.0);
  EXPECT_EQ(sums.sigma.pixels, 40.0);
  EXPECT_EQ(sums.sigma.squared_sum, 67.5);
  EXPECT_EQ(sums.sigma.bins, report.scenes[1].all_sums.sigma.bins);
  EXPECT_EQ(read.scenes[1].noc_sums.sigma.inliers, 0.0);
  expectSame(meanScore(read.scenes, false).all, meanScore(report.scenes, false).all);
  expectSame(meanScore(read.scenes, false).noc, meanScore(report.scenes, false).noc);
}

TEST(JsonReport, MeansTellReliabilityAndOperatingPoints) {
  const TemporaryFolder folder;
  EvaluationReport report = makeReport();
  for (SceneScore& score : report.scenes) {
    score.noc_sums.confidence = score.all_sums.confidence = halfWrongProfile(40.0);
    score.all_sums.sigma.pixels = 40.0;
    score.all_sums.sigma.addInliers(6000.0, 1.0);
    score.all_sums.sigma.addInliers(4000.0, 4.0);
  }
  writeJsonReport(report, folder.file("r.json"));
  EXPECT_TRUE(
      mentions(contentOf(folder.file("r.json")),
               {"\"noc_confidence\"", "\"all_confidence\"", "\"reliability\"",
                "\"operating_points\"", "\"sigma_scale\": 3.9", "\"min_confidence\": 0.3"}));
  EXPECT_FALSE(mentions(contentOf(folder.file("r.json")), {"at_density"}));
  report.density = 75.0;
  writeJsonReport(report, folder.file("r.json"));
  EXPECT_TRUE(mentions(contentOf(folder.file("r.json")),
                       {"\"at_density\"", "\"at_density_each_scene\"", "\"density\": 75.0"}));
}

TEST(JsonReport, OtherVersionsAndCutBinsAreErrors) {
  const TemporaryFolder folder;
  const std::string old =
      folder.write("r.json", R"({"forest": null, "preset": null, "fingerprint": "01234567",
                                 "scenes": [], "mean": null, "weighted_mean": null})");
  EXPECT_TRUE(mentions(errorText([&] { readJsonReport(old); }),
                       {old, "version 1", "expected version 3", "without --resume"}));
  EvaluationReport report = makeReport();
  report.scenes[0].noc_sums.confidence = halfWrongProfile(40.0);
  report.scenes[0].noc_sums.sigma.pixels = 40.0;
  report.scenes[0].noc_sums.sigma.addInliers(20.0, 0.5);
  writeJsonReport(report, folder.file("r.json"));
  const std::string whole = contentOf(folder.file("r.json"));
  for (const char* list : {"\"wrong\": \\[", "\"squared_sum\": [^,]*,\\s*\"bins\": \\["}) {
    const std::regex with_first_number(std::string("(") + list + ")[^,]*,");
    const std::string cut =
        std::regex_replace(whole, with_first_number, "$1", std::regex_constants::format_first_only);
    ASSERT_LT(cut.size(), whole.size()) << list;
    const std::string path = folder.write("cut.json", cut);
    EXPECT_TRUE(mentions(errorText([&] { readJsonReport(path); }), {path, "not a report"})) << list;
  }
}

}  // namespace
}  // namespace cbmv
