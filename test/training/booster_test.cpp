#include "training/booster.h"

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace cbmv::test {
namespace {

constexpr int kFeatures = 3;
constexpr int kCodes = 16;
constexpr double kUnit = 65536;  // fixed point scale of the derivatives

struct Problem {
  std::vector<Booster::Column> codes = std::vector<Booster::Column>(kFeatures);
  SampleLabels labels;
};

/// More samples than fit into two chunks; the leaves have very different sizes.
Problem makeProblem(int samples) {
  std::mt19937 random(4);
  Problem problem;
  for (int n = 0; n < samples; ++n) {
    for (int f = 0; f < kFeatures; ++f) {
      problem.codes[f].push_back(static_cast<std::uint8_t>(random() % (f + 2) * (random() % 6)));
    }
    const bool likely = problem.codes[0][n] > 1 && problem.codes[2][n] < 5;
    problem.labels.labels.push_back(random() % 10 < (likely ? 8U : 3U) ? 1 : 0);
    problem.labels.held_out.push_back(random() % 7 == 0 ? 1 : 0);
  }
  return problem;
}

/// Grows trees directly from the formulas: computes every sum over all samples for every question.
class NaiveBooster {
 public:
  NaiveBooster(const Problem& problem, const BoostingOptions& options, double bias)
      : problem_(problem), options_(options), bias_(bias) {
    scores_.resize(problem.labels.labels.size());
  }

  ObliviousTree addTree() {
    ObliviousTree tree;
    for (int depth = 0; depth < options_.depth; ++depth) {
      tree.levels.push_back(bestLevel(tree));
    }
    for (const Sum& sum : leafSums(tree)) {
      const double step = -(sum.first / kUnit) / (sum.second / kUnit + options_.regularization);
      tree.leaves.push_back(static_cast<std::int8_t>(std::fmin(
          127, std::fmax(-128, std::round(options_.learning_rate * step / options_.leaf_unit)))));
    }
    for (std::size_t n = 0; n < scores_.size(); ++n) {
      scores_[n] += tree.leaves[leafOf(tree, n)];
    }
    return tree;
  }

 private:
  struct Sum {
    double first = 0;  // integers
    double second = 0;
  };

  int leafOf(const ObliviousTree& tree, std::size_t n) const {
    int leaf = 0;
    for (std::size_t k = 0; k < tree.levels.size(); ++k) {
      leaf += problem_.codes[tree.levels[k].feature][n] >= tree.levels[k].threshold ? 1 << k : 0;
    }
    return leaf;
  }

  std::vector<Sum> leafSums(const ObliviousTree& tree) const {
    std::vector<Sum> sums(std::size_t{1} << tree.levels.size());
    for (std::size_t n = 0; n < scores_.size(); ++n) {
      if (problem_.labels.held_out[n] == 1) {
        continue;
      }
      const double probability = 1 / (1 + std::exp(-(bias_ + options_.leaf_unit * scores_[n])));
      Sum& sum = sums[leafOf(tree, n)];
      sum.first += std::round((probability - problem_.labels.labels[n]) * kUnit);
      sum.second += std::round(probability * (1 - probability) * kUnit);
    }
    return sums;
  }

  ObliviousTree::Level bestLevel(const ObliviousTree& tree) const {
    ObliviousTree::Level best;
    double best_score = -1;
    for (int f = 0; f < kFeatures; ++f) {
      for (int threshold = 1; threshold < kCodes; ++threshold) {
        ObliviousTree longer = tree;
        longer.levels.push_back(
            {static_cast<std::uint8_t>(f), static_cast<std::uint8_t>(threshold)});
        double score = 0;
        for (const Sum& sum : leafSums(longer)) {
          const double first = sum.first / kUnit;
          score += first * first / (sum.second / kUnit + options_.regularization);
        }
        if (score > best_score + 1e-9) {
          best_score = score;
          best = longer.levels.back();
        }
      }
    }
    return best;
  }

  const Problem& problem_;
  BoostingOptions options_;
  double bias_;
  std::vector<std::int32_t> scores_;
};

TEST(Booster, GrowsTheTreesOfTheFormulas) {
  const Problem problem = makeProblem(40000);
  BoostingOptions options;
  options.depth = 4;
  Booster booster(problem.codes, std::vector<bool>(kFeatures, true), problem.labels, options);
  NaiveBooster naive(problem, options, booster.bias());
  for (int t = 0; t < 3; ++t) {
    const ObliviousTree tree = booster.addTree();
    const ObliviousTree expected = naive.addTree();
    ASSERT_EQ(tree.levels.size(), expected.levels.size());
    for (std::size_t k = 0; k < tree.levels.size(); ++k) {
      EXPECT_EQ(tree.levels[k].feature, expected.levels[k].feature) << t << ", " << k;
      EXPECT_EQ(tree.levels[k].threshold, expected.levels[k].threshold) << t << ", " << k;
    }
    EXPECT_EQ(tree.leaves, expected.leaves);
  }
}

TEST(Booster, AsksOnlyForWhatItMay) {
  const Problem problem = makeProblem(3000);
  Booster booster(problem.codes, {false, true, false}, problem.labels, {});
  for (const ObliviousTree::Level& level : booster.addTree().levels) {
    EXPECT_EQ(level.feature, 1);
  }
  EXPECT_EQ(booster.gains()[0], 0);
  EXPECT_GT(booster.gains()[1], 0);
}

}  // namespace
}  // namespace cbmv::test
