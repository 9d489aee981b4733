#include "tuning/tuning_report.h"

#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/temporary_folder.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

TuningReport makeReport() {
  TuningReport report;
  report.start = "begin.yaml";
  report.parameters = {"P1", "median_size"};
  report.forests = {"a.forest", "b.forest"};
  report.evaluations = 42;
  report.data_sets = {
      {"Middlebury v3", "bad_1", {"ArtL", "Piano"}, 11.17, 10.5, 10.8},
      {"KITTI 2012", "bad_3", std::vector<std::string>(30, "000000_10"), 3.7, 3.25}};
  report.options.sgm.p1 = 0.7F;
  report.options.refinement.median_size_px = 5;
  report.options.refinement.subpixel = false;
  report.options.range = {-3, 17};
  return report;
}

TEST(TuningReport, SaysWhatWasFoundAndFromWhat) {
  TuningReport report = makeReport();
  const std::string text = describeReport(report);
  EXPECT_TRUE(
      mentions(text, {"begin.yaml", "42 evaluations of P1, median_size.", "(a.forest,\nb.forest)",
                      "Middlebury v3, bad_1: 11.170 before, 10.500 after, 10.800 when",
                      "ArtL, Piano.", "KITTI 2012, bad_3: 3.700 before, 3.250 after. Sc"}));
  EXPECT_FALSE(mentions(text, {"rows"}));
  report.rows = 128;
  EXPECT_TRUE(mentions(describeReport(report), {"middle 128 rows"}));
}

TEST(TuningReport, IsAPresetOfAllButTheVolumesParameters) {
  const TemporaryFolder folder;
  const TuningReport report = makeReport();
  const std::string path = folder.file("new.yaml");
  writePresets(report, path);
  StereoOptions options;
  readPreset(path, options);
  StereoOptions expected = report.options;
  expected.range = DisparityRange();
  EXPECT_EQ(describeOptions(options), describeOptions(expected));
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  EXPECT_TRUE(
      mentions(errorText([&] { writePresets(report, folder.file("none/new.yaml")); }), {"none"}));
}

TEST(TuningReport, FoldsHavePresetsOfTheirOwn) {
  const TemporaryFolder folder;
  TuningReport report = makeReport();
  StereoOptions other = report.options;
  other.sgm.p1 = 0.5F;
  report.held_out_folds = {{0, other}, {2, report.options}};
  writePresets(report, folder.file("new.yaml"));
  StereoOptions options;
  readPreset(folder.file("new_without_fold_1.yaml"), options);
  EXPECT_EQ(options.sgm.p1, 0.5F);
  readPreset(folder.file("new_without_fold_3.yaml"), options);
  EXPECT_EQ(options.sgm.p1, report.options.sgm.p1);
  EXPECT_FALSE(std::filesystem::exists(foldPresetPath(folder.file("new.yaml"), 1)));
}

TEST(TuningReport, CommentsFitTheColumns) {
  std::istringstream lines(presetText(makeReport()));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 100U) << line;
  }
}

}  // namespace
}  // namespace cbmv
