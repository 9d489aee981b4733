#include "cbmv_stereo/confidence/features.h"

#include <limits>
#include <type_traits>
#include <variant>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "confidence/features.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "confidence/fast_math-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;

/// Vector of costs in the unit of the matcher's constants.
template <class D, typename Cost>
HWY_INLINE hn::Vec<D> loadCosts(D tag, const Cost* costs, float unit) {
  if constexpr (std::is_same_v<Cost, float>) {
    return hn::Mul(hn::LoadU(tag, costs), hn::Set(tag, unit));
  } else {
    const auto narrow = hn::LoadU(hn::Rebind<Cost, D>(), costs);
    const auto wide = hn::PromoteTo(hn::RebindToSigned<D>(), narrow);
    return hn::Mul(hn::ConvertTo(tag, wide), hn::Set(tag, unit));
  }
}

/// c_min of both views.
template <typename Cost>
void findLowestCosts(const CostRow<Cost>& costs, int width, const DisparityRange& range, float unit,
                     const RowSpans* spans, RowTerms& terms) {
  float* left = terms.left.lowest_cost.data();
  float* right = terms.right.lowest_cost.data();
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const Cost* line = costs.line(i);
    forSpans(spans, width, range, i, [=](const ColumnSpan& span) HWY_ATTR {
      forLanes(Floats(), span.begin, span.end, [=](auto tag, int x, int) HWY_ATTR {
        const auto cost = loadCosts(tag, line + x, unit);
        hn::StoreU(hn::Min(hn::LoadU(tag, left + x), cost), tag, left + x);
        hn::StoreU(hn::Min(hn::LoadU(tag, right + x - d), cost), tag, right + x - d);
      });
    });
  }
}

/// (C − c_min)² · factor; −1 / 2σ² gives the logarithm of the likelihood.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V scaledSquare(D tag, V cost, const float* lowest, float factor) {
  const V difference = hn::Sub(cost, hn::LoadU(tag, lowest));
  return hn::Mul(hn::Mul(difference, difference), hn::Set(tag, factor));
}

/// Adds 2^value to the lanes of `sums` behind the first `done`.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void addExp2(D tag, V value, int done, float* sums) {
  const V before = hn::LoadU(tag, sums);
  V after = hn::Add(before, exp2OfNegative(tag, value));
  if (done > 0) {
    after = hn::IfThenElse(hn::FirstN(tag, done), before, after);
  }
  hn::StoreU(after, tag, sums);
}

/// Σ exp(−(C − c_min)² / 2σ²) of both views, in log_sum.
template <typename Cost>
void sumLikelihoods(const CostRow<Cost>& costs, int width, const DisparityRange& range,
                    const MatcherConstants& constants, const RowSpans* spans, RowTerms& terms) {
  const float unit = constants.cost_unit;
  constexpr float kLog2E = 1.44269504F;
  const float factor = -kLog2E / constants.two_sigma_squared;
  const float* left_lowest = terms.left.lowest_cost.data();
  const float* right_lowest = terms.right.lowest_cost.data();
  float* left = terms.left.log_sum.data();
  float* right = terms.right.log_sum.data();
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const Cost* line = costs.line(i);
    forSpans(spans, width, range, i, [=](const ColumnSpan& span) HWY_ATTR {
      forLanes(Floats(), span.begin, span.end, [=](auto tag, int x, int done) HWY_ATTR {
        const auto cost = loadCosts(tag, line + x, unit);
        addExp2(tag, scaledSquare(tag, cost, left_lowest + x, factor), done, left + x);
        addExp2(tag, scaledSquare(tag, cost, right_lowest + x - d, factor), done, right + x - d);
      });
    });
  }
}

void takeLogarithms(float epsilon, PixelTerms& terms) {
  const float* lowest = terms.lowest_cost.data();
  float* log_lowest = terms.log_lowest_cost.data();
  float* log_sum = terms.log_sum.data();
  const int width = static_cast<int>(terms.lowest_cost.size());
  forLanes(Floats(), 0, width, [=](auto tag, int x, int done) HWY_ATTR {
    const auto shifted = hn::Add(hn::LoadU(tag, lowest + x), hn::Set(tag, epsilon));
    hn::StoreU(logOfPositive(tag, shifted), tag, log_lowest + x);
    const auto sum = hn::LoadU(tag, log_sum + x);
    hn::StoreU(hn::IfThenElse(hn::FirstN(tag, done), sum, logOfPositive(tag, sum)), tag,
               log_sum + x);
  });
}

void fillTerms(const CostRowPointer& costs, int width, const DisparityRange& range,
               const MatcherConstants& constants, const RowSpans* spans, RowTerms& terms) {
  std::visit(
      [&](const auto* row) HWY_ATTR {
        findLowestCosts(*row, width, range, constants.cost_unit, spans, terms);
        sumLikelihoods(*row, width, range, constants, spans, terms);
      },
      costs);
  takeLogarithms(constants.epsilon, terms.left);
  takeLogarithms(constants.epsilon, terms.right);
}

/// The terms of the pixels of one view that a line's hypotheses match.
struct TermLines {
  const float* lowest_cost;
  const float* log_lowest_cost;
  const float* log_sum;

  TermLines(const PixelTerms& terms, int shift)
      : lowest_cost(terms.lowest_cost.data() - shift),
        log_lowest_cost(terms.log_lowest_cost.data() - shift),
        log_sum(terms.log_sum.data() - shift) {}
};

/// What the features of one matcher at one disparity are computed from.
template <typename Cost>
struct FeatureInput {
  const Cost* costs;
  TermLines left;
  TermLines right;
  MatcherConstants constants;
};

/// Columns of a block, at most twice as many: short enough for the first-level cache.
constexpr int kBlock = 256;

/// Passes vectors of kCost and keeps log(C + ε), from log_costs on.
template <typename Cost, class Sink>
HWY_INLINE void passCosts(const FeatureInput<Cost>& input, const ColumnSpan& block,
                          float* log_costs, const Sink& sink) {
  forLanes(Floats(), block.begin, block.end, [=](auto tag, int x, int) HWY_ATTR {
    const MatcherConstants& c = input.constants;
    const auto cost = loadCosts(tag, input.costs + x, c.cost_unit);
    const auto log_cost = logOfPositive(tag, hn::Add(cost, hn::Set(tag, c.epsilon)));
    hn::StoreU(log_cost, tag, log_costs + (x - block.begin));
    if (c.logarithmic_cost) {
      sink(tag, kCost, x, log_cost);
    } else {
      sink(tag, kCost, x, cost);
    }
  });
}

template <typename Cost, class Sink>
HWY_INLINE void passRatios(const FeatureInput<Cost>& input, const ColumnSpan& block,
                           const float* log_costs, const Sink& sink) {
  forLanes(Floats(), block.begin, block.end, [=](auto tag, int x, int) HWY_ATTR {
    const auto log_cost = hn::LoadU(tag, log_costs + (x - block.begin));
    const auto left = hn::Sub(hn::LoadU(tag, input.left.log_lowest_cost + x), log_cost);
    const auto right = hn::Sub(hn::LoadU(tag, input.right.log_lowest_cost + x), log_cost);
    sink(tag, kRatioLow, x, hn::Min(left, right));
    sink(tag, kRatioHigh, x, hn::Max(left, right));
  });
}

template <typename Cost, class Sink>
HWY_INLINE void passLikelihoods(const FeatureInput<Cost>& input, const ColumnSpan& block,
                                const Sink& sink) {
  const float factor = -1.0F / input.constants.two_sigma_squared;
  const auto likelihood = [factor](auto tag, auto cost, const TermLines& terms, int x) HWY_ATTR {
    return hn::Sub(scaledSquare(tag, cost, terms.lowest_cost + x, factor),
                   hn::LoadU(tag, terms.log_sum + x));
  };
  forLanes(Floats(), block.begin, block.end, [=](auto tag, int x, int) HWY_ATTR {
    const auto cost = loadCosts(tag, input.costs + x, input.constants.cost_unit);
    const auto left = likelihood(tag, cost, input.left, x);
    const auto right = likelihood(tag, cost, input.right, x);
    sink(tag, kLikelihoodLow, x, hn::Min(left, right));
    sink(tag, kLikelihoodHigh, x, hn::Max(left, right));
  });
}

/// Passes vectors of features to `sink(tag, feature, x, values)`. One short loop a kind of feature:
/// in a long one, each vector waits for a long chain of instructions, and too few vectors are under
/// way at once.
template <typename Cost, class Sink>
void forFeatures(const CostRow<Cost>& costs, const RowTerms& terms, const ColumnSpan& span,
                 const DisparityRange& range, int i, const MatcherConstants& constants,
                 const Sink& sink) {
  const int d = range.min + i;
  const FeatureInput<Cost> input{costs.line(i), TermLines(terms.left, 0), TermLines(terms.right, d),
                                 constants};
  HWY_ALIGN float log_costs[2 * kBlock];
  int end = span.begin;
  while (end < span.end) {
    const int begin = end;
    end = span.end - begin > 2 * kBlock ? begin + kBlock : span.end;
    const ColumnSpan block{begin, end};
    passCosts(input, block, log_costs, sink);
    passRatios(input, block, log_costs, sink);
    passLikelihoods(input, block, sink);
  }
}

void writeFeatures(const CostRowPointer& costs, const RowTerms& terms, const ColumnSpan& span,
                   const DisparityRange& range, int i, const MatcherConstants& constants,
                   const FeatureLines& values) {
  const auto store = [lines = values](auto tag, int feature, int x, auto value)
                         HWY_ATTR { hn::StoreU(value, tag, lines[feature] + x); };
  std::visit([&](const auto* row)
                 HWY_ATTR { forFeatures(*row, terms, span, range, i, constants, store); },
             costs);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE void storeCodes(D tag, V values, float scale, float offset, std::uint8_t* codes) {
  const V code = hn::Add(hn::Mul(hn::Set(tag, scale), values), hn::Set(tag, offset));
  const V cut = hn::Min(hn::Max(code, hn::Zero(tag)), hn::Set(tag, 255.0F));
  const hn::RebindToUnsigned<D> integer;
  const auto low_byte = hn::And(lowBitsOfWhole(tag, hn::Trunc(cut)), hn::Set(integer, 0xffU));
  hn::StoreU(hn::U8FromU32(low_byte), hn::Rebind<std::uint8_t, D>(), codes);
}

void writeCodes(const CostRowPointer& costs, const RowTerms& terms, const ColumnSpan& span,
                const DisparityRange& range, int i, const MatcherConstants& constants,
                const MatcherCodeMaps& maps, const CodeLines& codes) {
  const auto store = [maps, codes](auto tag, int feature, int x, auto value) HWY_ATTR {
    storeCodes(tag, value, maps[feature].scale, maps[feature].offset, codes[feature] + x);
  };
  std::visit([&](const auto* row)
                 HWY_ATTR { forFeatures(*row, terms, span, range, i, constants, store); },
             costs);
}

void quantizeValues(const CodeMap& map, const float* values, int count, std::uint8_t* codes) {
  forLanes(Floats(), 0, count, [=](auto tag, int x, int) HWY_ATTR {
    storeCodes(tag, hn::LoadU(tag, values + x), map.scale, map.offset, codes + x);
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(fillTerms);
HWY_EXPORT(writeFeatures);
HWY_EXPORT(writeCodes);
HWY_EXPORT(quantizeValues);

void resizeTerms(PixelTerms& terms, int width) {
  terms.lowest_cost.assign(width, std::numeric_limits<float>::max());
  terms.log_lowest_cost.resize(width);
  terms.log_sum.assign(width, 0.0F);
}

}  // namespace

void PixelTerms::reserve(int width) {
  for (std::vector<float>* terms : {&lowest_cost, &log_lowest_cost, &log_sum}) {
    terms->reserve(width);
  }
}

void computeRowTerms(const CostRowPointer& costs, int width, const DisparityRange& range,
                     const MatcherConstants& constants, RowTerms& terms, const RowSpans* spans) {
  resizeTerms(terms.left, width);
  resizeTerms(terms.right, width);
  HWY_DYNAMIC_DISPATCH(fillTerms)(costs, width, range, constants, spans, terms);
}

void computeFeatures(const CostRowPointer& costs, const RowTerms& terms, int width,
                     const DisparityRange& range, int i, const MatcherConstants& constants,
                     const FeatureLines& values) {
  computeFeaturesInSpan(costs, terms, matchedColumns(width, range.min + i), range, i, constants,
                        values);
}

void computeCodes(const CostRowPointer& costs, const RowTerms& terms, int width,
                  const DisparityRange& range, int i, const MatcherConstants& constants,
                  const MatcherCodeMaps& maps, const CodeLines& codes) {
  computeCodesInSpan(costs, terms, matchedColumns(width, range.min + i), range, i, constants, maps,
                     codes);
}

void computeFeaturesInSpan(const CostRowPointer& costs, const RowTerms& terms,
                           const ColumnSpan& span, const DisparityRange& range, int i,
                           const MatcherConstants& constants, const FeatureLines& values) {
  HWY_DYNAMIC_DISPATCH(writeFeatures)(costs, terms, span, range, i, constants, values);
}

void computeCodesInSpan(const CostRowPointer& costs, const RowTerms& terms, const ColumnSpan& span,
                        const DisparityRange& range, int i, const MatcherConstants& constants,
                        const MatcherCodeMaps& maps, const CodeLines& codes) {
  HWY_DYNAMIC_DISPATCH(writeCodes)(costs, terms, span, range, i, constants, maps, codes);
}

void quantize(const CodeMap& map, const float* values, int count, std::uint8_t* codes) {
  HWY_DYNAMIC_DISPATCH(quantizeValues)(map, values, count, codes);
}

}  // namespace cbmv
#endif  // HWY_ONCE
