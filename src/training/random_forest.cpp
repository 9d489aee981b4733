#include "training/random_forest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <tbb/global_control.h>
#include <xgboost/c_api.h>

#include "forest/forest_file.h"
#include "training/training_checks.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// XGBoost's functions return 0 where all is well.
void call(int status) {
  if (status != 0) {
    throw Error(std::string("training: XGBoost says: ") + XGBGetLastError());
  }
}

int threadCount() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

/// The samples that are trained on, as XGBoost holds them.
class TrainingMatrix {
 public:
  explicit TrainingMatrix(const Samples& samples) {
    std::vector<float> rows;
    std::vector<float> labels;
    const auto trained = std::count(samples.held_out.begin(), samples.held_out.end(), 0);
    rows.reserve(static_cast<std::size_t>(trained) * kFeatureCount);
    for (long n = 0; n < samples.count(); ++n) {
      if (samples.held_out[n] == 0) {
        for (const std::vector<float>& column : samples.features) {
          rows.push_back(column[n]);
        }
        labels.push_back(samples.labels[n]);
      }
    }
    call(XGDMatrixCreateFromMat_omp(rows.data(), labels.size(), kFeatureCount,
                                    std::numeric_limits<float>::quiet_NaN(), &handle_,
                                    threadCount()));
    call(XGDMatrixSetFloatInfo(handle_, "label", labels.data(), labels.size()));
  }
  ~TrainingMatrix() { XGDMatrixFree(handle_); }
  TrainingMatrix(const TrainingMatrix&) = delete;
  TrainingMatrix& operator=(const TrainingMatrix&) = delete;

  DMatrixHandle handle() const { return handle_; }

 private:
  DMatrixHandle handle_ = nullptr;
};

/// One round of boosting that grows all trees at once, from the same answer, and takes their mean.
/// The squared error of labels 0 and 1 is their Gini impurity, halved; its second derivative is 1 a
/// sample, and without regularization a leaf's value is the mean label. Sums of these derivatives
/// are exact, hence the same in any order.
class RandomForestGrower {
 public:
  explicit RandomForestGrower(const TrainingMatrix& matrix) {
    const DMatrixHandle handle = matrix.handle();
    call(XGBoosterCreate(&handle, 1, &booster_));
  }
  ~RandomForestGrower() { XGBoosterFree(booster_); }
  RandomForestGrower(const RandomForestGrower&) = delete;
  RandomForestGrower& operator=(const RandomForestGrower&) = delete;

  void grow(const TrainingMatrix& matrix, const RandomForestOptions& options, std::uint64_t seed) {
    set("objective", "reg:squarederror");
    set("base_score", "0.5");
    set("tree_method", "hist");
    set("max_bin", "256");
    set("max_depth", std::to_string(DecisionTree::kMaxDepth));
    set("learning_rate", "1");
    set("lambda", "0");
    set("num_parallel_tree", std::to_string(options.trees));
    set("min_child_weight", std::to_string(options.samples_per_leaf));
    set("subsample", std::to_string(options.samples_per_tree));
    set("colsample_bynode",
        std::to_string(static_cast<double>(options.features_per_split) / kFeatureCount));
    set("seed", std::to_string(seed % std::numeric_limits<std::int32_t>::max()));
    set("nthread", std::to_string(threadCount()));
    call(XGBoosterUpdateOneIter(booster_, 0, matrix.handle()));
  }

  Forest forest() const {
    bst_ulong size = 0;
    const char* text = nullptr;
    call(XGBoosterSaveModelToBuffer(booster_, R"({"format": "json"})", &size, &text));
    return parseForest(std::string(text, size), "from XGBoost");
  }

  /// Of all splits, by feature.
  std::vector<double> gains() const {
    bst_ulong count = 0;
    bst_ulong dimensions = 0;
    const char** names = nullptr;  // "f0", "f1", …: those that are asked for
    const bst_ulong* shape = nullptr;
    const float* scores = nullptr;
    call(XGBoosterFeatureScore(booster_, R"({"importance_type": "total_gain"})", &count, &names,
                               &dimensions, &shape, &scores));
    std::vector<double> gains(kFeatureCount, 0.0);
    for (bst_ulong k = 0; k < count; ++k) {
      gains.at(std::stoul(names[k] + 1)) = scores[k];
    }
    return gains;
  }

 private:
  void set(const char* name, const std::string& value) {
    call(XGBoosterSetParam(booster_, name, value.c_str()));
  }

  BoosterHandle booster_ = nullptr;
};

void checkOptions(const Samples& samples, const RandomForestOptions& options) {
  requireTreeCount(options.trees);
  requireForTraining(options.samples_per_leaf >= 1, "a leaf must have at least one sample");
  requireForTraining(
      options.features_per_split >= 1 && options.features_per_split <= kFeatureCount,
      "the features per split must be in [1, " + std::to_string(kFeatureCount) + "]");
  requireForTraining(options.samples_per_tree > 0 && options.samples_per_tree <= 1,
                     "the part of the samples per tree must be in (0, 1]");
  requireBothClasses(samples);
}

}  // namespace

Forest trainRandomForest(const Samples& samples, const RandomForestOptions& options,
                         std::uint64_t seed) {
  checkOptions(samples, options);
  const TrainingMatrix matrix(samples);
  RandomForestGrower grower(matrix);
  grower.grow(matrix, options, seed);
  Forest forest = grower.forest();
  forest.provenance.samples = samples.count();
  forest.provenance.feature_importance = shares(grower.gains());
  return forest;
}

}  // namespace cbmv
