// Compares docs/ros.md and docs/stereo_image_proc.md with the code, and checks that the tests they
// name exist.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "ros/nodelet_inputs.h"
#include "ros/output_publishers.h"
#include "ros/parameter_server.h"
#include "ros/private_parameters.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

std::string readFile(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// The part of a page below a heading, up to the next one.
std::string section(const std::string& heading, const std::string& page = "ros.md") {
  const std::string document = readFile(std::string(CBMV_SOURCE_DIR "/docs/") + page);
  const std::size_t start = document.find("\n## " + heading + "\n");
  if (start == std::string::npos) {
    ADD_FAILURE() << "docs/" << page << " has no heading " << heading;
    return {};
  }
  const std::size_t end = document.find("\n## ", start + 1);
  return document.substr(start, end - start);
}

/// The rows of the tables in a section whose first cell is a name.
std::multiset<std::string> rows(const std::string& heading) {
  std::multiset<std::string> found;
  std::istringstream lines(section(heading));
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) == 0) {
      found.insert(line);
    }
  }
  return found;
}

void expectRows(const std::string& heading, const std::vector<std::string>& wanted) {
  const std::multiset<std::string> expected(wanted.begin(), wanted.end());
  EXPECT_EQ(rows(heading), expected) << "below the heading " << heading;
}

std::string join(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) {
    row += (cell.empty() ? "" : " " + cell) + " |";
  }
  return row;
}

std::string text(const PrivateValue& value) {
  std::ostringstream out;
  out << std::boolalpha;
  std::visit([&](const auto& v) { out << v; }, value);
  return out.str().empty() ? "none" : out.str();
}

bool isNumber(const PrivateValue& value) {
  return std::holds_alternative<int>(value) || std::holds_alternative<double>(value);
}

std::string rangeText(double lowest, double highest) {
  std::ostringstream out;
  out << lowest << " to " << static_cast<std::int64_t>(highest);
  return out.str();
}

std::vector<std::string> parameterRows(const std::vector<PrivateParameter>& parameters) {
  std::vector<std::string> wanted;
  for (const PrivateParameter& parameter : parameters) {
    const bool number = isNumber(parameter.default_value);
    wanted.push_back(join({"`" + parameter.name + "`", text(parameter.default_value),
                           number ? rangeText(parameter.lowest, parameter.highest) : "",
                           parameter.unit, parameter.description}));
  }
  return wanted;
}

/// Names and types, as the first two cells of a row.
template <typename Inputs>
void expectInputs(const std::string& heading, const InputTopics& topics) {
  const auto types = Inputs::types();
  const std::string text = section(heading);
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const std::string row = std::string("| `") + topics[i] + "` | " + types[i] + " |";
    EXPECT_NE(text.find(row), std::string::npos) << row << " is missing below " << heading;
  }
}

TEST(RosDocument, HasTheInputs) {
  expectInputs<StereoInputs>("Inputs of cbmv_stereo/stereo", kStereoInputTopics);
  EXPECT_EQ(rows("Inputs of cbmv_stereo/stereo").size(), kStereoInputTopics.size() + 1);
  EXPECT_NE(section("Inputs of cbmv_stereo/stereo")
                .find(std::string("| `") + kColorTopic + "` | sensor_msgs/Image |"),
            std::string::npos);
  expectInputs<CloudInputs>("Inputs of cbmv_stereo/point_cloud2", kCloudInputTopics);
  EXPECT_EQ(rows("Inputs of cbmv_stereo/point_cloud2").size(), kCloudInputTopics.size());
}

TEST(RosDocument, HasTheOutputs) {
  std::vector<std::string> wanted;
  for (const Output& output : stereoOutputs({})) {
    wanted.push_back(join({"`" + output.topic + "`", output.type, output.description}));
  }
  expectRows("Outputs of cbmv_stereo/stereo", wanted);
}

TEST(RosDocument, HasThePrivateParameters) {
  expectRows("Private parameters of cbmv_stereo/stereo", parameterRows(stereoPrivateParameters()));
  expectRows("Private parameters of cbmv_stereo/point_cloud2",
             parameterRows(pointCloudPrivateParameters()));
}

TEST(RosDocument, HasTheParametersThatAreNoneOfTheMethod) {
  using cbmv_stereo::StereoConfig;
  const StereoConfig defaults = StereoConfig::__getDefault__();
  std::ostringstream confidence;
  confidence << defaults.min_confidence;
  std::vector<std::string> wanted;
  for (const auto& description : StereoConfig::__getParamDescriptions__()) {
    if (description->name == "min_confidence") {
      wanted.push_back(join({"`min_confidence`", confidence.str(),
                             rangeText(StereoConfig::__getMin__().min_confidence,
                                       StereoConfig::__getMax__().min_confidence),
                             "", description->description}));
    } else if (description->name == "preset") {
      wanted.push_back(join({"`preset`", defaults.preset, "", "", description->description}));
    }
  }
  expectRows("Parameters at run time", wanted);
}

/// Whether the launch file computes the parameter from its arguments.
bool isMadeOfArguments(const std::string& parameter) {
  return parameter == "unknown_arguments" || parameter == kColorTopicParameter ||
         std::find(kStereoTopicParameters.begin(), kStereoTopicParameters.end(), parameter) !=
             kStereoTopicParameters.end();
}

/// Every other private parameter is an argument of the launch file, with the same default.
TEST(RosDocument, LaunchFileHasThePrivateParameters) {
  const std::string launch = readFile(CBMV_SOURCE_DIR "/launch/stereo.launch");
  for (const PrivateParameter& parameter : stereoPrivateParameters()) {
    EXPECT_NE(launch.find("<param name=\"" + parameter.name + "\""), std::string::npos)
        << parameter.name;
    if (isMadeOfArguments(parameter.name)) {
      continue;
    }
    const std::regex argument("<arg name=\"" + parameter.name + "\" default=\"([^\"]*)\"/>");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(launch, found, argument)) << parameter.name;
    if (isNumber(parameter.default_value)) {
      std::visit(
          [&](const auto& value) {
            if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
              EXPECT_EQ(std::stod(found[1]), static_cast<double>(value)) << parameter.name;
            }
          },
          parameter.default_value);
    } else if (std::holds_alternative<bool>(parameter.default_value)) {
      EXPECT_EQ(found[1], text(parameter.default_value)) << parameter.name;
    }
  }
}

/// The arguments that the caller of a launch file can set: those without a fixed value.
std::set<std::string> argumentsOf(const std::string& launch) {
  const std::regex argument("\\n  <arg name=\"([a-zA-Z0-9_]+)\"( default=\"[^\"]*\")? */>");
  std::set<std::string> names;
  for (std::sregex_iterator found(launch.begin(), launch.end(), argument), end; found != end;
       ++found) {
    names.insert((*found)[1]);
  }
  return names;
}

/// They pass on arguments of stereo.launch; their own arguments are documented.
TEST(RosDocument, HasTheArgumentsOfTheOtherLaunchFiles) {
  const std::string documented = section("Launch files");
  for (const char* file : {"stereo_image_proc_replacement", "comparison", "demo"}) {
    const auto names =
        argumentsOf(readFile(CBMV_SOURCE_DIR "/launch/" + std::string(file) + ".launch"));
    EXPECT_GE(names.size(), 5U) << file;
    for (const std::string& name : names) {
      EXPECT_NE(documented.find("`" + name + "`"), std::string::npos)
          << name << " of " << file << " is not documented";
    }
  }
}

/// The list of known arguments, from which the node derives the unknown ones.
TEST(RosDocument, LaunchFilesKnowTheirArguments) {
  for (const char* file : {"stereo", "stereo_image_proc_replacement", "comparison", "demo"}) {
    const std::string launch = readFile(CBMV_SOURCE_DIR "/launch/" + std::string(file) + ".launch");
    const std::regex list("<arg name=\"known\" value=\"([^\"]*)\"/>");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(launch, found, list)) << file;
    std::istringstream words(found[1]);
    const std::set<std::string> known(std::istream_iterator<std::string>(words), {});
    std::set<std::string> wanted = argumentsOf(launch);
    wanted.insert("known");
    EXPECT_EQ(known, wanted) << file;
  }
}

TEST(Replacement, TakesTheArgumentsOfTheStockLaunchFile) {
  const fs::path stock = CBMV_STOCK_LAUNCH_FILE;
  if (!fs::exists(stock)) {
    GTEST_SKIP() << "stereo_image_proc is not installed";
  }
  const auto ours =
      argumentsOf(readFile(CBMV_SOURCE_DIR "/launch/stereo_image_proc_replacement.launch"));
  const auto theirs = argumentsOf(readFile(stock));
  EXPECT_EQ(theirs.count("manager"), 1U);
  EXPECT_GE(theirs.size(), 5U);
  for (const std::string& name : theirs) {
    EXPECT_EQ(ours.count(name), 1U) << name;
  }
}

/// Names of all tests in this folder, as Suite.Name.
std::set<std::string> allTests() {
  std::set<std::string> names;
  const std::regex definition("\\nTEST(?:_F)?\\((\\w+),\\s*(\\w+)\\)");
  for (const auto& file : fs::directory_iterator(CBMV_SOURCE_DIR "/test/ros")) {
    const std::string source = readFile(file.path());
    for (std::sregex_iterator found(source.begin(), source.end(), definition), end; found != end;
         ++found) {
      names.insert((*found)[1].str() + "." + (*found)[2].str());
    }
  }
  return names;
}

/// Names of tests in a text, as `Suite.Name`.
std::vector<std::string> testsNamedIn(const std::string& text) {
  const std::regex name("`([A-Z]\\w+\\.[A-Z]\\w+)`");
  std::vector<std::string> names;
  for (std::sregex_iterator found(text.begin(), text.end(), name), end; found != end; ++found) {
    names.push_back((*found)[1]);
  }
  return names;
}

TEST(RosDocument, NamesTestsThatThereAre) {
  const std::set<std::string> tests = allTests();
  const auto named = testsNamedIn(readFile(CBMV_SOURCE_DIR "/docs/ros.md") +
                                  readFile(CBMV_SOURCE_DIR "/docs/stereo_image_proc.md"));
  EXPECT_GT(named.size(), 30U);
  for (const std::string& name : named) {
    EXPECT_EQ(tests.count(name), 1U) << name << " is no test";
  }
}

TEST(RosDocument, NamesATestForEveryComparison) {
  for (const char* heading :
       {"The same as stereo_image_proc", "Where stereo_image_proc is wrong"}) {
    std::istringstream lines(section(heading, "stereo_image_proc.md"));
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("| ", 0) == 0 && line.find("| proved by |") == std::string::npos) {
        const std::size_t last_cell = line.rfind("| ", line.size() - 2);
        EXPECT_FALSE(testsNamedIn(line.substr(last_cell)).empty())
            << "no test is named in: " << line;
      }
    }
  }
}

}  // namespace
}  // namespace cbmv
