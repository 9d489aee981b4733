#include "training/random_forest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <tbb/global_control.h>
#include <unistd.h>
#include <xgboost/c_api.h>

#include "forest/forest_file.h"
#include "io/binary_file.h"
#include "io/bounded_json.h"
#include "io/ordered_json.h"
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

/// An empty file that is removed at the end. XGBoost before 1.6 writes its JSON nowhere but to
/// files.
class TemporaryModelFile {
 public:
  TemporaryModelFile()
      : path_((std::filesystem::temp_directory_path() / "cbmv_forest_XXXXXX.json").string()) {
    const int file = mkstemps(path_.data(), 5);
    if (file < 0) {
      throw Error("training: cannot make " + path_ +
                  ", which stores the forest temporarily. Set TMPDIR to a writable folder.");
    }
    close(file);
  }
  ~TemporaryModelFile() { unlink(path_.c_str()); }
  TemporaryModelFile(const TemporaryModelFile&) = delete;
  TemporaryModelFile& operator=(const TemporaryModelFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
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

  /// As JSON.
  std::string model() const {
    const TemporaryModelFile file;
    call(XGBoosterSaveModel(booster_, file.path().c_str()));
    const std::vector<std::uint8_t> bytes =
        readBytes(file.path(), std::numeric_limits<std::uintmax_t>::max());
    return {bytes.begin(), bytes.end()};
  }

 private:
  void set(const char* name, const std::string& value) {
    call(XGBoosterSetParam(booster_, name, value.c_str()));
  }

  BoosterHandle booster_ = nullptr;
};

/// Of all splits of a model of XGBoost, by feature.
std::vector<double> totalGains(const std::string& model) {
  const auto json = parseBounded<OrderedJson>(model);
  std::vector<double> gains(kFeatureCount, 0.0);
  for (const OrderedJson& tree :
       json.at("learner").at("gradient_booster").at("model").at("trees")) {
    const OrderedJson& children = tree.at("left_children");
    for (std::size_t node = 0; node < children.size(); ++node) {
      if (children[node] != -1) {  // no leaf
        gains.at(tree.at("split_indices").at(node).get<std::size_t>()) +=
            tree.at("loss_changes").at(node).get<double>();
      }
    }
  }
  return gains;
}

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
  const std::string model = grower.model();
  Forest forest = parseForest(model, "from XGBoost");
  forest.provenance.samples = samples.count();
  forest.provenance.feature_importance = shares(totalGains(model));
  return forest;
}

}  // namespace cbmv
