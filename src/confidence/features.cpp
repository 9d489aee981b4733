#include "cbmv_stereo/confidence/features.h"

#include <algorithm>
#include <limits>

#include "fast_math.h"

namespace cbmv {
namespace {

void resizeTerms(PixelTerms& terms, int width) {
  terms.lowest_cost.assign(width, std::numeric_limits<float>::max());
  terms.log_lowest_cost.resize(width);
  terms.log_sum.assign(width, 0.0F);
}

/// c_min of both views.
void findLowestCosts(const CostRow& costs, int width, const DisparityRange& range,
                     RowTerms& terms) {
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const ColumnSpan span = matchedColumns(width, d);
    const float* line = costs.line(i);
    float* left = terms.left.lowest_cost.data();
    float* right = terms.right.lowest_cost.data();
    for (int x = span.begin; x < span.end; ++x) {
      left[x] = std::min(left[x], line[x]);
    }
    for (int x = span.begin; x < span.end; ++x) {
      right[x - d] = std::min(right[x - d], line[x]);
    }
  }
}

inline float exponentOf(float cost, float lowest, float inverse) {
  const float difference = cost - lowest;
  return -(difference * difference) * inverse;
}

/// Σ exp(−(C − c_min)² / 2σ²) of both views, in log_sum.
void sumLikelihoods(const CostRow& costs, int width, const DisparityRange& range, float inverse,
                    RowTerms& terms) {
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const ColumnSpan span = matchedColumns(width, d);
    const float* line = costs.line(i);
    const float* left_lowest = terms.left.lowest_cost.data();
    const float* right_lowest = terms.right.lowest_cost.data();
    float* left = terms.left.log_sum.data();
    float* right = terms.right.log_sum.data();
    for (int x = span.begin; x < span.end; ++x) {
      left[x] += expOfNegative(exponentOf(line[x], left_lowest[x], inverse));
    }
    for (int x = span.begin; x < span.end; ++x) {
      right[x - d] += expOfNegative(exponentOf(line[x], right_lowest[x - d], inverse));
    }
  }
}

void takeLogarithms(PixelTerms& terms, float epsilon) {
  const int width = static_cast<int>(terms.lowest_cost.size());
  for (int x = 0; x < width; ++x) {
    terms.log_lowest_cost[x] = logOfPositive(terms.lowest_cost[x] + epsilon);
    terms.log_sum[x] = logOfPositive(terms.log_sum[x]);
  }
}

}  // namespace

void computeRowTerms(const CostRow& costs, int width, const DisparityRange& range,
                     const MatcherConstants& constants, RowTerms& terms) {
  resizeTerms(terms.left, width);
  resizeTerms(terms.right, width);
  findLowestCosts(costs, width, range, terms);
  sumLikelihoods(costs, width, range, 1.0F / constants.two_sigma_squared, terms);
  takeLogarithms(terms.left, constants.epsilon);
  takeLogarithms(terms.right, constants.epsilon);
}

void computeFeatures(const CostRow& costs, const RowTerms& terms, int width,
                     const DisparityRange& range, int i, const MatcherConstants& constants,
                     const FeatureLines& values) {
  const int d = range.min + i;
  const ColumnSpan span = matchedColumns(width, d);
  const float* line = costs.line(i);
  const float inverse = 1.0F / constants.two_sigma_squared;
  const PixelTerms& left = terms.left;
  const PixelTerms& right = terms.right;
  for (int x = span.begin; x < span.end; ++x) {
    const float log_cost = logOfPositive(line[x] + constants.epsilon);
    const float left_ratio = left.log_lowest_cost[x] - log_cost;
    const float right_ratio = right.log_lowest_cost[x - d] - log_cost;
    values[kCost][x] = constants.logarithmic_cost ? log_cost : line[x];
    values[kRatioLow][x] = std::min(left_ratio, right_ratio);
    values[kRatioHigh][x] = std::max(left_ratio, right_ratio);
  }
  for (int x = span.begin; x < span.end; ++x) {
    const float left_likelihood =
        exponentOf(line[x], left.lowest_cost[x], inverse) - left.log_sum[x];
    const float right_likelihood =
        exponentOf(line[x], right.lowest_cost[x - d], inverse) - right.log_sum[x - d];
    values[kLikelihoodLow][x] = std::min(left_likelihood, right_likelihood);
    values[kLikelihoodHigh][x] = std::max(left_likelihood, right_likelihood);
  }
}

void quantize(const CodeMap& map, const float* values, int count, std::uint8_t* codes) {
  for (int i = 0; i < count; ++i) {
    const float code = map.scale * values[i] + map.offset;
    codes[i] = static_cast<std::uint8_t>(
        static_cast<std::int32_t>(std::min(std::max(code, 0.0F), 255.0F)));
  }
}

}  // namespace cbmv
