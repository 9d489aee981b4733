#include "forest/forest_file.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/file_content.h"
#include "support/random_forest.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string pathOf(const std::string& name) { return testing::TempDir() + "forest_file_" + name; }

void writeAll(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// The error message of readForest; empty if it accepts the file.
std::string rejection(const std::string& path) {
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

TEST(ForestFile, KeepsTheMeasures) {
  Forest forest = makeForest(2, 3, 1);
  forest.provenance.reliability = {{0.05, 0.0625, 12}, {0.95, 0.875, 8}};
  forest.provenance.calibration_error = 0.0375;
  for (int f = 0; f < kFeatureCount; ++f) {
    forest.provenance.feature_importance.push_back(f / 190.0);
  }
  writeForest(forest, pathOf("measured"));
  const ForestProvenance read = readForest(pathOf("measured")).provenance;
  ASSERT_EQ(read.reliability.size(), 2U);
  EXPECT_EQ(read.reliability[1].predicted, 0.95);
  EXPECT_EQ(read.reliability[1].observed, 0.875);
  EXPECT_EQ(read.reliability[1].samples, 8);
  EXPECT_EQ(read.calibration_error, 0.0375);
  EXPECT_EQ(read.feature_importance, forest.provenance.feature_importance);
}

/// Early forests of version 1 have no measures.
TEST(ForestFile, MayHoldNoMeasures) {
  writeForest(makeForest(2, 3, 1), pathOf("unmeasured"));
  EXPECT_EQ(contentOf(pathOf("unmeasured")).find("reliability"), std::string::npos);
  const ForestProvenance read = readForest(pathOf("unmeasured")).provenance;
  EXPECT_TRUE(read.reliability.empty());
  EXPECT_TRUE(read.feature_importance.empty());
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
  EXPECT_THAT(rejection(pathOf("nowhere")),
              AllOf(HasSubstr(pathOf("nowhere")), HasSubstr("cannot be opened")));
}

TEST(ForestFile, NamesDamage) {
  writeForest(makeForest(3, 4, 2), pathOf("good"));
  const std::string good = contentOf(pathOf("good"));
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "no valid JSON"},
      {"P5 1 1 255 x", "no valid JSON"},
      {good.substr(0, good.size() / 2), "no valid JSON"},
      {"[1, 2]", "not a forest"},
      {"{\"format\": \"other\"}", "not a forest"},
      {replaced(good, "\"version\": 1", "\"version\": 0"), "format version 0"},
      {replaced(good, "\"version\": 1", "\"version\": 3"), "format version 3"},
      {replaced(good, "\"version\": 1,", ""), "missing or misplaced entry"},
      {replaced(good, "\"bias\": -0.25", "\"bias\": -0.26"), "is damaged"},
      {replaced(good, "\"checksum\": \"", "\"checksum\": \"0"), "is damaged"}};
  for (const auto& [text, fault] : cases) {
    writeAll(pathOf("bad"), text);
    EXPECT_THAT(rejection(pathOf("bad")), AllOf(HasSubstr(pathOf("bad")), HasSubstr(fault)));
  }
}

/// Inputs that would overflow the stack, take minutes, or be read as another number.
TEST(ForestFile, RejectsHostileJson) {
  const auto fault = [](const std::string& text) {
    return errorText([&] { parseForest(text, "hostile"); });
  };
  const std::string depths(500000, '[');
  EXPECT_THAT(fault(R"({"format": "cbmv_stereo forest", "version": 1, "model": )" + depths),
              HasSubstr("64 nesting levels"));
  std::string keys = "{\"a\": 0";
  for (int i = 0; i < 100000; ++i) {
    keys += ", \"" + std::to_string(i) + "\": 0";
  }
  EXPECT_THAT(fault(keys + "}"), HasSubstr("4096 keys"));
  writeForest(makeForest(3, 4, 2), pathOf("good"));
  const std::string good = contentOf(pathOf("good"));
  for (const char* version : {"1.5", "1e300", "18446744073709551615"}) {
    EXPECT_THAT(fault(replaced(good, "\"version\": 1", std::string("\"version\": ") + version)),
                HasSubstr("whole number"));
  }
  for (const char* seed : {"-1", "1.5", "1e300"}) {
    EXPECT_THAT(fault(replaced(good, "\"seed\": 0", std::string("\"seed\": ") + seed)),
                HasSubstr("seed that is no whole number"));
  }
}

TEST(ForestFile, RejectsLargeFilesBeforeItReadsThem) {
  writeAll(pathOf("large"), "{");
  std::filesystem::resize_file(pathOf("large"), (64 << 20) + 1);
  EXPECT_THAT(rejection(pathOf("large")), HasSubstr("at most 64 MiB"));
  std::filesystem::remove(pathOf("large"));
}

TEST(ForestFile, RejectsToWriteWhatCannotBeRead) {
  const auto write_changed = [](const auto& change) {
    Forest forest = makeForest(3, 4, 2);
    change(forest);
    writeForest(forest, pathOf("rejected"));
  };
  EXPECT_THROW(write_changed([](Forest& f) { f.trees.clear(); }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.trees[1].levels.clear(); }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.trees[1].leaves.pop_back(); }), Error);
  EXPECT_THROW(write_changed([](Forest& f) {
                 f.trees[1].levels.resize(Forest::kMaxDepth + 1);
                 f.trees[1].leaves.resize(2 << Forest::kMaxDepth);
               }),
               Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.trees.resize(Forest::kMaxTrees + 1, f.trees[1]); }),
               Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.trees[0].levels[0].feature = 20; }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.quantizer.maps[7].scale = 0; }), Error);
  EXPECT_THROW(write_changed([](Forest& f) { f.bias = std::nan(""); }), Error);
  for (const double unit : {0.0, 1e3, std::nan("")}) {
    EXPECT_THROW(write_changed([unit](Forest& f) { f.leaf_unit = unit; }), Error);
  }
  EXPECT_THROW(writeForest(makeForest(1, 1, 1), "/nowhere/at/all.forest"), Error);
}

TEST(ForestFile, KeepsGeneralTrees) {
  Forest forest = makeGeneralForest(5, 40, 1);
  for (const ForestOutput output : {ForestOutput::kLogOdds, ForestOutput::kProbability}) {
    forest.output = output;
    writeForest(forest, pathOf("general"));
    const Forest read = readForest(pathOf("general"));
    EXPECT_EQ(read.output, output);
    EXPECT_EQ(read.bias, forest.bias);
    EXPECT_TRUE(read.trees.empty());
    ASSERT_EQ(read.general_trees.size(), forest.general_trees.size());
    for (std::size_t t = 0; t < forest.general_trees.size(); ++t) {
      const std::vector<DecisionTree::Node>& nodes = forest.general_trees[t].nodes;
      ASSERT_EQ(read.general_trees[t].nodes.size(), nodes.size());
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        EXPECT_EQ(read.general_trees[t].nodes[n].threshold, nodes[n].threshold);
        EXPECT_EQ(read.general_trees[t].nodes[n].feature, nodes[n].feature);
        EXPECT_EQ(read.general_trees[t].nodes[n].next, nodes[n].next);
      }
    }
    EXPECT_EQ(forestChecksum(read), forestChecksum(forest));
  }
}

/// The error message when the forest is written.
std::string rejectionToWrite(const Forest& forest) {
  try {
    writeForest(forest, pathOf("rejected"));
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(ForestFile, RejectsToWriteMoreThanIsRead) {
  Forest forest = makeForest(1, 1, 1);
  forest.provenance.options = std::string(64 << 20, 'x');
  EXPECT_THAT(rejectionToWrite(forest), AllOf(HasSubstr("rejected"), HasSubstr("64 MiB")));
}

TEST(ForestFile, GeneralTreesTakeNoMoreThanTheirNumbers) {
  const Forest forest = makeGeneralForest(5, 4000, 1);
  writeForest(forest, pathOf("compact"));
  EXPECT_LT(contentOf(pathOf("compact")).size(), 5 * 8001 * 15U);
}

TEST(ForestFile, RejectsGeneralTreesThatCannotBeWalked) {
  const auto changed = [](const auto& change) {
    Forest forest = makeGeneralForest(3, 10, 2);
    change(forest.general_trees[1].nodes);
    return rejectionToWrite(forest);
  };
  using Nodes = std::vector<DecisionTree::Node>;
  EXPECT_THAT(changed([](Nodes& nodes) { nodes.clear(); }), HasSubstr("tree 1 has no nodes"));
  EXPECT_THAT(changed([](Nodes& nodes) { nodes[0].next[0] = 21; }),
              HasSubstr("tree 1: node 0 goes on"));
  EXPECT_THAT(changed([](Nodes& nodes) { nodes[0].next[1] = 0; }), HasSubstr("goes on"));
  EXPECT_THAT(changed([](Nodes& nodes) { nodes.back().next = {0, 0}; }), HasSubstr("goes on"));
  EXPECT_THAT(changed([](Nodes& nodes) { nodes[0].feature = 20; }), HasSubstr("feature"));
  EXPECT_THAT(changed([](Nodes& nodes) { nodes[3].threshold = std::nanf(""); }),
              HasSubstr("reasonable size"));
  EXPECT_THAT(changed([](Nodes& nodes) {
                nodes.clear();  // a chain
                for (std::uint32_t n = 0; n < 400; n += 2) {
                  nodes.push_back({0, 0, {n + 1, n + 2}});
                  nodes.push_back({0, 0, {n + 1, n + 1}});
                }
                nodes.push_back({0, 0, {400, 400}});
              }),
              HasSubstr("more than 128 levels"));
  Forest both = makeGeneralForest(3, 10, 2);
  both.trees = makeForest(1, 1, 1).trees;
  EXPECT_THAT(rejectionToWrite(both), HasSubstr("both"));
}

Forest withConfidence(const ConfidenceForest& confidence) {
  Forest forest = makeForest(3, 4, 2);
  forest.confidence = std::make_shared<const ConfidenceForest>(confidence);
  return forest;
}

Forest withSelection(const ConfidenceForest& selection) {
  Forest forest = withConfidence(makeConfidenceForest(2, 3, 2, 5));
  forest.selection = std::make_shared<const ConfidenceForest>(selection);
  return forest;
}

TEST(ForestFile, KeepsTheConfidenceForest) {
  ConfidenceForest confidence = makeConfidenceForest(30, 20, 8, 5);
  addSigmaModel(confidence);
  confidence.record.reliability = {{0.05, 0.0625, 12}};
  confidence.record.calibration_error = 0.0375;
  confidence.record.feature_importance.assign(30, 1.0 / 32);
  const Forest forest = withConfidence(confidence);
  writeForest(forest, pathOf("both"));
  EXPECT_THAT(contentOf(pathOf("both")), HasSubstr("\"version\": 2"));
  const Forest read = readForest(pathOf("both"));
  EXPECT_EQ(read.trees.size(), 3U);
  EXPECT_EQ(read.provenance.options, forest.provenance.options);
  EXPECT_EQ(read.selection, nullptr);
  ASSERT_NE(read.confidence, nullptr);
  EXPECT_EQ(read.confidence->feature_names, confidence.feature_names);
  EXPECT_EQ(read.confidence->sigma_px, confidence.sigma_px);
  EXPECT_EQ(read.confidence->sigma_roughness_bounds, confidence.sigma_roughness_bounds);
  EXPECT_EQ(read.confidence->record.options, "trees 20");
  EXPECT_EQ(read.confidence->record.samples, 1234);
  EXPECT_EQ(read.confidence->record.held_out_log_loss, 0.375);
  EXPECT_EQ(read.confidence->record.reliability.at(0).samples, 12);
  EXPECT_EQ(read.confidence->record.calibration_error, 0.0375);
  EXPECT_EQ(read.confidence->record.feature_importance, confidence.record.feature_importance);
  EXPECT_EQ(forestChecksum(read), forestChecksum(forest));  // trees, maps and scale are equal
}

TEST(ForestFile, KeepsTheSelectionForest) {
  ConfidenceForest selection = makeConfidenceForest(7, 9, 4, 6);
  selection.record.feature_importance.assign(7, 1.0 / 8);
  const Forest forest = withSelection(selection);
  writeForest(forest, pathOf("three"));
  EXPECT_THAT(contentOf(pathOf("three")), HasSubstr("\"version\": 2"));
  const Forest read = readForest(pathOf("three"));
  ASSERT_NE(read.confidence, nullptr);
  ASSERT_NE(read.selection, nullptr);
  EXPECT_EQ(read.confidence->feature_names, forest.confidence->feature_names);
  EXPECT_EQ(read.confidence->record.options, "trees 3");
  EXPECT_EQ(read.selection->feature_names, selection.feature_names);
  EXPECT_EQ(read.selection->trees.size(), 9U);
  EXPECT_TRUE(read.selection->sigma_px.empty());
  EXPECT_EQ(read.selection->record.options, "trees 9");
  EXPECT_EQ(read.selection->record.feature_importance, selection.record.feature_importance);
  EXPECT_EQ(forestChecksum(read), forestChecksum(forest));
}

TEST(ForestFile, SelectionNeedsConfidence) {
  Forest forest = withSelection(makeConfidenceForest(2, 3, 2, 5));
  forest.confidence = nullptr;
  EXPECT_THAT(rejectionToWrite(forest), HasSubstr("selection forest without a confidence forest"));
  ConfidenceForest selection = makeConfidenceForest(2, 3, 2, 5);
  addSigmaModel(selection);
  EXPECT_THAT(rejectionToWrite(withSelection(selection)),
              HasSubstr("sigma_px in its selection forest"));
}

TEST(ForestFile, KeepsTheConfidenceForestOfGeneralTrees) {
  Forest forest = makeGeneralForest(2, 5, 1);
  forest.confidence = withConfidence(makeConfidenceForest(2, 1, 1, 1)).confidence;
  writeForest(forest, pathOf("both"));
  EXPECT_NE(readForest(pathOf("both")).confidence, nullptr);
}

/// Programs that support only version 1 can read it.
TEST(ForestFile, IsOfVersion1WithoutAConfidenceForest) {
  writeForest(makeForest(2, 3, 1), pathOf("one"));
  EXPECT_THAT(contentOf(pathOf("one")), HasSubstr("\"version\": 1"));
  EXPECT_EQ(readForest(pathOf("one")).confidence, nullptr);
}

TEST(ForestFile, ChecksumCoversTheFurtherForests) {
  ConfidenceForest confidence = makeConfidenceForest(2, 3, 2, 5);
  addSigmaModel(confidence);
  Forest forest = withConfidence(confidence);
  ConfidenceForest selection = makeConfidenceForest(6, 3, 2, 7);
  selection.bias = 0.875;
  forest.selection = std::make_shared<const ConfidenceForest>(selection);
  writeForest(forest, pathOf("both"));
  const std::string good = contentOf(pathOf("both"));
  for (const auto& [from, to] :
       {std::pair("\"f0\"", "\"g0\""), std::pair("\"bias\": 0.75", "\"bias\": 0.76"),
        std::pair("9.25", "9.26"), std::pair("200", "201"), std::pair("\"f5\"", "\"g5\""),
        std::pair("0.875", "0.876")}) {
    writeAll(pathOf("bad"), replaced(good, from, to));
    EXPECT_THAT(rejection(pathOf("bad")), HasSubstr("is damaged")) << from;
  }
}

TEST(ForestFile, NamesWhatIsWrongWithAConfidenceForest) {
  const auto fault = [](const auto& change) {
    ConfidenceForest confidence = makeConfidenceForest(5, 3, 4, 2);
    change(confidence);
    const std::string of_selection = rejectionToWrite(withSelection(confidence));
    const std::string of_confidence = rejectionToWrite(withConfidence(confidence));
    EXPECT_EQ(of_selection, of_confidence.empty()
                                ? ""
                                : replaced(of_confidence, "confidence forest", "selection forest"));
    return of_confidence;
  };
  using Changed = ConfidenceForest;
  const auto of_confidence = [](const char* text) {
    return HasSubstr(std::string("rejected: confidence forest: ") + text);
  };
  EXPECT_THAT(fault([](Changed& f) { f.feature_names.clear(); }),
              of_confidence("has 0 features instead of 1 to 64"));
  EXPECT_THAT(fault([](Changed& f) { f.feature_names.resize(65); }),
              of_confidence("has 65 features"));
  EXPECT_THAT(fault([](Changed& f) { f.feature_names[3].clear(); }),
              of_confidence("has no name for feature 3"));
  EXPECT_THAT(fault([](Changed& f) { f.feature_names[4] = "f1"; }),
              of_confidence("has the name \"f1\" twice, again for feature 4"));
  EXPECT_THAT(fault([](Changed& f) { f.trees.clear(); }), of_confidence("has 0 trees"));
  EXPECT_THAT(fault([](Changed& f) { f.trees.resize(257, f.trees[0]); }),
              of_confidence("has 257 trees instead of 1 to 256"));
  EXPECT_THAT(fault([](Changed& f) { f.trees[1].levels[0].feature = 5; }),
              of_confidence("tree 1 asks for feature 5 of 5"));
  EXPECT_THAT(fault([](Changed& f) { f.trees[1].leaves.pop_back(); }),
              of_confidence("tree 1 has 3 leaves for 2 levels"));
  EXPECT_THAT(fault([](Changed& f) { f.bias = std::nan(""); }), of_confidence("has a leaf unit"));
  EXPECT_THAT(fault([](Changed& f) {
                f.record.feature_importance = {0.5, 0.5};
              }),
              of_confidence("has the importance of 2 features instead of 5"));
  EXPECT_EQ(fault([](Changed&) {}), "");
}

TEST(ForestFile, NamesWhatIsWrongWithAModelOfTheStandardDeviation) {
  const auto fault = [](const auto& change) {
    ConfidenceForest confidence = makeConfidenceForest(5, 3, 4, 2);
    addSigmaModel(confidence);
    change(confidence);
    return rejectionToWrite(withConfidence(confidence));
  };
  using Changed = ConfidenceForest;
  EXPECT_EQ(fault([](Changed&) {}), "");
  EXPECT_THAT(fault([](Changed& f) { f.feature_names.back() = "f4"; }),
              HasSubstr("confidence forest: has sigma_px without the feature \"roughness_5\""));
  EXPECT_THAT(fault([](Changed& f) { f.sigma_px.pop_back(); }),
              HasSubstr("has 39 values of sigma_px instead of 40"));
  EXPECT_THAT(fault([](Changed& f) { f.sigma_px.push_back(1); }), HasSubstr("has 41 values"));
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double sigma : {0.0, -1.0, 10.001, infinite, std::nan("")}) {
    EXPECT_THAT(fault([&](Changed& f) { f.sigma_px[39] = sigma; }),
                HasSubstr("has a value of sigma_px that is not in (0, 10]"))
        << sigma;
  }
  for (const std::array<std::uint8_t, 3> bounds :
       {std::array<std::uint8_t, 3>{3, 2, 4}, {1, 2, 2}}) {
    EXPECT_THAT(fault([&](Changed& f) { f.sigma_roughness_bounds = bounds; }),
                HasSubstr("has sigma_roughness_bounds that do not rise"));
  }
}

/// The error message for a text; empty if it is a valid forest.
std::string rejectionOfText(const std::string& text) {
  try {
    parseForest(text, "folder/text");
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

/// The same for a model, with its checksum, in a file of this version.
std::string rejectionOfModel(const std::string& model, int version = 1) {
  const std::string text = R"({"format": "cbmv_stereo forest", "version": )" +
                           std::to_string(version) +
                           R"(, "provenance": {"program": "", "data_set": "", "scenes": [],
                           "options": "", "samples": 1, "seed": 1, "held_out_log_loss": 0,
                           "confidence_forest": {"options": "", "samples": 1,
                                                 "held_out_log_loss": 0},
                           "selection_forest": {"options": "", "samples": 1,
                                                "held_out_log_loss": 0}},
                           "checksum": "%", "model": )" +
                           model + "}";
  const std::string fault = rejectionOfText(text);
  return rejectionOfText(replaced(text, "%", fault.substr(fault.size() - 8)));
}

TEST(ForestFile, NamesUnknownKind) {
  EXPECT_THAT(rejectionOfModel(R"({"features": 20, "bias": 0, "kind": "dense", "trees": []})"),
              HasSubstr("kind \"dense\""));
}

/// Values that would be written outside the forest or truncated to other numbers.
TEST(ForestFile, RejectsNumbersThatDoNotFitATree) {
  const auto error_of = [](int code_maps, const std::string& level, const std::string& leaf) {
    std::string maps = "[1, 0]";
    for (int i = 1; i < code_maps; ++i) {
      maps += ", [1, 0]";
    }
    return rejectionOfModel(R"({"features": 20, "bias": 0, "leaf_unit": 1, "code_maps": [)" + maps +
                            R"(], "trees": [{"levels": [)" + level + R"(], "leaves": [0, )" + leaf +
                            "]}]}");
  };
  EXPECT_EQ(error_of(20, "[19, 255]", "127"), "");
  EXPECT_THAT(error_of(19, "[19, 255]", "127"), HasSubstr("19 code maps instead of 20"));
  EXPECT_THAT(error_of(21, "[19, 255]", "127"), HasSubstr("21 code maps instead of 20"));
  EXPECT_THAT(error_of(20, "[20, 255]", "127"), HasSubstr("feature is 20"));
  EXPECT_THAT(error_of(20, "[-1, 255]", "127"), HasSubstr("feature is -1"));
  EXPECT_THAT(error_of(20, "[19, 256]", "127"), HasSubstr("threshold is 256"));
  EXPECT_THAT(error_of(20, "[19, 255]", "128"), HasSubstr("leaf is 128"));
  EXPECT_THAT(error_of(20, "[19, 255]", "-129"), HasSubstr("leaf is -129"));
}

/// The same for the second forests in a file; the message names the forest.
TEST(ForestFile, RejectsNumbersThatDoNotFitTheFurtherForests) {
  const auto further = [](const std::string& level, const std::string& sigma = "") {
    return R"({"features": ["a", "roughness_5"], "bias": 0, "leaf_unit": 1, "trees": [
               {"levels": [)" +
           level + R"(], "leaves": [0, 1]}])" + sigma + "}";
  };
  const auto error_of = [](const std::string& confidence, const std::string& selection,
                           int version = 2) {
    return rejectionOfModel(R"({"features": 20, "kind": "general", "output": "log_odds", "bias": 0,
                              "trees": [{"nodes": [0]}], "confidence_forest": )" +
                                confidence + R"(, "selection_forest": )" + selection + "}",
                            version);
  };
  const std::string good = further("[1, 255]");
  EXPECT_EQ(error_of(good, good), "");
  EXPECT_THAT(error_of(further("[2, 255]"), good),
              HasSubstr("folder/text: confidence forest: a tree's feature is 2"));
  EXPECT_THAT(error_of(good, further("[2, 255]")),
              HasSubstr("folder/text: selection forest: a tree's feature is 2"));
  EXPECT_THAT(error_of(good, "{}"),
              AllOf(HasSubstr("selection forest: has a missing"), HasSubstr("key 'features'")));
  EXPECT_EQ(error_of("{}", "{}", 1), "");  // version 1 has no such entries
}

TEST(ForestFile, RejectsNumbersThatDoNotFitTheModelOfTheStandardDeviation) {
  const auto error_of = [](const std::string& bounds) {
    std::string sigmas = "1";
    for (int k = 1; k < 40; ++k) {
      sigmas += ", 10";
    }
    return rejectionOfModel(R"({"features": 20, "kind": "general", "output": "log_odds", "bias": 0,
                              "trees": [{"nodes": [0]}], "confidence_forest": {
                              "features": ["roughness_5"], "bias": 0, "leaf_unit": 1, "trees": [
                              {"levels": [[0, 1]], "leaves": [0, 1]}], "sigma_px": [)" +
                                sigmas + "]" + bounds + "}}",
                            2);
  };
  EXPECT_EQ(error_of(R"(, "sigma_roughness_bounds": [0, 1, 255])"), "");
  EXPECT_THAT(error_of(""), HasSubstr("key 'sigma_roughness_bounds'"));
  EXPECT_THAT(error_of(R"(, "sigma_roughness_bounds": [0, 1])"), HasSubstr("has 2 sigma_rough"));
  EXPECT_THAT(error_of(R"(, "sigma_roughness_bounds": [0, 1, 2, 3])"), HasSubstr("has 4 sigma"));
  EXPECT_THAT(error_of(R"(, "sigma_roughness_bounds": [0, 1, 256])"), HasSubstr("is 256"));
  EXPECT_THAT(error_of(R"(, "sigma_roughness_bounds": [0, 1, 1.5])"), HasSubstr("whole number"));
  EXPECT_THAT(error_of(R"(, "sigma_roughness_bounds": 7)"), HasSubstr("has 1 sigma_rough"));
}

/// As written by XGBoost; the first tree tests whether feature 3 is below 1.5.
const std::string kXgboostModel = R"({"learner": {
  "attributes": {}, "feature_names": [], "feature_types": [],
  "gradient_booster": {"name": "gbtree", "model": {"trees": [
    {"left_children": [1, -1, -1], "right_children": [2, -1, -1], "split_indices": [3, 0, 0],
     "split_conditions": [1.5E0, -2.5E-1, 7.5E-1], "split_type": [0, 0, 0],
     "default_left": [0, 0, 0], "tree_param": {"num_nodes": "3"}}]}},
  "learner_model_param": {"base_score": "2.5E-1", "num_class": "0", "num_feature": "20"},
  "objective": {"name": "binary:logistic"}}, "version": [1, 7, 4]})";

TEST(ForestFile, ReadsAModelOfXgboost) {
  const Forest forest = parseForest(kXgboostModel, "folder/model.json");
  EXPECT_EQ(forest.name, "model.json");
  EXPECT_EQ(forest.provenance.program, "XGBoost 1.7.4");
  const auto probability = [&forest](float value) {
    return naiveProbability(forest, [value](int f) { return f == 3 ? value : 0.0F; });
  };
  EXPECT_NEAR(probability(1.4F), 1 / (1 + 3 * std::exp(0.25)), 1e-12);
  EXPECT_NEAR(probability(1.5F), 1 / (1 + 3 * std::exp(-0.75)), 1e-12);
  const Forest mean =
      parseForest(replaced(replaced(kXgboostModel, "binary:logistic", "reg:squarederror"),
                           "2.5E-1\"", "[5E-1]\""),
                  "mean");
  EXPECT_EQ(mean.output, ForestOutput::kProbability);
  EXPECT_EQ(mean.bias, 0.5);
}

TEST(ForestFile, NamesWhatIsWrongWithAModelOfXgboost) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"gbtree", "dart", "gbtree"},
      {"binary:logistic", "multi:softprob", "multi:softprob"},
      {"\"2.5E-1\"", "\"1\"", "base score"},
      {"\"2.5E-1\"", "\"x\"", "no valid JSON"},
      {"\"2.5E-1\"", "\"" + std::string(65, '[') + "\"", "64 nesting levels"},
      {"\"20\"", "\"4\"", "20 features"},
      {"\"feature_names\": []", "\"feature_names\": [\"f0\"]", "another order"},
      {"\"split_type\": [0", "\"split_type\": [1", "categories"},
      {"[1, -1, -1]", "[0, -1, -1]", "goes on with"},
      {"[1, -1, -1]", "[3, -1, -1]", "goes on with"},
      {"[2, -1, -1]", "[-1, -1, -1]", "place of a node"},
      {"[2, -1, -1]", "[]", "missing or misplaced"},
      {"[3, 0, 0]", "[20, 0, 0]", "feature is 20"},
      {"1.5E0", "1e99", "reasonable size"},
      {"\"right_children\"", "\"right\"", "missing or misplaced"}};
  for (const auto& [from, to, fault] : cases) {
    EXPECT_THAT(rejectionOfText(replaced(kXgboostModel, from, to)),
                AllOf(HasSubstr("folder/text"), HasSubstr(fault)))
        << from << " to " << to;
  }
}

/// They contain second forests, and their models are read completely.
TEST(ForestFile, ShippedForestsKeepTheirChecksums) {
  for (const char* name : {"middlebury", "middlebury_small", "middlebury_without_motorcycle"}) {
    const std::string path = std::string(CBMV_SOURCE_DIR "/models/") + name + ".forest";
    const std::string head = contentOf(path).substr(0, 16384);
    EXPECT_THAT(head, HasSubstr("\"version\": 2"));
    EXPECT_TRUE(mentions(head, {"\"checksum\": \"" + forestChecksum(readForest(path)) + "\""}));
  }
}

TEST(ForestFile, ShippedForestNamesItsScenes) {
  const Forest forest = readForest(CBMV_SOURCE_DIR "/models/middlebury.forest");
  EXPECT_EQ(forest.provenance.scenes.size(), 15U);
}

}  // namespace
}  // namespace cbmv::test
