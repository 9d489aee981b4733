#include "cbmv_stereo/forest/forest_file.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <zlib.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "cbmv_stereo forest";
constexpr int kVersion = 1;
constexpr std::streamoff kLargestFile = 16 << 20;

/// What is wrong inside of a file, before its name is known.
struct Fault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void fail(const std::string& file, const std::string& fault) {
  throw Error("forest " + file + ": " + fault);
}

/// CRC-32 of the text of everything that changes the forest's answers.
std::string checksum(const Json& model) {
  const std::string text = model.dump();
  const auto crc = crc32(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(text.data()),
                         static_cast<uInt>(text.size()));
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%08lx", static_cast<unsigned long>(crc));
  return digits.data();
}

Json modelToJson(const Forest& forest) {
  Json model;
  model["features"] = kFeatureCount;
  model["leaf_unit"] = forest.leaf_unit;
  model["bias"] = forest.bias;
  for (const CodeMap& map : forest.quantizer.maps) {
    model["code_maps"].push_back({map.scale, map.offset});
  }
  model["trees"] = Json::array();
  for (const ObliviousTree& tree : forest.trees) {
    Json levels = Json::array();
    for (const ObliviousTree::Level& level : tree.levels) {
      levels.push_back({level.feature, level.threshold});
    }
    model["trees"].push_back({{"levels", levels}, {"leaves", tree.leaves}});
  }
  return model;
}

Json provenanceToJson(const ForestProvenance& provenance) {
  return {{"program", provenance.program},
          {"data_set", provenance.data_set},
          {"scenes", provenance.scenes},
          {"options", provenance.options},
          {"samples", provenance.samples},
          {"seed", provenance.seed},
          {"held_out_log_loss", provenance.held_out_log_loss}};
}

int integerIn(const Json& value, int lowest, int highest, const std::string& what) {
  const auto number = value.get<std::int64_t>();
  if (number < lowest || number > highest) {
    throw Fault(what + " is " + std::to_string(number) + ", outside of [" + std::to_string(lowest) +
                ", " + std::to_string(highest) + "]");
  }
  return static_cast<int>(number);
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

void modelFromJson(const Json& model, Forest& forest) {
  integerIn(model.at("features"), kFeatureCount, kFeatureCount, "the number of features");
  forest.leaf_unit = model.at("leaf_unit").get<double>();
  forest.bias = model.at("bias").get<double>();
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

ForestProvenance provenanceFromJson(const Json& json) {
  ForestProvenance provenance;
  provenance.program = json.at("program").get<std::string>();
  provenance.data_set = json.at("data_set").get<std::string>();
  provenance.scenes = json.at("scenes").get<std::vector<std::string>>();
  provenance.options = json.at("options").get<std::string>();
  provenance.samples = json.at("samples").get<long>();
  provenance.seed = json.at("seed").get<std::uint64_t>();
  provenance.held_out_log_loss = json.at("held_out_log_loss").get<double>();
  return provenance;
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) {
    fail(path, "cannot be opened; give the path of a file that cbmv_train wrote");
  }
  const std::streamoff size = file.tellg();
  if (size < 0 || size > kLargestFile) {
    fail(path, "is not a forest file, which has at most 16 MiB");
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  if (!file.read(text.data(), size)) {
    fail(path, "cannot be read");
  }
  return text;
}

Forest forestFromJson(const Json& json) {
  if (!json.is_object() || json.value("format", "") != kFormat) {
    throw Fault(std::string("has no \"format\": \"") + kFormat + "\", so it is not a forest");
  }
  const int version = json.at("version").get<int>();
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

}  // namespace

std::string forestChecksum(const Forest& forest) { return checksum(modelToJson(forest)); }

void validateForest(const Forest& forest, const std::string& file_name) {
  if (forest.trees.empty() || forest.trees.size() > Forest::kMaxTrees) {
    fail(file_name, "has " + std::to_string(forest.trees.size()) + " trees instead of 1 to " +
                        std::to_string(Forest::kMaxTrees));
  }
  for (std::size_t t = 0; t < forest.trees.size(); ++t) {
    const ObliviousTree& tree = forest.trees[t];
    const std::string name = "tree " + std::to_string(t);
    if (tree.levels.empty() || tree.levels.size() > Forest::kMaxDepth) {
      fail(file_name, name + " has " + std::to_string(tree.levels.size()) +
                          " levels instead of 1 to " + std::to_string(Forest::kMaxDepth));
    }
    if (tree.leaves.size() != std::size_t{1} << tree.levels.size()) {
      fail(file_name, name + " has " + std::to_string(tree.leaves.size()) + " leaves for " +
                          std::to_string(tree.levels.size()) + " levels");
    }
    for (const ObliviousTree::Level& level : tree.levels) {
      if (level.feature >= kFeatureCount) {
        fail(file_name, name + " asks for feature " + std::to_string(level.feature) + " of " +
                            std::to_string(kFeatureCount));
      }
    }
  }
  if (!(forest.leaf_unit > 0 && forest.leaf_unit < 1e3) || !(std::abs(forest.bias) < 1e3)) {
    fail(file_name, "has a leaf unit or bias that is not a number of reasonable size");
  }
  for (const CodeMap& map : forest.quantizer.maps) {
    if (!std::isfinite(map.scale) || !std::isfinite(map.offset) || map.scale <= 0) {
      fail(file_name, "has a code map that is not finite and increasing");
    }
  }
}

Forest readForest(const std::string& path) {
  const std::string text = readText(path);
  try {
    Forest forest = forestFromJson(Json::parse(text));
    forest.name = path.substr(path.find_last_of('/') + 1);
    validateForest(forest, path);
    return forest;
  } catch (const Json::parse_error& error) {
    fail(path, "is not a forest, or cut off: no valid JSON at byte " + std::to_string(error.byte));
  } catch (const Json::exception& error) {
    fail(path, std::string("has a missing or misplaced entry: ") + error.what());
  } catch (const Fault& fault) {
    fail(path, fault.what());
  }
}

void writeForest(const Forest& forest, const std::string& path) {
  validateForest(forest, path);
  const Json model = modelToJson(forest);
  const Json json = {{"format", kFormat},
                     {"version", kVersion},
                     {"provenance", provenanceToJson(forest.provenance)},
                     {"checksum", checksum(model)},
                     {"model", model}};
  std::ofstream file(path, std::ios::binary);
  file << json.dump(1) << '\n';
  file.close();
  if (!file) {
    fail(path, "cannot be written");
  }
}

}  // namespace cbmv
