#include "cbmv_stereo/forest/forest_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "../io/bounded_json.h"
#include "../io/crc32_text.h"
#include "forest_json.h"

#include "cbmv_stereo/confidence/feature_names.h"
#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr const char* kFormat = "cbmv_stereo forest";
constexpr int kVersion = 1;
constexpr const char* kOblivious = "oblivious";
constexpr const char* kGeneral = "general";
constexpr const char* kLogOdds = "log_odds";
constexpr const char* kProbability = "probability";
constexpr std::streamoff kLargestFile = 64 << 20;
constexpr int kIndentation = 1;
constexpr int kOneLine = -1;
constexpr std::int64_t kLargestNumber = std::numeric_limits<std::int64_t>::max();

[[noreturn]] void fail(const std::string& file, const std::string& fault) {
  throw Error("forest " + file + ": " + fault);
}

constexpr float kLargestThreshold = 1e30F;

/// CRC-32 of the text of everything that changes the forest's answers.
std::string checksum(const Json& model) { return crc32Text(model.dump()); }

Json treeToJson(const ObliviousTree& tree) {
  Json levels = Json::array();
  for (const ObliviousTree::Level& level : tree.levels) {
    levels.push_back({level.feature, level.threshold});
  }
  return {{"levels", levels}, {"leaves", tree.leaves}};
}

Json treeToJson(const DecisionTree& tree) {
  Json nodes = Json::array();
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    const DecisionTree::Node& node = tree.nodes[n];
    if (tree.isLeaf(n)) {
      nodes.push_back(node.threshold);
    } else {
      nodes.push_back({node.feature, node.threshold, node.next[0], node.next[1]});
    }
  }
  return {{"nodes", nodes}};
}

template <typename Tree>
Json treesToJson(const std::vector<Tree>& trees) {
  Json array = Json::array();
  for (const Tree& tree : trees) {
    array.push_back(treeToJson(tree));
  }
  return array;
}

Json modelToJson(const Forest& forest) {
  Json model;
  model["features"] = kFeatureCount;
  if (!forest.general_trees.empty()) {
    model["kind"] = kGeneral;
    model["output"] = forest.output == ForestOutput::kLogOdds ? kLogOdds : kProbability;
    model["bias"] = forest.bias;
    model["trees"] = treesToJson(forest.general_trees);
    return model;
  }
  model["leaf_unit"] = forest.leaf_unit;
  model["bias"] = forest.bias;
  for (const CodeMap& map : forest.quantizer.maps) {
    model["code_maps"].push_back({map.scale, map.offset});
  }
  model["trees"] = treesToJson(forest.trees);
  return model;
}

/// What was not measured is left out.
void addMeasures(const ForestProvenance& provenance, Json& json) {
  if (!provenance.reliability.empty()) {
    json["calibration_error"] = provenance.calibration_error;
    for (const ReliabilityBin& bin : provenance.reliability) {
      json["reliability"].push_back({bin.predicted, bin.observed, bin.samples});
    }
  }
  for (std::size_t f = 0; f < provenance.feature_importance.size(); ++f) {
    json["feature_importance"][kFeatureNames.at(f)] = provenance.feature_importance[f];
  }
}

Json provenanceToJson(const ForestProvenance& provenance) {
  Json json = {{"program", provenance.program},
               {"data_set", provenance.data_set},
               {"scenes", provenance.scenes},
               {"options", provenance.options},
               {"samples", provenance.samples},
               {"seed", provenance.seed},
               {"held_out_log_loss", provenance.held_out_log_loss}};
  addMeasures(provenance, json);
  return json;
}

ObliviousTree treeFromJson(const Json& json) {
  ObliviousTree tree;
  for (const Json& level : json.at("levels")) {
    tree.levels.push_back(
        {static_cast<std::uint8_t>(
             integerIn(level.at(0), 0, kFeatureCount - 1, "a tree's feature")),
         static_cast<std::uint8_t>(integerIn(level.at(1), 0, 255, "a tree's threshold"))});
  }
  for (const Json& leaf : json.at("leaves")) {
    tree.leaves.push_back(static_cast<std::int8_t>(integerIn(leaf, -128, 127, "a tree's leaf")));
  }
  return tree;
}

void obliviousFromJson(const Json& model, Forest& forest) {
  forest.leaf_unit = model.at("leaf_unit").get<double>();
  const Json& maps = model.at("code_maps");
  if (maps.size() != forest.quantizer.maps.size()) {
    throw Fault("it has " + std::to_string(maps.size()) + " code maps instead of " +
                std::to_string(kFeatureCount));
  }
  for (std::size_t f = 0; f < maps.size(); ++f) {
    forest.quantizer.maps[f] = {maps[f].at(0).get<float>(), maps[f].at(1).get<float>()};
  }
  for (const Json& tree : model.at("trees")) {
    forest.trees.push_back(treeFromJson(tree));
  }
}

void generalFromJson(const Json& model, Forest& forest) {
  const auto output = model.at("output").get<std::string>();
  if (output != kLogOdds && output != kProbability) {
    throw Fault("has the output \"" + output + "\", not \"" + kLogOdds + "\" or \"" + kProbability +
                "\"");
  }
  forest.output = output == kLogOdds ? ForestOutput::kLogOdds : ForestOutput::kProbability;
  for (const Json& json : model.at("trees")) {
    DecisionTree tree;
    for (const Json& node : json.at("nodes")) {
      tree.nodes.push_back(node.is_array()
                               ? innerNode(node.at(0), node.at(1), node.at(2), node.at(3))
                               : leafNode(node, tree.nodes.size()));
    }
    forest.general_trees.push_back(tree);
  }
}

void modelFromJson(const Json& model, Forest& forest) {
  integerIn(model.at("features"), kFeatureCount, kFeatureCount, "the number of features");
  forest.bias = model.at("bias").get<double>();
  const std::string kind = model.value("kind", kOblivious);
  if (kind == kOblivious) {
    obliviousFromJson(model, forest);
  } else if (kind == kGeneral) {
    generalFromJson(model, forest);
  } else {
    throw Fault("is of the kind \"" + kind + "\", not \"" + kOblivious + "\" or \"" + kGeneral +
                "\"");
  }
}

/// Forests that were written before there were measures have none.
void readMeasures(const Json& json, ForestProvenance& provenance) {
  if (json.contains("reliability")) {
    provenance.calibration_error = json.at("calibration_error").get<double>();
    for (const Json& bin : json["reliability"]) {
      provenance.reliability.push_back(
          {bin.at(0).get<double>(), bin.at(1).get<double>(),
           integerIn(bin.at(2), 0, kLargestNumber, "the number of samples of a bin")});
    }
  }
  if (json.contains("feature_importance")) {
    for (const char* name : kFeatureNames) {
      provenance.feature_importance.push_back(json["feature_importance"].at(name).get<double>());
    }
  }
}

std::uint64_t seedFromJson(const Json& json) {
  if (!json.is_number_unsigned()) {
    throw Fault("has a seed that is no whole number from 0 on");
  }
  return json.get<std::uint64_t>();
}

ForestProvenance provenanceFromJson(const Json& json) {
  ForestProvenance provenance;
  provenance.program = json.at("program").get<std::string>();
  provenance.data_set = json.at("data_set").get<std::string>();
  provenance.scenes = json.at("scenes").get<std::vector<std::string>>();
  provenance.options = json.at("options").get<std::string>();
  provenance.samples = integerIn(json.at("samples"), 0, kLargestNumber, "the number of samples");
  provenance.seed = seedFromJson(json.at("seed"));
  provenance.held_out_log_loss = json.at("held_out_log_loss").get<double>();
  readMeasures(json, provenance);
  return provenance;
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) {
    fail(path, "cannot be opened; give the path of a file that cbmv_train wrote");
  }
  const std::streamoff size = file.tellg();
  if (size < 0 || size > kLargestFile) {
    fail(path, "is not a forest file, which has at most 64 MiB");
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  if (!file.read(text.data(), size)) {
    fail(path, "cannot be read");
  }
  return text;
}

Forest forestFromJson(const Json& json) {
  if (json.is_object() && json.contains("learner")) {
    return forestFromXgboost(json);
  }
  if (!json.is_object() || json.value("format", "") != kFormat) {
    throw Fault(std::string("has no \"format\": \"") + kFormat + "\", so it is not a forest");
  }
  const auto version = integerIn(json.at("version"), 0, kLargestNumber, "the format version");
  if (version != kVersion) {
    throw Fault("has format version " + std::to_string(version) + ", this program reads version " +
                std::to_string(kVersion));
  }
  const Json& model = json.at("model");
  const auto stored = json.at("checksum").get<std::string>();
  if (stored != checksum(model)) {
    throw Fault("is damaged: its checksum is " + stored + ", its content has " + checksum(model));
  }
  Forest forest;
  modelFromJson(model, forest);
  forest.provenance = provenanceFromJson(json.at("provenance"));
  return forest;
}

/// `fault` is a text; where all is good, no string is made of it.
template <typename Text>
void check(bool good, const Text& fault) {
  if (!good) {
    throw Fault(fault);
  }
}

void checkTree(const ObliviousTree& tree, const std::string& name) {
  check(!tree.levels.empty() && tree.levels.size() <= Forest::kMaxDepth,
        name + " has " + std::to_string(tree.levels.size()) + " levels instead of 1 to " +
            std::to_string(Forest::kMaxDepth));
  check(tree.leaves.size() == std::size_t{1} << tree.levels.size(),
        name + " has " + std::to_string(tree.leaves.size()) + " leaves for " +
            std::to_string(tree.levels.size()) + " levels");
  for (const ObliviousTree::Level& level : tree.levels) {
    check(level.feature < kFeatureCount, name + " asks for feature " +
                                             std::to_string(level.feature) + " of " +
                                             std::to_string(kFeatureCount));
  }
}

void checkNode(const DecisionTree& tree, std::uint32_t n) {
  const DecisionTree::Node& node = tree.nodes[n];
  check(std::abs(node.threshold) < kLargestThreshold,
        "has a threshold or value that is not a number of reasonable size");
  check(node.feature < kFeatureCount, "asks for a feature that there is not");
  const bool leaf = node.next[0] == n && node.next[1] == n;
  for (const std::uint32_t next : node.next) {
    check(leaf || (next > n && next < tree.nodes.size()),
          "goes on with a node that does not lie behind it");
  }
}

void checkTree(const DecisionTree& tree, const std::string& name) {
  check(!tree.nodes.empty(), name + " has no nodes");
  std::vector<int> depths(tree.nodes.size(), 0);
  std::uint32_t n = 0;
  try {
    for (; n < tree.nodes.size(); ++n) {
      checkNode(tree, n);
      for (const std::uint32_t next : tree.nodes[n].next) {
        depths[next] = std::max(depths[next], depths[n] + (next == n ? 0 : 1));
      }
    }
  } catch (const Fault& fault) {
    throw Fault(name + ": node " + std::to_string(n) + " " + fault.what());
  }
  check(*std::max_element(depths.begin(), depths.end()) <= DecisionTree::kMaxDepth,
        name + " has more than " + std::to_string(DecisionTree::kMaxDepth) + " levels");
}

template <typename Tree>
void checkTrees(const std::vector<Tree>& trees) {
  check(!trees.empty() && trees.size() <= Forest::kMaxTrees, "has " + std::to_string(trees.size()) +
                                                                 " trees instead of 1 to " +
                                                                 std::to_string(Forest::kMaxTrees));
  for (std::size_t t = 0; t < trees.size(); ++t) {
    checkTree(trees[t], "tree " + std::to_string(t));
  }
}

void checkForest(const Forest& forest) {
  check(forest.trees.empty() || forest.general_trees.empty(),
        "has both oblivious and general trees");
  if (forest.general_trees.empty()) {
    checkTrees(forest.trees);
  } else {
    checkTrees(forest.general_trees);
  }
  check(forest.leaf_unit > 0 && forest.leaf_unit < 1e3 && std::abs(forest.bias) < 1e3,
        "has a leaf unit or bias that is not a number of reasonable size");
  for (const CodeMap& map : forest.quantizer.maps) {
    check(std::isfinite(map.scale) && std::isfinite(map.offset) && map.scale > 0,
          "has a code map that is not finite and increasing");
  }
}

}  // namespace

std::string forestChecksum(const Forest& forest) { return checksum(modelToJson(forest)); }

void validateForest(const Forest& forest, const std::string& file_name) {
  try {
    checkForest(forest);
  } catch (const Fault& fault) {
    fail(file_name, fault.what());
  }
}

Forest parseForest(const std::string& text, const std::string& file_name) {
  try {
    Forest forest = forestFromJson(parseBounded<Json>(text));
    forest.name = file_name.substr(file_name.find_last_of('/') + 1);
    checkForest(forest);
    return forest;
  } catch (const Json::parse_error& error) {
    fail(file_name,
         "is not a forest, or cut off: no valid JSON at byte " + std::to_string(error.byte));
  } catch (const Json::exception& error) {
    fail(file_name, std::string("has a missing or misplaced entry: ") + error.what());
  } catch (const JsonTooLarge& error) {
    fail(file_name, std::string("is not a forest, it ") + error.what());
  } catch (const Fault& fault) {
    fail(file_name, fault.what());
  }
}

Forest readForest(const std::string& path) { return parseForest(readText(path), path); }

void writeForest(const Forest& forest, const std::string& path) {
  validateForest(forest, path);
  const Json model = modelToJson(forest);
  const Json json = {{"format", kFormat},
                     {"version", kVersion},
                     {"provenance", provenanceToJson(forest.provenance)},
                     {"checksum", checksum(model)},
                     {"model", model}};
  // Indented, the millions of nodes of general trees take more than twice the space.
  const std::string text = json.dump(forest.general_trees.empty() ? kIndentation : kOneLine);
  if (text.size() >= static_cast<std::size_t>(kLargestFile)) {
    fail(path, "would have " + std::to_string(text.size() >> 20) +
                   " MiB, and 64 MiB are read at most; grow fewer trees, or more samples a leaf");
  }
  std::ofstream file(path, std::ios::binary);
  file << text << '\n';
  file.close();
  if (!file) {
    fail(path, "cannot be written");
  }
}

}  // namespace cbmv
