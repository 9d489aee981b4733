#include <algorithm>
#include <cmath>

#include "confidence/feature_names.h"
#include "forest/forest_json.h"
#include "io/bounded_json.h"

namespace cbmv {
namespace {

void require(bool good, const std::string& fault) {
  if (!good) {
    throw Fault("XGBoost's model " + fault);
  }
}

/// XGBoost writes its parameters as text: "5E-1", or "[5E-1]" from version 3 on.
double numberIn(const Json& text) {
  const auto number = parseBounded<Json>(text.get<std::string>());
  return (number.is_array() ? number.at(0) : number).get<double>();
}

DecisionTree treeFromXgboost(const Json& json) {
  const Json& low = json.at("left_children");
  const Json& high = json.at("right_children");
  const Json& features = json.at("split_indices");
  const Json& thresholds = json.at("split_conditions");  // in a leaf: its value
  if (json.contains("split_type")) {
    for (const Json& type : json["split_type"]) {
      require(integerIn(type, 0, 1, "a tree's split_type") == 0,
              "asks for categories, not for thresholds");
    }
  }
  DecisionTree tree;
  for (std::size_t n = 0; n < low.size(); ++n) {
    const bool leaf = low[n] == -1;
    tree.nodes.push_back(leaf ? leafNode(thresholds.at(n), n)
                              : innerNode(features.at(n), thresholds.at(n), low[n], high.at(n)));
  }
  return tree;
}

void checkFeatures(const Json& learner) {
  require(numberIn(learner.at("learner_model_param").at("num_feature")) == kFeatureCount,
          "is not of " + std::to_string(kFeatureCount) + " features");
  const auto names = learner.value("feature_names", std::vector<std::string>());
  require(names.empty() ||
              std::equal(names.begin(), names.end(), kFeatureNames.begin(), kFeatureNames.end()),
          "has other features, or in another order, than cbmv_train --export-samples writes");
}

/// Reads the meaning of the output and the bias.
void readObjective(const Json& learner, Forest& forest) {
  const auto objective = learner.at("objective").at("name").get<std::string>();
  const double base = numberIn(learner.at("learner_model_param").at("base_score"));
  if (objective == "binary:logistic") {
    require(base > 0 && base < 1, "has a base score outside of (0, 1)");
    forest.output = ForestOutput::kLogOdds;
    forest.bias = std::log(base / (1 - base));
  } else {
    require(objective == "reg:squarederror",
            "has the objective " + objective + ", not binary:logistic or reg:squarederror");
    forest.output = ForestOutput::kProbability;
    forest.bias = base;
  }
}

}  // namespace

Forest forestFromXgboost(const Json& json) {
  const Json& learner = json.at("learner");
  const Json& booster = learner.at("gradient_booster");
  require(booster.at("name").get<std::string>() == "gbtree", "is not of the kind gbtree");
  checkFeatures(learner);
  Forest forest;
  readObjective(learner, forest);
  for (const Json& tree : booster.at("model").at("trees")) {
    forest.general_trees.push_back(treeFromXgboost(tree));
  }
  forest.provenance.program = "XGBoost";
  for (const Json& part : json.at("version")) {
    forest.provenance.program += (&part == &json["version"].front() ? " " : ".") + part.dump();
  }
  return forest;
}

}  // namespace cbmv
