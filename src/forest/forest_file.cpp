#include "forest/forest_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>

#include "confidence/feature_names.h"
#include "forest/forest_json.h"
#include "io/bounded_json.h"
#include "io/crc32_text.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr const char* kFormat = "cbmv_stereo forest";
constexpr int kVersion = 2;             ///< highest supported version
constexpr int kVersionOfOneForest = 1;  ///< without additional forests; older programs can read it
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

std::string keyOf(const ConfidenceStage& stage) { return std::string(stage.name) + "_forest"; }

/// A fault in an additional forest.
Fault ofStage(const ConfidenceStage& stage, const std::string& fault) {
  return Fault(std::string(stage.name) + " forest: " + fault);
}

std::string misplaced(const Json::exception& error) {
  return std::string("has a missing or misplaced entry: ") + error.what();
}

/// CRC-32 of the text of everything that affects the results of the forest.
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

void addScale(const ObliviousForest& forest, Json& model) {
  model["leaf_unit"] = forest.leaf_unit;
  model["bias"] = forest.bias;
}

Json confidenceToJson(const ConfidenceForest& forest) {
  Json model;
  model["features"] = forest.feature_names;
  addScale(forest, model);
  model["trees"] = treesToJson(forest.trees);
  if (!forest.sigma_px.empty()) {
    model["sigma_roughness_bounds"] = forest.sigma_roughness_bounds;
    model["sigma_px"] = forest.sigma_px;
  }
  return model;
}

Json modelToJson(const Forest& forest) {
  Json model;
  model["features"] = kFeatureCount;
  if (forest.general_trees.empty()) {
    addScale(forest, model);
    for (const CodeMap& map : forest.quantizer.maps) {
      model["code_maps"].push_back({map.scale, map.offset});
    }
    model["trees"] = treesToJson(forest.trees);
  } else {
    model["kind"] = kGeneral;
    model["output"] = forest.output == ForestOutput::kLogOdds ? kLogOdds : kProbability;
    model["bias"] = forest.bias;
    model["trees"] = treesToJson(forest.general_trees);
  }
  for (const ConfidenceStage& stage : kConfidenceStages) {
    if (forest.*stage.forest != nullptr) {
      model[keyOf(stage)] = confidenceToJson(*(forest.*stage.forest));
    }
  }
  return model;
}

/// Measures that do not exist are not written.
template <typename Names>
void addRecord(const TrainingRecord& record, const Names& feature_names, Json& json) {
  json["options"] = record.options;
  json["samples"] = record.samples;
  json["held_out_log_loss"] = record.held_out_log_loss;
  if (!record.reliability.empty()) {
    json["calibration_error"] = record.calibration_error;
    for (const ReliabilityBin& bin : record.reliability) {
      json["reliability"].push_back({bin.predicted, bin.observed, bin.samples});
    }
  }
  for (std::size_t f = 0; f < record.feature_importance.size(); ++f) {
    json["feature_importance"][feature_names.at(f)] = record.feature_importance[f];
  }
}

Json provenanceToJson(const Forest& forest) {
  const ForestProvenance& provenance = forest.provenance;
  Json json = {{"program", provenance.program},
               {"data_set", provenance.data_set},
               {"scenes", provenance.scenes},
               {"seed", provenance.seed}};
  addRecord(provenance, kFeatureNames, json);
  for (const ConfidenceStage& stage : kConfidenceStages) {
    if (const ConfidenceForest* further = (forest.*stage.forest).get()) {
      addRecord(further->record, further->feature_names, json[keyOf(stage)]);
    }
  }
  return json;
}

ObliviousTree treeFromJson(const Json& json, std::size_t features) {
  ObliviousTree tree;
  for (const Json& level : json.at("levels")) {
    tree.levels.push_back(
        {static_cast<std::uint8_t>(integerIn(
             level.at(0), 0, static_cast<std::int64_t>(features) - 1, "a tree's feature")),
         static_cast<std::uint8_t>(integerIn(level.at(1), 0, 255, "a tree's threshold"))});
  }
  for (const Json& leaf : json.at("leaves")) {
    tree.leaves.push_back(static_cast<std::int8_t>(integerIn(leaf, -128, 127, "a tree's leaf")));
  }
  return tree;
}

void obliviousFromJson(const Json& model, std::size_t features, ObliviousForest& forest) {
  forest.leaf_unit = model.at("leaf_unit").get<double>();
  forest.bias = model.at("bias").get<double>();
  for (const Json& tree : model.at("trees")) {
    forest.trees.push_back(treeFromJson(tree, features));
  }
}

FeatureQuantizer quantizerFromJson(const Json& pairs) {
  FeatureQuantizer quantizer;
  if (pairs.size() != quantizer.maps.size()) {
    throw Fault("has " + std::to_string(pairs.size()) + " code maps instead of " +
                std::to_string(quantizer.maps.size()));
  }
  for (std::size_t f = 0; f < quantizer.maps.size(); ++f) {
    quantizer.maps[f] = {pairs[f].at(0).get<float>(), pairs[f].at(1).get<float>()};
  }
  return quantizer;
}

void generalFromJson(const Json& model, Forest& forest) {
  const auto output = model.at("output").get<std::string>();
  if (output != kLogOdds && output != kProbability) {
    throw Fault("has the output \"" + output + "\", not \"" + kLogOdds + "\" or \"" + kProbability +
                "\"");
  }
  forest.output = output == kLogOdds ? ForestOutput::kLogOdds : ForestOutput::kProbability;
  forest.bias = model.at("bias").get<double>();
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
  const std::string kind = model.value("kind", kOblivious);
  if (kind == kOblivious) {
    forest.quantizer = quantizerFromJson(model.at("code_maps"));
    obliviousFromJson(model, kFeatureCount, forest);
  } else if (kind == kGeneral) {
    generalFromJson(model, forest);
  } else {
    throw Fault("is of the kind \"" + kind + "\", not \"" + kOblivious + "\" or \"" + kGeneral +
                "\"");
  }
}

/// Measures are optional, because older files do not have them.
template <typename Names>
void readRecord(const Json& json, const Names& feature_names, TrainingRecord& record) {
  record.options = json.at("options").get<std::string>();
  record.samples = integerIn(json.at("samples"), 0, kLargestNumber, "the number of samples");
  record.held_out_log_loss = json.at("held_out_log_loss").get<double>();
  if (json.contains("reliability")) {
    record.calibration_error = json.at("calibration_error").get<double>();
    for (const Json& bin : json["reliability"]) {
      record.reliability.push_back(
          {bin.at(0).get<double>(), bin.at(1).get<double>(),
           integerIn(bin.at(2), 0, kLargestNumber, "the number of samples of a bin")});
    }
  }
  if (json.contains("feature_importance")) {
    for (const auto& name : feature_names) {
      record.feature_importance.push_back(
          json["feature_importance"].at(name).template get<double>());
    }
  }
}

void sigmaFromJson(const Json& model, ConfidenceForest& forest) {
  forest.sigma_px = model.at("sigma_px").get<std::vector<double>>();
  const Json& bounds = model.at("sigma_roughness_bounds");
  if (bounds.size() != forest.sigma_roughness_bounds.size()) {
    throw Fault("has " + std::to_string(bounds.size()) + " sigma_roughness_bounds instead of " +
                std::to_string(forest.sigma_roughness_bounds.size()));
  }
  std::transform(bounds.begin(), bounds.end(), forest.sigma_roughness_bounds.begin(),
                 [](const Json& bound) {
                   return static_cast<std::uint8_t>(
                       integerIn(bound, 0, 255, "one of its sigma_roughness_bounds"));
                 });
}

ConfidenceForest confidenceFromJson(const Json& model, const Json& record) {
  ConfidenceForest forest;
  forest.feature_names = model.at("features").get<std::vector<std::string>>();
  obliviousFromJson(model, forest.feature_names.size(), forest);
  if (model.contains("sigma_px")) {
    sigmaFromJson(model, forest);
  }
  readRecord(record, forest.feature_names, forest.record);
  return forest;
}

/// Reads the additional forests of the file.
void stagesFromJson(const Json& model, const Json& provenance, Forest& forest) {
  for (const ConfidenceStage& stage : kConfidenceStages) {
    const std::string key = keyOf(stage);
    try {
      if (model.contains(key)) {
        forest.*stage.forest = std::make_shared<const ConfidenceForest>(
            confidenceFromJson(model[key], provenance.at(key)));
      }
    } catch (const Fault& fault) {
      throw ofStage(stage, fault.what());
    } catch (const Json::exception& error) {
      throw ofStage(stage, misplaced(error));
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
  provenance.seed = seedFromJson(json.at("seed"));
  readRecord(json, kFeatureNames, provenance);
  return provenance;
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) {
    fail(path, "cannot be opened. Give the path of a file that cbmv_train wrote");
  }
  const std::streamoff size = file.tellg();
  if (size < 0 || size > kLargestFile) {
    fail(path,
         "is not a forest file, expected at most 64 MiB. Give the path of a file that cbmv_train "
         "wrote");
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  if (!file.read(text.data(), size)) {
    fail(path, "cannot be read. Copy the file again");
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
  if (version < kVersionOfOneForest || version > kVersion) {
    throw Fault("has format version " + std::to_string(version) +
                ", this program reads the versions " + std::to_string(kVersionOfOneForest) +
                " to " + std::to_string(kVersion) +
                "; use the version of cbmv_stereo that wrote it, or train the forest again");
  }
  const Json& model = json.at("model");
  const auto stored = json.at("checksum").get<std::string>();
  if (stored != checksum(model)) {
    throw Fault("is damaged: its checksum is " + stored + ", its content has " + checksum(model));
  }
  Forest forest;
  modelFromJson(model, forest);
  const Json& provenance = json.at("provenance");
  forest.provenance = provenanceFromJson(provenance);
  if (version > kVersionOfOneForest) {
    stagesFromJson(model, provenance, forest);
  }
  return forest;
}

/// Builds the message only on error: `fault` is a text, converted to a string if it is thrown.
template <typename Text>
void check(bool good, const Text& fault) {
  if (!good) {
    throw Fault(fault);
  }
}

void checkTree(const ObliviousTree& tree, std::size_t features, const std::string& name) {
  check(!tree.levels.empty() && tree.levels.size() <= Forest::kMaxDepth,
        name + " has " + std::to_string(tree.levels.size()) + " levels instead of 1 to " +
            std::to_string(Forest::kMaxDepth));
  check(tree.leaves.size() == std::size_t{1} << tree.levels.size(),
        name + " has " + std::to_string(tree.leaves.size()) + " leaves for " +
            std::to_string(tree.levels.size()) + " levels");
  for (const ObliviousTree::Level& level : tree.levels) {
    check(level.feature < features, name + " asks for feature " + std::to_string(level.feature) +
                                        " of " + std::to_string(features));
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

void checkTreeCount(std::size_t trees, int most) {
  check(trees > 0 && trees <= static_cast<std::size_t>(most),
        "has " + std::to_string(trees) + " trees instead of 1 to " + std::to_string(most));
}

void checkScale(const ObliviousForest& forest) {
  check(forest.leaf_unit > 0 && forest.leaf_unit < 1e3 && std::abs(forest.bias) < 1e3,
        "has a leaf unit or bias that is not a number of reasonable size");
}

void checkOblivious(const ObliviousForest& forest, std::size_t features, int most_trees) {
  checkTreeCount(forest.trees.size(), most_trees);
  for (std::size_t t = 0; t < forest.trees.size(); ++t) {
    checkTree(forest.trees[t], features, "tree " + std::to_string(t));
  }
  checkScale(forest);
}

void checkQuantizer(const FeatureQuantizer& quantizer) {
  for (const CodeMap& map : quantizer.maps) {
    check(std::isfinite(map.scale) && std::isfinite(map.offset) && map.scale > 0,
          "has a code map that is not finite and increasing");
  }
}

void checkGeneral(const Forest& forest) {
  check(forest.trees.empty(), "has both oblivious and general trees");
  checkTreeCount(forest.general_trees.size(), Forest::kMaxTrees);
  for (std::size_t t = 0; t < forest.general_trees.size(); ++t) {
    checkTree(forest.general_trees[t], "tree " + std::to_string(t));
  }
  checkScale(forest);
}

void checkFeatureNames(const std::vector<std::string>& names) {
  check(!names.empty() && names.size() <= ConfidenceForest::kMaxFeatures,
        "has " + std::to_string(names.size()) + " features instead of 1 to " +
            std::to_string(ConfidenceForest::kMaxFeatures));
  for (auto name = names.begin(); name != names.end(); ++name) {
    const std::string number = std::to_string(name - names.begin());
    check(!name->empty(), "has no name for feature " + number);
    check(std::find(names.begin(), name, *name) == name,
          "has the name \"" + *name + "\" twice, again for feature " + number);
  }
}

void checkSigma(const ConfidenceForest& forest) {
  const std::vector<std::string>& names = forest.feature_names;
  check(std::find(names.begin(), names.end(), ConfidenceForest::kRoughness) != names.end(),
        std::string("has sigma_px without the feature \"") + ConfidenceForest::kRoughness + "\"");
  constexpr std::size_t kValues =
      std::size_t{ConfidenceForest::kSigmaRoughnessBins} * ConfidenceForest::kSigmaConfidenceBins;
  const std::vector<double>& sigmas = forest.sigma_px;
  check(sigmas.size() == kValues, "has " + std::to_string(sigmas.size()) +
                                      " values of sigma_px instead of " + std::to_string(kValues));
  const auto good = [](double sigma) {
    return sigma > 0 && sigma <= ConfidenceForest::kMaxSigmaPx;
  };
  check(std::all_of(sigmas.begin(), sigmas.end(), good),
        "has a value of sigma_px that is not in (0, 10]");
  const auto& bounds = forest.sigma_roughness_bounds;
  check(std::adjacent_find(bounds.begin(), bounds.end(), std::greater_equal<>()) == bounds.end(),
        "has sigma_roughness_bounds that do not rise");
}

void checkConfidence(const ConfidenceForest& forest) {
  checkFeatureNames(forest.feature_names);
  checkOblivious(forest, forest.feature_names.size(), ConfidenceForest::kMaxTrees);
  if (!forest.sigma_px.empty()) {
    checkSigma(forest);
  }
  const std::size_t importances = forest.record.feature_importance.size();
  check(importances == 0 || importances == forest.feature_names.size(),
        "has the importance of " + std::to_string(importances) + " features instead of " +
            std::to_string(forest.feature_names.size()));
}

void checkStages(const Forest& forest) {
  for (const ConfidenceStage& stage : kConfidenceStages) {
    try {
      if (forest.*stage.forest != nullptr) {
        checkConfidence(*(forest.*stage.forest));
      }
    } catch (const Fault& fault) {
      throw ofStage(stage, fault.what());
    }
  }
  check(forest.selection == nullptr || forest.confidence != nullptr,
        "has a selection forest without a confidence forest; train both with cbmv_train");
  check(forest.selection == nullptr || forest.selection->sigma_px.empty(),
        "has sigma_px in its selection forest; only the confidence forest may have it");
}

void checkForest(const Forest& forest) {
  if (forest.general_trees.empty()) {
    checkOblivious(forest, kFeatureCount, Forest::kMaxTrees);
    checkQuantizer(forest.quantizer);
  } else {
    checkGeneral(forest);
  }
  checkStages(forest);
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
    fail(file_name, misplaced(error));
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
                     {"version", forest.confidence == nullptr ? kVersionOfOneForest : kVersion},
                     {"provenance", provenanceToJson(forest)},
                     {"checksum", checksum(model)},
                     {"model", model}};
  // With indentation, the millions of nodes of decision trees take more than twice the space.
  const std::string text = json.dump(forest.general_trees.empty() ? kIndentation : kOneLine);
  if (text.size() >= static_cast<std::size_t>(kLargestFile)) {
    fail(path, "would have " + std::to_string(text.size() >> 20) +
                   " MiB, expected at most 64 MiB. Use fewer trees or more samples per leaf");
  }
  std::ofstream file(path, std::ios::binary);
  file << text << '\n';
  file.close();
  if (!file) {
    fail(path, "cannot be written. Check that the folder exists, is writable and has free space");
  }
}

std::shared_ptr<const Forest> loadForest(const std::string& path) {
  return std::make_shared<const Forest>(readForest(path));
}

}  // namespace cbmv
