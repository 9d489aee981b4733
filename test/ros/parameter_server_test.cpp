#include "ros/parameter_server.h"

#include <limits>
#include <map>

#include <dynamic_reconfigure/Config.h>
#include <gtest/gtest.h>

#include "support/error_text.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

using cbmv_stereo::StereoConfig;

/// Names and values of a configuration.
std::map<std::string, ParameterValue> valuesOf(const StereoConfig& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  std::map<std::string, ParameterValue> values;
  for (const auto& entry : message.bools) {
    values[entry.name] = static_cast<bool>(entry.value);
  }
  for (const auto& entry : message.ints) {
    values[entry.name] = static_cast<int>(entry.value);
  }
  for (const auto& entry : message.doubles) {
    values[entry.name] = entry.value;
  }
  return values;
}

double number(const ParameterValue& value) {
  return std::visit([](auto v) { return static_cast<double>(v); }, value);
}

TEST(StereoConfig, IsTheTableOfParameters) {
  const auto defaults = valuesOf(StereoConfig::__getDefault__());
  const auto lowest = valuesOf(StereoConfig::__getMin__());
  const auto highest = valuesOf(StereoConfig::__getMax__());
  EXPECT_EQ(defaults.size(), stereoParameters().size() + 1);  // plus min_confidence
  for (const Parameter& parameter : stereoParameters()) {
    SCOPED_TRACE(parameter.name);
    ASSERT_EQ(defaults.count(parameter.name), 1U);
    const ParameterValue& value = defaults.at(parameter.name);
    EXPECT_EQ(value.index(), parameter.default_value.index());
    EXPECT_FLOAT_EQ(number(value), number(parameter.default_value));
    if (!std::holds_alternative<bool>(value)) {
      EXPECT_EQ(number(lowest.at(parameter.name)), parameter.lowest);
      EXPECT_EQ(number(highest.at(parameter.name)), parameter.highest);
    }
  }
}

TEST(StereoConfig, DescribesEveryParameterAsTheTableDoes) {
  std::map<std::string, std::string> descriptions;
  for (const auto& description : StereoConfig::__getParamDescriptions__()) {
    EXPECT_FALSE(description->description.empty()) << description->name;
    descriptions[description->name] = description->description;
  }
  for (const Parameter& parameter : stereoParameters()) {
    EXPECT_EQ(descriptions[parameter.name], describe(parameter));
  }
}

TEST(ApplyConfig, SetsEveryParameter) {
  for (const Parameter& parameter : stereoParameters()) {
    StereoOptions wanted;
    if (std::holds_alternative<bool>(parameter.default_value)) {
      parameter.set(wanted, !std::get<bool>(parameter.default_value));
    } else if (std::holds_alternative<int>(parameter.default_value)) {
      parameter.set(wanted, static_cast<int>(parameter.highest));
    } else {
      parameter.set(wanted, parameter.highest);
    }
    auto config = StereoConfig::__getDefault__();
    writeConfig(wanted, config);
    StereoOptions applied;
    applyConfig(config, applied);
    EXPECT_EQ(describeOptions(applied), describeOptions(wanted)) << parameter.name;
    EXPECT_NE(describeOptions(applied), describeOptions(StereoOptions())) << parameter.name;
  }
}

TEST(ApplyConfig, RejectsWhatIsNotANumber) {
  auto config = StereoConfig::__getDefault__();
  config.P2 = std::numeric_limits<double>::quiet_NaN();
  StereoOptions options;
  EXPECT_THROW(applyConfig(config, options), Error);
}

TEST(MinConfidence, IsAShareFromZeroToOne) {
  EXPECT_EQ(StereoConfig::__getDefault__().min_confidence, 0);
  EXPECT_EQ(StereoConfig::__getMin__().min_confidence, 0);
  EXPECT_EQ(StereoConfig::__getMax__().min_confidence, 1);
  auto config = StereoConfig::__getDefault__();
  config.min_confidence = 0.25;
  EXPECT_EQ(minConfidence(config), 0.25F);
  config.min_confidence = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(minConfidence(config), Error);
}

TEST(WriteConfig, KeepsValuesAsTheyWereTyped) {
  auto config = StereoConfig::__getDefault__();
  config.P1 = 1.7;
  StereoOptions options;
  applyConfig(config, options);
  writeConfig(options, config);
  EXPECT_EQ(config.P1, 1.7);  // not the nearest float
}

TEST(Preset, IsANameOrAPath) {
  setenv("ROS_PACKAGE_PATH", CBMV_SOURCE_DIR, 1);
  EXPECT_EQ(presetPath(""), "");
  EXPECT_EQ(presetPath(kNoPreset), "");
  EXPECT_EQ(presetPath("/some/where.yml"), "/some/where.yml");
  EXPECT_EQ(presetPath("here.yaml"), "here.yaml");
  const std::string path = presetPath("realtime");
  const std::string ending = "/config/realtime.yaml";
  ASSERT_GE(path.size(), ending.size());
  EXPECT_EQ(path.substr(path.size() - ending.size()), ending);
}

TEST(Preset, NamesThatThereAreAreListed) {
  setenv("ROS_PACKAGE_PATH", CBMV_SOURCE_DIR, 1);
  StereoOptions options;
  EXPECT_NO_THROW(applyPreset("kitti", options));
  const std::string error = errorText([&] { applyPreset("nonsense", options); });
  EXPECT_TRUE(mentions(error, {"'nonsense'", "balanced, ", "quality", "realtime", "path"}));
  EXPECT_EQ(error.find(".rviz"), std::string::npos);
  EXPECT_EQ(error.find("comparison"), std::string::npos);
}

TEST(Preset, IsCustomOnceAValueDiffers) {
  const std::string preset = CBMV_SOURCE_DIR "/config/realtime.yaml";
  StereoOptions options;
  EXPECT_EQ(presetOf(preset, options), kNoPreset);
  applyPreset(preset, options);
  EXPECT_EQ(presetOf(preset, options), preset);
  options.range.count = 32;  // not in the preset
  EXPECT_EQ(presetOf(preset, options), preset);
  options.sgm.p1 += 0.5F;
  EXPECT_EQ(presetOf(preset, options), kNoPreset);
  EXPECT_EQ(presetOf("", options), kNoPreset);
  EXPECT_EQ(presetOf("/nonexistent.yaml", options), kNoPreset);
}

/// The presets offered in cfg/Stereo.cfg exist and need no correction.
TEST(Preset, FilesAreThere) {
  for (const char* name : {"quality", "balanced", "realtime", "kitti"}) {
    StereoOptions options;
    EXPECT_NO_THROW(applyPreset(std::string(CBMV_SOURCE_DIR "/config/") + name + ".yaml", options));
    EXPECT_TRUE(correctOptions(options).empty()) << name;
  }
}

}  // namespace
}  // namespace cbmv
