#include "cbmv_stereo/training/held_out_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numeric>

#include "training_checks.h"

#include "cbmv_stereo/confidence/feature_names.h"
#include "cbmv_stereo/forest/tree_walker.h"

namespace cbmv {
namespace {

constexpr int kBins = 10;

using Columns = std::array<std::vector<float>, kFeatureCount>;

Columns heldOutColumns(const Samples& samples) {
  Columns columns;
  for (int f = 0; f < kFeatureCount; ++f) {
    for (long n = 0; n < samples.count(); ++n) {
      if (samples.held_out[n] == 1) {
        columns[f].push_back(samples.features[f][n]);
      }
    }
  }
  return columns;
}

std::vector<double> walkTrees(const Forest& forest, const Columns& columns) {
  std::array<const float*, kFeatureCount> lines{};
  for (int f = 0; f < kFeatureCount; ++f) {
    lines[f] = columns[f].data();
  }
  std::vector<float> probabilities(columns[0].size());
  TreeWalker(forest).evaluate(lines, static_cast<int>(probabilities.size()), probabilities.data());
  return {probabilities.begin(), probabilities.end()};
}

std::vector<double> askObliviousTrees(const Forest& forest, const Columns& columns) {
  const std::size_t count = columns[0].size();
  std::array<std::vector<std::uint8_t>, kFeatureCount> codes;
  for (int f = 0; f < kFeatureCount; ++f) {
    codes[f].resize(count);
    quantize(forest.quantizer.maps[f], columns[f].data(), static_cast<int>(count), codes[f].data());
  }
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

std::vector<std::uint8_t> heldOutLabels(const Samples& samples) {
  std::vector<std::uint8_t> labels;
  for (long n = 0; n < samples.count(); ++n) {
    if (samples.held_out[n] == 1) {
      labels.push_back(samples.labels[n]);
    }
  }
  return labels;
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

std::string describeReliability(const ForestProvenance& provenance) {
  std::string text =
      "held-out samples by the probability that the forest gives them:\n"
      "  predicted  correct  samples\n";
  for (const ReliabilityBin& bin : provenance.reliability) {
    text += formatted("  %9.4f  %7.4f  %7ld\n", bin.predicted, bin.observed, bin.samples);
  }
  return text + formatted("expected calibration error %.4f\n", provenance.calibration_error);
}

std::string describeImportance(const std::vector<double>& importance) {
  std::vector<int> order(importance.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return importance[a] > importance[b]; });
  std::string text = "features by their part of what all splits gained:\n";
  for (const int f : order) {
    text += formatted("  %-34s %6.2f %%\n", kFeatureNames[f], 100 * importance[f]);
  }
  return text;
}

}  // namespace

std::vector<double> heldOutProbabilities(const Forest& forest, const Samples& samples) {
  const Columns columns = heldOutColumns(samples);
  return forest.general_trees.empty() ? askObliviousTrees(forest, columns)
                                      : walkTrees(forest, columns);
}

void measureHeldOut(const Samples& samples, Forest& forest) {
  const std::vector<std::uint8_t> labels = heldOutLabels(samples);
  requireForTraining(!labels.empty(), "no sample is held out to measure the forest on");
  const std::vector<double> probabilities = heldOutProbabilities(forest, samples);
  const auto count = static_cast<double>(labels.size());
  ForestProvenance& provenance = forest.provenance;
  provenance.held_out_log_loss = 0;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    provenance.held_out_log_loss += logLoss(probabilities[n], labels[n]) / count;
  }
  provenance.reliability = reliability(probabilities, labels);
  provenance.calibration_error = 0;
  for (const ReliabilityBin& bin : provenance.reliability) {
    provenance.calibration_error +=
        static_cast<double>(bin.samples) * std::abs(bin.predicted - bin.observed) / count;
  }
}

std::string describeProvenance(const ForestProvenance& provenance) {
  std::string text = provenance.program + "\n" + provenance.data_set + ":";
  for (const std::string& scene : provenance.scenes) {
    text += " " + scene;
  }
  text += "\n" + provenance.options + ", seed " + std::to_string(provenance.seed) + "\n" +
          formatted("%ld samples, held-out log-loss %.5f nats a sample\n", provenance.samples,
                    provenance.held_out_log_loss);
  if (!provenance.reliability.empty()) {
    text += describeReliability(provenance);
  }
  if (!provenance.feature_importance.empty()) {
    text += describeImportance(provenance.feature_importance);
  }
  return text;
}

}  // namespace cbmv
