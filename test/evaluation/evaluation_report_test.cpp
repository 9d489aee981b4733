#include "cbmv_stereo/evaluation/evaluation_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support/error_text.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

SceneScore makeScore(const std::string& name, double first, double weight) {
  SceneScore score;
  score.scene = name;
  score.weight = weight;
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    score.noc[m] = first + static_cast<double>(m) / 7.0;
    score.all[m] = 2.0 * score.noc[m];
  }
  score.density = 99.5;
  score.seconds = 1.25;
  score.ns_per_hypothesis = 40.0;
  return score;
}

EvaluationReport makeReport() {
  EvaluationReport report;
  report.forest = "my.forest";
  report.preset = "my.yaml";
  report.fingerprint = "01234567";
  report.insert(makeScore("Vintage", 4.0, 0.5));
  report.insert(makeScore("Teddy", 1.0, 1.0));
  return report;
}

void expectSame(const MetricValues& a, const MetricValues& b) {
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    EXPECT_TRUE(a[m] == b[m] || (std::isnan(a[m]) && std::isnan(b[m]))) << kMetrics[m].name;
  }
}

TEST(EvaluationReport, KeepsScenesByNameAndEachOnce) {
  EvaluationReport report = makeReport();
  ASSERT_EQ(report.scenes.size(), 2U);
  EXPECT_EQ(report.scenes[0].scene, "Teddy");
  report.insert(makeScore("Teddy", 9.0, 1.0));
  ASSERT_EQ(report.scenes.size(), 2U);
  EXPECT_EQ(report.find("Teddy")->noc[0], 9.0);
  EXPECT_EQ(report.find("Art"), nullptr);
  EXPECT_TRUE(report.isWeighted());
  report.scenes.pop_back();
  EXPECT_FALSE(report.isWeighted());
}

TEST(EvaluationReport, ComesBackFromJson) {
  const TemporaryFolder folder;
  EvaluationReport report = makeReport();
  report.scenes[1].seconds = kNotMeasured;
  report.scenes[1].noc[11] = kNotMeasured;
  writeJsonReport(report, folder.file("r.json"));
  const EvaluationReport read = readJsonReport(folder.file("r.json"));
  EXPECT_EQ(read.forest, report.forest);
  EXPECT_EQ(read.preset, report.preset);
  EXPECT_EQ(read.fingerprint, report.fingerprint);
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

TEST(EvaluationReport, JsonHasTheAgreedEntries) {
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
    for (const char* name : {"bad_0.5", "bad_1", "bad_2", "bad_3", "bad_4", "d1", "avg", "rms",
                             "a50", "a90", "a99", "auc", "auc_optimal"}) {
      object += (object.empty() ? "{\"" : ",\"") + std::string(name) + "\":" + value;
    }
    return object + "}";
  };
  const std::string pixels = "\"noc\":" + metrics("0.5") + ",\"all\":" + metrics("1.5");
  EXPECT_EQ(text,
            "{\"forest\":\"my.forest\",\"preset\":null,\"fingerprint\":\"01234567\",\"scenes\":[{"
            "\"scene\":\"Teddy\"," +
                pixels +
                ",\"density\":99.5,\"seconds\":1.25,\"ns_per_hypothesis\":40.0}],\"mean\":{" +
                pixels + "},\"weighted_mean\":{" + pixels + "}}");
}

TEST(EvaluationReport, HasCurvesAndUnscoredScenesWhereThereAreSome) {
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

TEST(EvaluationReport, WithoutScenesHasNoMean) {
  const TemporaryFolder folder;
  writeJsonReport({}, folder.file("r.json"));
  EXPECT_TRUE(mentions(contentOf(folder.file("r.json")),
                       {"\"scenes\": []", "\"mean\": null", "\"weighted_mean\": null"}));
  EXPECT_TRUE(readJsonReport(folder.file("r.json")).scenes.empty());
  EXPECT_TRUE(mentions(formatReport({}), {"non-occluded", "bad_0.5"}));
}

TEST(EvaluationReport, IsWrittenThroughLinksAndIntoPipes) {
  const TemporaryFolder folder;
  const std::string target = folder.write("r.json", "old");
  std::filesystem::create_symlink(target, folder.file("link.json"));
  writeJsonReport(makeReport(), folder.file("link.json"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.json")));
  EXPECT_EQ(readJsonReport(target).scenes.size(), 2U);

  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDWR);  // so that writing does not wait for one
  writeCsvReport({}, pipe);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  close(reader);
}

TEST(EvaluationReport, NamesTheFileThatIsWrong) {
  const TemporaryFolder folder;
  const char* const half_a_scene = R"({"forest": null, "preset": null, "fingerprint": null,
                                       "scenes": [{"scene": "A"}]})";
  for (const char* content : {"", "{", "[]", R"({"forest": 3})", half_a_scene}) {
    const std::string path = folder.write("r.json", content);
    EXPECT_TRUE(mentions(errorText([&] { readJsonReport(path); }), {path, "not a report"}));
  }
  const std::string deep = folder.write("r.json", std::string(65, '['));
  EXPECT_TRUE(mentions(errorText([&] { readJsonReport(deep); }), {deep, "64 levels"}));
  std::filesystem::resize_file(deep, (64 << 20) + 1);
  EXPECT_TRUE(mentions(errorText([&] { readJsonReport(deep); }), {deep, "at most 67108864"}));
  const std::string absent = folder.file("no/r.json");
  EXPECT_TRUE(mentions(errorText([&] { readJsonReport(absent); }), {absent, "no such file"}));
  EXPECT_TRUE(mentions(errorText([&] { writeJsonReport({}, absent); }), {absent}));
  EXPECT_TRUE(mentions(errorText([&] { writeCsvReport({}, absent); }), {absent}));
  EXPECT_TRUE(mentions(errorText([&] { writeMarkdownReport({}, absent); }), {absent}));
}

TEST(EvaluationReport, CsvHasALineForEachSceneAndKindOfPixels) {
  const TemporaryFolder folder;
  EvaluationReport report = makeReport();
  report.scenes[0].scene = "a \"b\", c";
  report.scenes[0].noc[12] = kNotMeasured;
  writeCsvReport(report, folder.file("r.csv"));
  std::istringstream lines(contentOf(folder.file("r.csv")));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "scene,pixels,bad_0.5,bad_1,bad_2,bad_3,bad_4,d1,avg,rms,a50,a90,a99,auc,auc_optimal,"
            "density,seconds,ns_per_hypothesis");
  std::getline(lines, line);
  EXPECT_TRUE(mentions(line, {"\"a \"\"b\"\", c\",noc,1.000000,1.142857,",
                              ",2.571429,,99.500000,1.250000,40.000000"}));
  for (const char* begin :
       {"\"a \"\"b\"\", c\",all,2.0", "Vintage,noc,4.0", "Vintage,all,8.0", "mean,noc,2.5",
        "mean,all,5.0", "weighted mean,noc,2.0", "weighted mean,all,4.0"}) {
    std::getline(lines, line);
    EXPECT_EQ(line.substr(0, std::string(begin).size()), begin);
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST(EvaluationReport, TablesHaveARowForEachSceneAndMean) {
  const TemporaryFolder folder;
  writeMarkdownReport(makeReport(), folder.file("r.md"));
  std::istringstream lines(contentOf(folder.file("r.md")));
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line[0] == '|') {
      EXPECT_EQ(std::count(line.begin(), line.end(), '|'), 18) << line;
      ++rows;
    }
  }
  EXPECT_EQ(rows, 2 * 6);  // header, rule, two scenes, two means
  EXPECT_TRUE(mentions(formatReport(makeReport()),
                       {"Teddy", "Vintage", "weighted mean", "1.00", "2.429", "all pixels"}));
}

TEST(EvaluationReport, FingerprintsDiffer) {
  EXPECT_EQ(fingerprintOf("a").size(), 8U);
  EXPECT_EQ(fingerprintOf("a"), fingerprintOf("a"));
  EXPECT_NE(fingerprintOf("a"), fingerprintOf("b"));
  EXPECT_EQ(fingerprintOf("123456789"), "cbf43926");  // the check value of CRC-32
}

}  // namespace
}  // namespace cbmv
