#include "training/held_out_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numeric>

#include "confidence/feature_names.h"
#include "forest/tree_walker.h"
#include "training/training_checks.h"

namespace cbmv {
namespace {

constexpr int kBins = 10;

/// Those of the entries of a column whose samples are held out.
template <typename Value>
std::vector<Value> heldOutPart(const std::vector<Value>& column, const SampleLabels& samples) {
  std::vector<Value> part;
  for (long n = 0; n < samples.count(); ++n) {
    if (samples.held_out[n] == 1) {
      part.push_back(column[n]);
    }
  }
  return part;
}

std::vector<double> walkTrees(const Forest& forest, const Samples& samples) {
  std::array<std::vector<float>, kFeatureCount> columns;
  std::array<const float*, kFeatureCount> lines{};
  for (int f = 0; f < kFeatureCount; ++f) {
    columns[f] = heldOutPart(samples.features[f], samples);
    lines[f] = columns[f].data();
  }
  std::vector<float> probabilities(columns[0].size());
  TreeWalker(forest).evaluate(lines, static_cast<int>(probabilities.size()), probabilities.data());
  return {probabilities.begin(), probabilities.end()};
}

using Codes = std::vector<std::vector<std::uint8_t>>;  // a column per feature

Codes heldOutCodes(const Samples& samples, const FeatureQuantizer& quantizer) {
  Codes codes;
  for (int f = 0; f < kFeatureCount; ++f) {
    const std::vector<float> values = heldOutPart(samples.features[f], samples);
    codes.emplace_back(values.size());
    quantize(quantizer.maps[f], values.data(), static_cast<int>(values.size()),
             codes.back().data());
  }
  return codes;
}

Codes heldOutCodes(const ConfidenceSamples& samples) {
  Codes codes;
  for (const std::vector<std::uint8_t>& column : samples.features) {
    codes.push_back(heldOutPart(column, samples));
  }
  return codes;
}

std::vector<double> askTrees(const ObliviousForest& forest, const Codes& codes) {
  const std::size_t count = codes[0].size();
  std::vector<long> sums(count, 0);
  for (const ObliviousTree& tree : forest.trees) {
    for (std::size_t n = 0; n < count; ++n) {
      std::size_t leaf = 0;
      for (std::size_t level = 0; level < tree.levels.size(); ++level) {
        const ObliviousTree::Level& asked = tree.levels[level];
        leaf |= (codes[asked.feature][n] >= asked.threshold ? std::size_t{1} : 0) << level;
      }
      sums[n] += tree.leaves[leaf];
    }
  }
  std::vector<double> probabilities;
  for (const long sum : sums) {
    const double log_odds = forest.bias + forest.leaf_unit * static_cast<double>(sum);
    probabilities.push_back(1 / (1 + std::exp(-log_odds)));
  }
  return probabilities;
}

std::vector<ReliabilityBin> reliability(const std::vector<double>& probabilities,
                                        const std::vector<std::uint8_t>& labels) {
  std::vector<ReliabilityBin> bins(kBins);
  for (std::size_t n = 0; n < labels.size(); ++n) {
    ReliabilityBin& bin = bins[std::min(kBins - 1, static_cast<int>(kBins * probabilities[n]))];
    bin.predicted += probabilities[n];
    bin.observed += labels[n];
    ++bin.samples;
  }
  bins.erase(std::remove_if(bins.begin(), bins.end(),
                            [](const ReliabilityBin& bin) { return bin.samples == 0; }),
             bins.end());
  for (ReliabilityBin& bin : bins) {
    bin.predicted /= static_cast<double>(bin.samples);
    bin.observed /= static_cast<double>(bin.samples);
  }
  return bins;
}

template <typename... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

std::string describeReliability(const TrainingRecord& record) {
  std::string text =
      "held-out samples by the probability that the forest gives them:\n"
      "  predicted  correct  samples\n";
  for (const ReliabilityBin& bin : record.reliability) {
    text += formatted("  %9.4f  %7.4f  %7ld\n", bin.predicted, bin.observed, bin.samples);
  }
  return text + formatted("expected calibration error %.4f\n", record.calibration_error);
}

template <typename Names>
std::string describeImportance(const std::vector<double>& importance, const Names& names) {
  std::vector<int> order(importance.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return importance[a] > importance[b]; });
  std::string text = "features by their part of what all splits gained:\n";
  for (const int f : order) {
    text += formatted("  %-34s %6.2f %%\n", std::string(names.at(f)).c_str(), 100 * importance[f]);
  }
  return text;
}

/// What was measured, without the options.
template <typename Names>
std::string describeRecord(const TrainingRecord& record, const Names& names) {
  std::string text = formatted("%ld samples, held-out log-loss %.5f nats a sample\n",
                               record.samples, record.held_out_log_loss);
  if (!record.reliability.empty()) {
    text += describeReliability(record);
  }
  if (!record.feature_importance.empty()) {
    text += describeImportance(record.feature_importance, names);
  }
  return text;
}

/// Sets what measureHeldOut sets.
void measure(const std::vector<double>& probabilities, const SampleLabels& samples,
             TrainingRecord& record) {
  const std::vector<std::uint8_t> labels = heldOutPart(samples.labels, samples);
  requireForTraining(!labels.empty(), "no sample is held out to measure the forest on");
  const auto count = static_cast<double>(labels.size());
  record.held_out_log_loss = 0;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    record.held_out_log_loss += logLoss(probabilities[n], labels[n]) / count;
  }
  record.reliability = reliability(probabilities, labels);
  record.calibration_error = 0;
  for (const ReliabilityBin& bin : record.reliability) {
    record.calibration_error +=
        static_cast<double>(bin.samples) * std::abs(bin.predicted - bin.observed) / count;
  }
}

}  // namespace

std::vector<double> heldOutProbabilities(const Forest& forest, const Samples& samples) {
  return forest.general_trees.empty() ? askTrees(forest, heldOutCodes(samples, forest.quantizer))
                                      : walkTrees(forest, samples);
}

std::vector<double> heldOutProbabilities(const ConfidenceForest& forest,
                                         const ConfidenceSamples& samples) {
  return askTrees(forest, heldOutCodes(samples));
}

void measureHeldOut(const Samples& samples, Forest& forest) {
  measure(heldOutProbabilities(forest, samples), samples, forest.provenance);
}

void measureHeldOut(const ConfidenceSamples& samples, ConfidenceForest& forest) {
  measure(heldOutProbabilities(forest, samples), samples, forest.record);
}

std::string describeProvenance(const Forest& forest) {
  const ForestProvenance& provenance = forest.provenance;
  std::string text = provenance.program + "\n" + provenance.data_set + ":";
  for (const std::string& scene : provenance.scenes) {
    text += " " + scene;
  }
  text += "\n" + provenance.options + ", seed " + std::to_string(provenance.seed) + "\n" +
          describeRecord(provenance, kFeatureNames);
  for (const ConfidenceStage& stage : kConfidenceStages) {
    if (const ConfidenceForest* further = (forest.*stage.forest).get()) {
      text += std::string(stage.name) + " forest: " + std::to_string(further->trees.size()) +
              " trees, " + further->record.options + "\n" +
              describeRecord(further->record, further->feature_names);
    }
  }
  return text;
}

}  // namespace cbmv
