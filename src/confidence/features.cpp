#include "confidence/features.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <variant>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "confidence/features.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "confidence/fast_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;

/// Calls f(tag, k, 0) with vectors of all columns of a tile.
template <class F>
HWY_INLINE void forTile(const F& f) {
  for (int k = 0; k < kTileColumns; k += static_cast<int>(hn::Lanes(Floats()))) {
    f(Floats(), k, 0);
  }
}

/// Loads a vector of costs in the unit of the matcher's constants. The unit is 1 except for some
/// 16-bit costs.
template <class D, typename Cost>
HWY_INLINE hn::Vec<D> loadCosts(D tag, const Cost* costs, [[maybe_unused]] float unit) {
  if constexpr (std::is_same_v<Cost, float>) {
    return hn::LoadU(tag, costs);
  } else {
    const auto narrow = hn::LoadU(hn::Rebind<Cost, D>(), costs);
    const auto wide = hn::ConvertTo(tag, hn::PromoteTo(hn::RebindToSigned<D>(), narrow));
    return std::is_same_v<Cost, std::uint8_t> ? wide : hn::Mul(wide, hn::Set(tag, unit));
  }
}

/// Calls f(tag, k, done) with vectors that cover exactly the columns of an entry inside of both
/// images. For `done` see forLanes.
template <class F>
HWY_INLINE void forInside(const RowEntries::Entry& entry, const F& f) {
  if (entry.isWhole()) {
    forTile(f);
  } else {
    forLanes(Floats(), entry.begin, entry.end, f);
  }
}

/// The costs of a row, in the order of the places.
template <typename Cost>
struct Costs {
  const Cost* costs;  ///< at the first place
  const RowEntries::Entry* entries;
  int count;
  MatcherConstants constants;
};

template <typename Cost>
Costs<Cost> costsAt(const CostRow<Cost>& costs, const RowEntries& entries, const PlaceSpan& places,
                    const MatcherConstants& constants) {
  return {costs.entry(places.begin), entries.entries() + places.begin, places.count(), constants};
}

/// Computes c_min of both views.
template <typename Cost>
void findLowestCosts(const Costs<Cost>& row, float* left_lowest, float* right_lowest) {
  const float unit = row.constants.cost_unit;
  const Cost* costs = row.costs;
  const RowEntries::Entry* const end = row.entries + row.count;
  for (const RowEntries::Entry* entry = row.entries; entry != end; ++entry) {
    float* left = left_lowest + entry->column;
    float* right = right_lowest + entry->right_column;
    forInside(*entry, [=](auto tag, int k, int) HWY_ATTR {
      const auto cost = loadCosts(tag, costs + k, unit);
      hn::StoreU(hn::Min(hn::LoadU(tag, left + k), cost), tag, left + k);
      hn::StoreU(hn::Min(hn::LoadU(tag, right + k), cost), tag, right + k);
    });
    costs += kTileColumns;
  }
}

/// (C − c_min)² · factor. With the factor −1 / 2σ², it is the logarithm of the likelihood.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V scaledSquare(D tag, V cost, const float* lowest, float factor) {
  const V difference = hn::Sub(cost, hn::LoadU(tag, lowest));
  return hn::Mul(hn::Mul(difference, difference), hn::Set(tag, factor));
}

/// Adds 2^value to the lanes of `sums`, except the first `done`.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void addExp2(D tag, V value, int done, float* sums) {
  const V before = hn::LoadU(tag, sums);
  V after = hn::Add(before, exp2OfNegative(tag, value));
  if (done > 0) {
    after = hn::IfThenElse(hn::FirstN(tag, done), before, after);
  }
  hn::StoreU(after, tag, sums);
}

/// Computes Σ exp(−(C − c_min)² / 2σ²) of both views.
template <typename Cost>
void sumLikelihoods(const Costs<Cost>& row, const float* left_lowest, const float* right_lowest,
                    float* left_sum, float* right_sum) {
  const float unit = row.constants.cost_unit;
  constexpr float kLog2E = 1.44269504F;
  const float factor = -kLog2E / row.constants.two_sigma_squared;
  const Cost* costs = row.costs;
  const RowEntries::Entry* const end = row.entries + row.count;
  for (const RowEntries::Entry* entry = row.entries; entry != end; ++entry) {
    const std::ptrdiff_t left = entry->column;
    const std::ptrdiff_t right = entry->right_column;
    forInside(*entry, [=](auto tag, int k, int done) HWY_ATTR {
      const auto cost = loadCosts(tag, costs + k, unit);
      addExp2(tag, scaledSquare(tag, cost, left_lowest + left + k, factor), done,
              left_sum + left + k);
      addExp2(tag, scaledSquare(tag, cost, right_lowest + right + k, factor), done,
              right_sum + right + k);
    });
    costs += kTileColumns;
  }
}

void takeLogarithms(int width, float epsilon, PixelTerms& terms) {
  const float* lowest = terms.lowest_cost.data() + PixelTerms::kBefore;
  float* log_lowest = terms.log_lowest_cost.data() + PixelTerms::kBefore;
  float* log_sum = terms.log_sum.data() + PixelTerms::kBefore;
  forLanes(Floats(), 0, width, [=](auto tag, int x, int done) HWY_ATTR {
    const auto shifted = hn::Add(hn::LoadU(tag, lowest + x), hn::Set(tag, epsilon));
    hn::StoreU(logOfPositive(tag, shifted), tag, log_lowest + x);
    const auto sum = hn::LoadU(tag, log_sum + x);
    hn::StoreU(hn::IfThenElse(hn::FirstN(tag, done), sum, logOfPositive(tag, sum)), tag,
               log_sum + x);
  });
}

void fillTerms(const CostRowPointer& costs, const RowEntries& entries, int width,
               const MatcherConstants& constants, RowTerms& terms) {
  float* left_lowest = terms.left.lowest_cost.data() + PixelTerms::kBefore;
  float* right_lowest = terms.right.lowest_cost.data() + PixelTerms::kBefore;
  std::visit(
      [&](const auto* costs_of_row) HWY_ATTR {
        const auto row = costsAt(*costs_of_row, entries, {0, entries.count()}, constants);
        findLowestCosts(row, left_lowest, right_lowest);
        sumLikelihoods(row, left_lowest, right_lowest,
                       terms.left.log_sum.data() + PixelTerms::kBefore,
                       terms.right.log_sum.data() + PixelTerms::kBefore);
      },
      costs);
  takeLogarithms(width, constants.epsilon, terms.left);
  takeLogarithms(width, constants.epsilon, terms.right);
}

/// Calls f(tag, i) with vectors that cover all hypotheses of `count` places. i is the index of the
/// first hypothesis of a vector.
template <class F>
HWY_INLINE void forHypotheses(int count, const F& f) {
  const int lanes = static_cast<int>(hn::Lanes(Floats()));
  for (int i = 0; i < count * kTileColumns; i += lanes) {
    f(Floats(), i);
  }
}

/// Calls f(tag, i, left, right) with vectors that cover all hypotheses. i is the index of the first
/// hypothesis of a vector. left and right are the indices of its pixels in PixelTerms.
template <typename Cost, class F>
HWY_INLINE void forMatches(const Costs<Cost>& block, const F& f) {
  const RowEntries::Entry* entries = block.entries;
  const int count = block.count;
  for (int p = 0; p < count; ++p) {
    const std::ptrdiff_t left = PixelTerms::kBefore + entries[p].column;
    const std::ptrdiff_t right = PixelTerms::kBefore + entries[p].right_column;
    forTile([=](auto tag, int k, int)
                HWY_ATTR { f(tag, p * kTileColumns + k, left + k, right + k); });
  }
}

/// Passes vectors of kCost to `sink` and stores log(C + ε).
template <typename Cost, class Sink>
HWY_INLINE void passCosts(const Costs<Cost>& block, float* log_costs, const Sink& sink) {
  const MatcherConstants c = block.constants;
  const Cost* costs = block.costs;
  forHypotheses(block.count, [=](auto tag, int i) HWY_ATTR {
    const auto cost = loadCosts(tag, costs + i, c.cost_unit);
    const auto log_cost = logOfPositive(tag, hn::Add(cost, hn::Set(tag, c.epsilon)));
    hn::Store(log_cost, tag, log_costs + i);
    if (c.logarithmic_cost) {
      sink(tag, kCost, i, log_cost);
    } else {
      sink(tag, kCost, i, cost);
    }
  });
}

template <typename Cost, class Sink>
HWY_INLINE void passRatios(const Costs<Cost>& block, const RowTerms& terms, const float* log_costs,
                           const Sink& sink) {
  const float* left_terms = terms.left.log_lowest_cost.data();
  const float* right_terms = terms.right.log_lowest_cost.data();
  forMatches(block, [=](auto tag, int i, std::ptrdiff_t left_x, std::ptrdiff_t right_x) HWY_ATTR {
    const auto log_cost = hn::Load(tag, log_costs + i);
    const auto left = hn::Sub(hn::LoadU(tag, left_terms + left_x), log_cost);
    const auto right = hn::Sub(hn::LoadU(tag, right_terms + right_x), log_cost);
    sink(tag, kRatioLow, i, hn::Min(left, right));
    sink(tag, kRatioHigh, i, hn::Max(left, right));
  });
}

template <typename Cost, class Sink>
HWY_INLINE void passLikelihoods(const Costs<Cost>& block, const RowTerms& terms, const Sink& sink) {
  const float unit = block.constants.cost_unit;
  const float factor = -1.0F / block.constants.two_sigma_squared;
  const Cost* costs = block.costs;
  const float* left_lowest = terms.left.lowest_cost.data();
  const float* right_lowest = terms.right.lowest_cost.data();
  const float* left_log_sum = terms.left.log_sum.data();
  const float* right_log_sum = terms.right.log_sum.data();
  forMatches(block, [=](auto tag, int i, std::ptrdiff_t left_x, std::ptrdiff_t right_x) HWY_ATTR {
    const auto cost = loadCosts(tag, costs + i, unit);
    const auto left = hn::Sub(scaledSquare(tag, cost, left_lowest + left_x, factor),
                              hn::LoadU(tag, left_log_sum + left_x));
    const auto right = hn::Sub(scaledSquare(tag, cost, right_lowest + right_x, factor),
                               hn::LoadU(tag, right_log_sum + right_x));
    sink(tag, kLikelihoodLow, i, hn::Min(left, right));
    sink(tag, kLikelihoodHigh, i, hn::Max(left, right));
  });
}

/// Passes vectors of features of at most CodeBlock::kPlaces places to `sink(tag, feature, i,
/// values)`. i is the index of the first hypothesis of a vector. Uses one short loop per kind of
/// feature: in a long loop, each vector waits for a long chain of instructions, and too few vectors
/// are processed in parallel.
template <class Sink>
HWY_INLINE void forFeatures(const CostRowPointer& costs, const RowTerms& terms,
                            const RowEntries& entries, const PlaceSpan& places,
                            const MatcherConstants& constants, const Sink& sink) {
  HWY_ALIGN float log_costs[CodeBlock::kHypotheses];
  std::visit(
      [&](const auto* row) HWY_ATTR {
        const auto block = costsAt(*row, entries, places, constants);
        passCosts(block, log_costs, sink);
        passRatios(block, terms, log_costs, sink);
        passLikelihoods(block, terms, sink);
      },
      costs);
}

void writeFeatures(const CostRowPointer& costs, const RowTerms& terms, const RowEntries& entries,
                   const PlaceSpan& places, const MatcherConstants& constants,
                   const FeatureLines& values) {
  for (int place = places.begin; place < places.end; place += CodeBlock::kPlaces) {
    const PlaceSpan block{place, std::min(place + CodeBlock::kPlaces, places.end)};
    const int before = (place - places.begin) * kTileColumns;
    const auto store = [lines = values, before](auto tag, int feature, int i, auto value)
                           HWY_ATTR { hn::StoreU(value, tag, lines[feature] + before + i); };
    forFeatures(costs, terms, entries, block, constants, store);
  }
}

/// Stores the codes of the values, plus kShift (0 or 128) modulo 256.
template <unsigned kShift, class D, class V = hn::Vec<D>>
HWY_INLINE void storeCodes(D tag, V values, const CodeMap& map, std::uint8_t* codes) {
  const V code = hn::Add(hn::Mul(hn::Set(tag, map.scale), values), hn::Set(tag, map.offset));
  const V positive = hn::Max(code, hn::Zero(tag));
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  if constexpr (hn::MaxLanes(tag) == 16) {
    const __m512i whole = _mm512_cvttps_epi32(positive.raw);  // 2³¹ if it does not fit
    const __m128i bytes = _mm512_cvtusepi32_epi8(whole);      // saturated to 255
    const __m128i shift = _mm_set1_epi8(static_cast<char>(kShift));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(codes), _mm_xor_si128(bytes, shift));
    return;
  }
#endif
  const V cut = hn::Min(positive, hn::Set(tag, 255.0F));
  const hn::RebindToUnsigned<D> integer;
  const auto shifted = hn::Add(hn::Trunc(cut), hn::Set(tag, kUnitIsLowestBit + kShift));
  const auto low_byte = hn::And(hn::BitCast(integer, shifted), hn::Set(integer, 0xffU));
  hn::StoreU(hn::U8FromU32(low_byte), hn::Rebind<std::uint8_t, D>(), codes);
}

void writeCodes(const CostRowPointer& costs, const RowTerms& terms, const RowEntries& entries,
                const PlaceSpan& places, const MatcherConstants& constants, const CodeMap* maps,
                CodeBlock::Line* lines) {
  std::array<CodeMap, kFeaturesPerMatcher> own_maps{};
  std::copy_n(maps, kFeaturesPerMatcher, own_maps.begin());
  auto* codes = reinterpret_cast<std::uint8_t*>(lines->data());
  const auto store = [maps = own_maps, codes](auto tag, int feature, int i, auto value) HWY_ATTR {
    storeCodes<128>(tag, value, maps[feature], codes + feature * CodeBlock::kHypotheses + i);
  };
  forFeatures(costs, terms, entries, places, constants, store);
}

void quantizeValues(const CodeMap& map, const float* values, int count, std::uint8_t* codes) {
  forLanes(Floats(), 0, count, [=](auto tag, int x, int) HWY_ATTR {
    storeCodes<0>(tag, hn::LoadU(tag, values + x), map, codes + x);
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

/// Number of terms for an image row: its columns plus those of entries that extend beyond it.
std::size_t termsOfRow(int width) {
  return static_cast<std::size_t>(PixelTerms::kBefore) + width + kTileColumns;
}

}  // namespace

void PixelTerms::reserve(int width) {
  for (Line* line : {&lowest_cost, &log_lowest_cost, &log_sum}) {
    line->reserve(termsOfRow(width));
  }
}

void PixelTerms::reset(int width) {
  lowest_cost.assign(termsOfRow(width), std::numeric_limits<float>::max());
  log_lowest_cost.resize(termsOfRow(width));
  log_sum.assign(termsOfRow(width), 0.0F);
}

void computeRowTerms(const CostRowPointer& costs, const RowEntries& entries, int width,
                     const MatcherConstants& constants, RowTerms& terms) {
  terms.left.reset(width);
  terms.right.reset(width);
  HWY_DYNAMIC_DISPATCH(fillTerms)(costs, entries, width, constants, terms);
}

void computeFeatures(const CostRowPointer& costs, const RowTerms& terms, const RowEntries& entries,
                     const PlaceSpan& places, const MatcherConstants& constants,
                     const FeatureLines& values) {
  HWY_DYNAMIC_DISPATCH(writeFeatures)(costs, terms, entries, places, constants, values);
}

void computeCodes(const CostRowPointer& costs, const RowTerms& terms, const RowEntries& entries,
                  const PlaceSpan& places, const MatcherConstants& constants, const CodeMap* maps,
                  CodeBlock::Line* lines) {
  HWY_DYNAMIC_DISPATCH(writeCodes)(costs, terms, entries, places, constants, maps, lines);
}

void quantize(const CodeMap& map, const float* values, int count, std::uint8_t* codes) {
  HWY_DYNAMIC_DISPATCH(quantizeValues)(map, values, count, codes);
}

}  // namespace cbmv
#endif  // HWY_ONCE
