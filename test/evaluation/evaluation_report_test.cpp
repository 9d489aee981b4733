#include "evaluation/evaluation_report.h"

#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/evaluation_report.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

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

std::string pointColumns(const std::string& end) {
  return ",min_confidence" + end + ",density" + end + ",bad_1" + end + ",bad_3" + end;
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
            "ece,brier,sigma_1,sigma_2,sigma_rms,density,seconds,ns_per_hypothesis,correct_px" +
                pointColumns("_from_0") + pointColumns("_from_0.3") + pointColumns("_from_0.5") +
                pointColumns("_from_0.7") + pointColumns("_from_0.9"));
  std::getline(lines, line);
  EXPECT_TRUE(mentions(line, {"\"a \"\"b\"\", c\",noc,1.000000,1.142857,", ",2.571429,,2.857143,",
                              ",99.500000,1.250000,40.000000,1.000000,"}));
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
      EXPECT_EQ(std::count(line.begin(), line.end(), '|'), 23) << line;
      ++rows;
    }
  }
  EXPECT_EQ(rows, 2 * 6);  // header, rule, two scenes, two means
  EXPECT_TRUE(mentions(formatReport(makeReport()),
                       {"Teddy", "Vintage", "weighted mean", "1.00", "2.429", "all pixels"}));
}

/// In each scene, half of the pixels have confidence 0.45 and an error of 2 px.
TEST(EvaluationReport, HasTheOperatingPointsWhereTheConfidenceIsKnown) {
  const TemporaryFolder folder;
  EvaluationReport report = makeReport();
  for (SceneScore& score : report.scenes) {
    score.noc_sums.confidence = score.all_sums.confidence = halfWrongProfile(40.0);
  }
  report.density = 75.0;
  report.scoring = {3.0, 2.0};
  const std::string text = formatReport(report);
  EXPECT_TRUE(mentions(text, {"auc: of bad 6", "up to 6 px", "Operating points", "official weights",
                              "most confident 75 %, one threshold", "a threshold per scene"}));
  writeMarkdownReport(report, folder.file("r.md"));
  EXPECT_TRUE(mentions(contentOf(folder.file("r.md")),
                       {"| min_confidence 0.3", "| min_confidence 0.9", "33.33"}));
  writeCsvReport(report, folder.file("r.csv"));
  EXPECT_TRUE(
      mentions(contentOf(folder.file("r.csv")),
               {",6.000000,0.000000,100.000000,50.000000,0.000000,", pointColumns("_from_0.9"),
                "_at_density_75", ",75.000000,33.333333,0.000000\n"}));
  EXPECT_FALSE(mentions(formatReport(makeReport()), {"Operating points"}));
}

TEST(EvaluationReport, FingerprintsDiffer) {
  EXPECT_EQ(fingerprintOf("a").size(), 8U);
  EXPECT_EQ(fingerprintOf("a"), fingerprintOf("a"));
  EXPECT_NE(fingerprintOf("a"), fingerprintOf("b"));
  EXPECT_EQ(fingerprintOf("123456789"), "cbf43926");  // the check value of CRC-32
}

}  // namespace
}  // namespace cbmv
