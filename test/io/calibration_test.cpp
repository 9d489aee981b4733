#include "io/calibration.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

const char* const kValid =
    "cam0=[ 1038.018 0 322.037 ; 0 1038.018 243.393 ; 0 0 1 ] \n"
    "cam1=[1038.018 0 375.308; 0 1038.018 243.393; 0 0 1]\r\n"
    " doffs= 53.271 \n baseline= 176.252\n width = 718\nheight=496\n ndisp= 73\n isint=0\n"
    "vmax= 65\n a line that is no key\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(Calibration, ReadsKeysWithBlanksAroundThem) {
  const TemporaryFolder folder;
  const StereoCalibration c = readMiddleburyCalibration(folder.write("calib.txt", kValid));
  EXPECT_EQ(c.focal_length_px, 1038.018);
  EXPECT_EQ(c.cx_left, 322.037);
  EXPECT_EQ(c.cx_right, 375.308);
  EXPECT_EQ(c.cy, 243.393);
  EXPECT_DOUBLE_EQ(c.baseline_m, 0.176252);
  EXPECT_EQ(c.width, 718);
  EXPECT_EQ(c.height, 496);
  EXPECT_EQ(c.disparities, 73);
  EXPECT_NEAR(c.doffs(), 53.271, 1e-9);
}

TEST(Calibration, ComesBackAsWritten) {
  const TemporaryFolder folder;
  const StereoCalibration c{721.5377, 609.5593, 612.25, 172.854, 0.53715, 1242, 375, 228};
  writeMiddleburyCalibration(folder.file("calib.txt"), c);
  const StereoCalibration read = readMiddleburyCalibration(folder.file("calib.txt"));
  EXPECT_DOUBLE_EQ(read.focal_length_px, c.focal_length_px);
  EXPECT_DOUBLE_EQ(read.cx_left, c.cx_left);
  EXPECT_DOUBLE_EQ(read.cx_right, c.cx_right);
  EXPECT_DOUBLE_EQ(read.cy, c.cy);
  EXPECT_NEAR(read.baseline_m, c.baseline_m, 1e-12);
  EXPECT_EQ(read.width, c.width);
  EXPECT_EQ(read.height, c.height);
  EXPECT_EQ(read.disparities, c.disparities);
}

TEST(Calibration, NamesFileAndKeyThatIsWrong) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& from, const std::string& to) {
    const std::string path = folder.write("calib.txt", replaced(kValid, from, to));
    std::string text = errorText([&] { readMiddleburyCalibration(path); });
    EXPECT_TRUE(mentions(text, {path}));
    return text;
  };
  EXPECT_TRUE(mentions(error("cam0", "camera"), {"cam0 is missing"}));
  EXPECT_TRUE(mentions(error("cam1", "camera"), {"cam1 is missing"}));
  EXPECT_TRUE(mentions(error("baseline", "base"), {"baseline is missing"}));
  EXPECT_TRUE(mentions(error("ndisp", "disp"), {"ndisp is missing"}));
  EXPECT_TRUE(mentions(error("322.037", "left"), {"cam0 is not"}));
  EXPECT_TRUE(mentions(error("; 0 0 1 ]", "]"), {"cam0 is not"}));
  EXPECT_TRUE(mentions(error("[ 1038.018", "[ -5"), {"cam0 is not"}));
  EXPECT_TRUE(mentions(error(" 176.252", ""), {"baseline is not"}));
  EXPECT_TRUE(mentions(error(" 176.252", "-1"), {"baseline is not"}));
  EXPECT_TRUE(mentions(error(" 176.252", "1 2"), {"baseline is not"}));
  EXPECT_TRUE(mentions(error("718", "718.5"), {"width is not"}));
  EXPECT_TRUE(mentions(error("718", "7e18"), {"width is not"}));
  EXPECT_TRUE(mentions(error("496", "0"), {"height is not"}));
  EXPECT_TRUE(mentions(error("496", "4x"), {"height is not"}));
}

TEST(Calibration, RejectsLargeFiles) {
  const TemporaryFolder folder;
  const std::string path = folder.write("calib.txt", kValid);
  std::filesystem::resize_file(path, (1 << 20) + 1);
  EXPECT_TRUE(
      mentions(errorText([&] { readMiddleburyCalibration(path); }), {path, "at most 1048576"}));
}

TEST(Calibration, NamesTheFileThatCannotBeOpened) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("calib.txt");
  EXPECT_TRUE(
      mentions(errorText([&] { readMiddleburyCalibration(missing); }), {missing, "no such file"}));
  const std::string unwritable = folder.file("absent/calib.txt");
  EXPECT_TRUE(
      mentions(errorText([&] { writeMiddleburyCalibration(unwritable, {}); }), {unwritable}));
}

}  // namespace
}  // namespace cbmv
