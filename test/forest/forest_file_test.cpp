#include "cbmv_stereo/forest/forest_file.h"

#include <chrono>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/random_forest.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string pathOf(const std::string& name) { return testing::TempDir() + "forest_file_" + name; }

std::string readAll(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void writeAll(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// The sentence that readForest refuses the file with; empty if it accepts it.
std::string refusal(const std::string& path) {
  try {
    readForest(path);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text.replace(place, from.size(), to);
}

TEST(ForestFile, KeepsEverything) {
  const Forest forest = makeForest(20, 8, 1);
  writeForest(forest, pathOf("kept"));
  const Forest read = readForest(pathOf("kept"));
  EXPECT_EQ(read.name, "forest_file_kept");
  EXPECT_EQ(read.bias, forest.bias);
  EXPECT_EQ(read.leaf_unit, forest.leaf_unit);
  EXPECT_EQ(read.provenance.scenes, forest.provenance.scenes);
  ASSERT_EQ(read.trees.size(), forest.trees.size());
  for (std::size_t t = 0; t < forest.trees.size(); ++t) {
    EXPECT_EQ(read.trees[t].leaves, forest.trees[t].leaves);
    ASSERT_EQ(read.trees[t].levels.size(), forest.trees[t].levels.size());
    for (std::size_t k = 0; k < forest.trees[t].levels.size(); ++k) {
      EXPECT_EQ(read.trees[t].levels[k].feature, forest.trees[t].levels[k].feature);
      EXPECT_EQ(read.trees[t].levels[k].threshold, forest.trees[t].levels[k].threshold);
    }
  }
  for (int f = 0; f < kFeatureCount; ++f) {
    EXPECT_EQ(read.quantizer.maps[f].scale, forest.quantizer.maps[f].scale);
    EXPECT_EQ(read.quantizer.maps[f].offset, forest.quantizer.maps[f].offset);
  }
}

TEST(ForestFile, NamesMissingFile) {
  EXPECT_THAT(refusal(pathOf("nowhere")),
              AllOf(HasSubstr(pathOf("nowhere")), HasSubstr("cannot be opened")));
}

TEST(ForestFile, NamesDamage) {
  writeForest(makeForest(3, 4, 2), pathOf("good"));
  const std::string good = readAll(pathOf("good"));
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "no valid JSON"},
      {"P5 1 1 255 x", "no valid JSON"},
      {good.substr(0, good.size() / 2), "no valid JSON"},
      {"[1, 2]", "not a forest"},
      {"{\"format\": \"other\"}", "not a forest"},
      {replaced(good, "\"version\": 1", "\"version\": 2"), "format version 2"},
      {replaced(good, "\"version\": 1,", ""), "missing or misplaced entry"},
      {replaced(good, "\"bias\": -0.25", "\"bias\": -0.26"), "is damaged"},
      {replaced(good, "\"checksum\": \"", "\"checksum\": \"0"), "is damaged"}};
  for (const auto& [text, fault] : cases) {
    writeAll(pathOf("bad"), text);
    EXPECT_THAT(refusal(pathOf("bad")), AllOf(HasSubstr(pathOf("bad")), HasSubstr(fault)));
  }
}

TEST(ForestFile, RefusesToWriteWhatCannotBeRead) {
  const auto write_changed = [](const auto& change) {
    Forest forest = makeForest(3, 4, 2);
    change(forest);
    writeForest(forest, pathOf("refused"));
  };
  EXPECT_THROW(write_changed([](Forest& f) { f.trees.clear(); }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.trees[1].levels.clear(); }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.trees[1].leaves.pop_back(); }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.trees[0].levels[0].feature = 20; }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.quantizer.maps[7].scale = 0; }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.bias = std::nan(""); }), Error);
  EXPECT_THROW(writeForest(makeForest(1, 1, 1), "/nowhere/at/all.forest"), Error);
}

TEST(ForestFile, ShippedForestLoadsQuickly) {
  const auto start = std::chrono::steady_clock::now();
  const Forest forest = readForest(CBMV_SOURCE_DIR "/models/middlebury.forest");
  const auto time = std::chrono::steady_clock::now() - start;
  EXPECT_LT(time, std::chrono::milliseconds(50));
  EXPECT_EQ(forest.provenance.scenes.size(), 15U);
}

}  // namespace
}  // namespace cbmv::test
