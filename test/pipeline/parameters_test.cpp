#include "cbmv_stereo/parameters.h"

#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string writePreset(const std::string& text) {
  std::string path = testing::TempDir() + "preset.yaml";
  std::ofstream(path) << text;
  return path;
}

template <typename Action>
std::string rejection(const Action& action) {
  try {
    action();
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(Parameters, HaveUniqueNamesAndDefaultsInsideOfTheirRanges) {
  std::set<std::string> names;
  for (const Parameter& parameter : stereoParameters()) {
    EXPECT_TRUE(names.insert(parameter.name).second) << parameter.name;
    EXPECT_FALSE(parameter.description.empty()) << parameter.name;
    StereoOptions options;
    EXPECT_NO_THROW(parameter.set(options, parameter.default_value)) << parameter.name;
    EXPECT_EQ(parameter.get(options), parameter.default_value) << parameter.name;
  }
}

/// Most values are stored as float, which is slightly below 0.01, for example.
TEST(Parameters, TakeTheirLimitsBack) {
  for (const Parameter& parameter : stereoParameters()) {
    for (const double limit : {parameter.lowest, parameter.highest}) {
      if (std::holds_alternative<double>(parameter.default_value)) {
        StereoOptions options;
        parameter.set(options, limit);
        EXPECT_NO_THROW(parameter.set(options, parameter.get(options))) << parameter.name;
      }
    }
  }
}

/// Each parameter has its own field: setting it changes this parameter and no other.
TEST(Parameters, SetTheirOwnField) {
  const std::vector<Parameter> parameters = stereoParameters();
  for (const Parameter& parameter : parameters) {
    StereoOptions options;
    ParameterValue other = parameter.highest;
    if (std::holds_alternative<bool>(parameter.default_value)) {
      other = !std::get<bool>(parameter.default_value);
    } else if (std::holds_alternative<int>(parameter.default_value)) {
      other = static_cast<int>(parameter.highest);
    }
    parameter.set(options, other);
    for (const Parameter& each : parameters) {
      EXPECT_EQ(each.get(options), each.name == parameter.name ? other : each.default_value)
          << "set " << parameter.name << ", looked at " << each.name;
    }
  }
}

TEST(Parameters, RejectWrongTypesAndValues) {
  StereoOptions options;
  EXPECT_THAT(rejection([&] { findParameter("P1").set(options, 61.0); }),
              AllOf(HasSubstr("P1"), HasSubstr("61"), HasSubstr("[0, 60]")));
  EXPECT_THAT(rejection([&] { findParameter("P1").set(options, std::nan("")); }), HasSubstr("P1"));
  EXPECT_THAT(rejection([&] { findParameter("disparity_range").set(options, 64.5); }),
              HasSubstr("whole number"));
  EXPECT_THAT(rejection([&] { findParameter("subpixel").set(options, 1); }),
              HasSubstr("true or false"));
  EXPECT_THAT(rejection([&] { findParameter("p3"); }), HasSubstr("p3"));
  findParameter("P1").set(options, 2);
  EXPECT_EQ(options.sgm.p1, 2.0F);
}

TEST(CorrectOptions, LeavesDefaultsAlone) {
  StereoOptions options;
  EXPECT_TRUE(correctOptions(options).empty());
}

TEST(CorrectOptions, MendsAndSaysSo) {
  StereoOptions options;
  options.sgm.p1 = 12;
  options.sgm.p2 = 10;
  options.refinement.median_size_px = 4;
  const std::vector<std::string> corrections = correctOptions(options);
  ASSERT_EQ(corrections.size(), 2U);
  EXPECT_THAT(corrections[0], AllOf(HasSubstr("P1 (12)"), HasSubstr("P2 (10)")));
  EXPECT_THAT(corrections[1], AllOf(HasSubstr("median_size (4)"), HasSubstr("3")));
  EXPECT_EQ(options.sgm.p1, 10.0F);
  EXPECT_EQ(options.refinement.median_size_px, 3);
  EXPECT_TRUE(correctOptions(options).empty());
}

TEST(CorrectOptions, KeepsSumsInSixteenBits) {
  StereoOptions options;
  options.sgm.p1 = 40;
  options.sgm.p2 = 60;
  options.sgm.iterations = 4;
  EXPECT_EQ(correctOptions(options).size(), 1U);
  EXPECT_EQ(options.sgm.p1, 15.0F);
  EXPECT_EQ(options.sgm.p2, 15.0F);
  EXPECT_TRUE(correctOptions(options).empty());
}

TEST(Preset, SetsWhatItNames) {
  StereoOptions options;
  options.sgm.q1 = 4;
  readPreset(writePreset("P1: 2\nsubpixel: false\ndisparity_range: 100\n"), options);
  EXPECT_EQ(options.sgm.p1, 2.0F);
  EXPECT_EQ(options.sgm.q1, 4.0F);
  EXPECT_FALSE(options.refinement.subpixel);
  EXPECT_EQ(options.range.count, 100);
}

TEST(Preset, MayBeginWithAByteOrderMark) {
  StereoOptions options;
  readPreset(writePreset("\xEF\xBB\xBFP1: 2\r\n"), options);
  EXPECT_EQ(options.sgm.p1, 2.0F);
}

TEST(Preset, NamesFileAndKeyThatAreWrong) {
  const auto read = [](const std::string& path) {
    return rejection([&] {
      StereoOptions options;
      readPreset(path, options);
    });
  };
  EXPECT_THAT(read("/"), AllOf(HasSubstr("preset /:"), HasSubstr("folder")));
  EXPECT_THAT(read("/no/such.yaml"), AllOf(HasSubstr("/no/such.yaml"), HasSubstr("opened")));
  EXPECT_THAT(read(writePreset("P3: 1")), AllOf(HasSubstr("preset.yaml"), HasSubstr("P3")));
  EXPECT_THAT(read(writePreset("P1: many")), AllOf(HasSubstr("P1"), HasSubstr("a number")));
  EXPECT_THAT(read(writePreset("P1: 99")), AllOf(HasSubstr("P1"), HasSubstr("[0, 60]")));
  EXPECT_THAT(read(writePreset("- 1\n- 2\n")), HasSubstr("not a map"));
  EXPECT_THAT(read(writePreset("P1: [")), HasSubstr("not valid YAML"));
}

TEST(Preset, RejectsHostileYaml) {
  const auto read = [](const std::string& text) {
    return rejection([&] {
      StereoOptions options;
      readPreset(writePreset(text), options);
    });
  };
  EXPECT_THAT(read("P1: .nan"), HasSubstr("P1 is nan"));
  EXPECT_THAT(read("P1: .inf"), HasSubstr("[0, 60]"));
  EXPECT_THAT(read("P1: " + std::string(2000, '[')), HasSubstr("not valid YAML"));
  EXPECT_THAT(read("# " + std::string(70000, 'x')), HasSubstr("more than 65536 bytes"));
  std::string bomb = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 60; ++i) {
    const std::string here = "a" + std::to_string(i), last = "*a" + std::to_string(i - 1);
    bomb.append(here).append(": &").append(here);
    bomb.append(" [").append(last).append(", ").append(last).append("]\n");
  }
  EXPECT_THAT(read(bomb), HasSubstr("no parameter a0"));
}

TEST(Preset, FailureChangesNothing) {
  StereoOptions options;
  EXPECT_THROW(readPreset(writePreset("P1: 2\nP2: 99\n"), options), Error);
  EXPECT_EQ(options.sgm.p1, StereoOptions().sgm.p1);
}

class ShippedPreset : public testing::TestWithParam<const char*> {};

TEST_P(ShippedPreset, IsConsistent) {
  StereoOptions options;
  readPreset(std::string(CBMV_SOURCE_DIR "/config/") + GetParam(), options);
  EXPECT_TRUE(correctOptions(options).empty());
}

INSTANTIATE_TEST_SUITE_P(All, ShippedPreset,
                         testing::Values("quality.yaml", "balanced.yaml", "realtime.yaml",
                                         "default.yaml", "kitti.yaml", "middlebury.yaml"));

}  // namespace
}  // namespace cbmv::test
