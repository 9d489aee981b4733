#include "forest/oblivious_evaluator.h"

#include <algorithm>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forest/oblivious_evaluator.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;
using ByteVector = hn::Vec<Bytes>;

/// Answers of one level, for the queries at `codes` (of feature 0) and behind.
HWY_INLINE hn::Mask<Bytes> isBelow(const PackedTree& tree, int level, const std::int8_t* codes) {
  const hn::RebindToSigned<Bytes> signed_bytes;
  const auto code = hn::Load(signed_bytes, codes + tree.lines[level]);
  return hn::RebindMask(Bytes(), hn::Lt(code, hn::Set(signed_bytes, tree.thresholds[level])));
}

/// Bits 0 … kLevels − 1 of the leaf's number.
template <int kLevels>
HWY_INLINE ByteVector leafNumber(const PackedTree& tree, const std::int8_t* codes) {
  const auto bit = hn::Set(Bytes(), 1U << (kLevels - 1));
  const auto is_below = isBelow(tree, kLevels - 1, codes);
  if constexpr (kLevels == 1) {
    return hn::IfThenElseZero(is_below, bit);
  } else {
    const ByteVector lower_bits = leafNumber<kLevels - 1>(tree, codes);
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    return hn::IfThenElse(is_below, hn::Add(lower_bits, bit), lower_bits);  // one instruction
#else
    return hn::Or(lower_bits, hn::IfThenElseZero(is_below, bit));
#endif
  }
}

#if HWY_TARGET == HWY_AVX3_DL

HWY_INLINE ByteVector lookUp128(const std::uint8_t* leaves, ByteVector number) {
  return ByteVector{_mm512_permutex2var_epi8(hn::LoadU(Bytes(), leaves).raw, number.raw,
                                             hn::LoadU(Bytes(), leaves + 64).raw)};
}

/// Leaf that each query falls into.
template <int kDepth>
HWY_INLINE ByteVector findLeaf(const PackedTree& tree, const std::int8_t* codes) {
  const std::uint8_t* leaves = tree.leaves.data();
  if constexpr (kDepth <= 6) {
    const ByteVector number = leafNumber<kDepth>(tree, codes);
    return ByteVector{_mm512_permutexvar_epi8(number.raw, hn::LoadU(Bytes(), leaves).raw)};
  } else {
    const ByteVector number = leafNumber<7>(tree, codes);
    if constexpr (kDepth == 7) {
      return lookUp128(leaves, number);
    } else {
      return hn::IfThenElse(isBelow(tree, 7, codes), lookUp128(leaves + 128, number),
                            lookUp128(leaves, number));
    }
  }
}

#else

/// Leaf among the 2^kLevels from `leaves` on: sub-tables of 16 leaves, selected level by level.
template <int kLevels>
HWY_INLINE ByteVector selectLeaf(const PackedTree& tree, [[maybe_unused]] const std::int8_t* codes,
                                 ByteVector low_bits, const std::uint8_t* leaves) {
  if constexpr (kLevels == 4) {
    return hn::TableLookupBytes(hn::LoadDup128(Bytes(), leaves), low_bits);
  } else {
    constexpr int half = 1 << (kLevels - 1);
    return hn::IfThenElse(isBelow(tree, kLevels - 1, codes),
                          selectLeaf<kLevels - 1>(tree, codes, low_bits, leaves + half),
                          selectLeaf<kLevels - 1>(tree, codes, low_bits, leaves));
  }
}

/// Leaf that each query falls into.
template <int kDepth>
HWY_INLINE ByteVector findLeaf(const PackedTree& tree, const std::int8_t* codes) {
  return selectLeaf<kDepth>(tree, codes, leafNumber<4>(tree, codes), tree.leaves.data());
}

#endif

HWY_INLINE ByteVector findLeaf(const PackedTree& tree, const std::int8_t* codes) {
  switch (tree.depth) {
    case 4:
      return findLeaf<4>(tree, codes);
    case 5:
      return findLeaf<5>(tree, codes);
    case 6:
      return findLeaf<6>(tree, codes);
    case 7:
      return findLeaf<7>(tree, codes);
    default:
      return findLeaf<8>(tree, codes);
  }
}

/// Sums of a vector of queries modulo 2¹⁶. Bytes are added in pairs: `pairs` holds the sums of
/// the even bytes plus 2⁸ times those of the odd ones, `odd` those of the odd ones.
using Sums = hn::Repartition<std::uint16_t, Bytes>;
using SumVector = hn::Vec<Sums>;
HWY_INLINE void addLeaf(ByteVector leaf, SumVector& pairs, SumVector& odd) {
  const SumVector pair = hn::BitCast(Sums(), leaf);
  pairs = hn::Add(pairs, pair);
  odd = hn::Add(odd, hn::ShiftRight<8>(pair));
}

HWY_INLINE void storeSums(SumVector pairs, SumVector odd, std::uint16_t* sums) {
  hn::StoreInterleaved2(hn::Sub(pairs, hn::ShiftLeft<8>(odd)), odd, Sums(), sums);
}

/// Sums of the leaves of the first `count` queries, two vectors at a time.
void sumLeavesOf(const PackedTree* trees, int tree_count, const std::int8_t* codes, int count,
                 std::uint16_t* sums) {
  const int lanes = static_cast<int>(hn::Lanes(Bytes()));
  for (int first = 0; first < count; first += 2 * lanes) {
    SumVector pairs0 = hn::Zero(Sums());
    SumVector pairs1 = pairs0;
    SumVector odd0 = pairs0;
    SumVector odd1 = pairs0;
    for (int t = 0; t < tree_count; ++t) {
      addLeaf(findLeaf(trees[t], codes + first), pairs0, odd0);
      addLeaf(findLeaf(trees[t], codes + first + lanes), pairs1, odd1);
    }
    storeSums(pairs0, odd0, sums + first);
    storeSums(pairs1, odd1, sums + first + lanes);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(sumLeavesOf);

PackedTree packTree(const ObliviousTree& tree) {
  const int depth = static_cast<int>(tree.levels.size());
  PackedTree packed;
  packed.depth = std::max(depth, PackedTree::kLeastDepth);
  packed.thresholds.fill(-128);
  for (int level = 0; level < depth; ++level) {
    packed.lines[level] =
        static_cast<std::uint32_t>(tree.levels[level].feature) * ObliviousEvaluator::kQueries;
    packed.thresholds[level] = static_cast<std::int8_t>(tree.levels[level].threshold - 128);
  }
  const std::int8_t lowest = *std::min_element(tree.leaves.begin(), tree.leaves.end());
  std::transform(tree.leaves.rbegin(), tree.leaves.rend(), packed.leaves.begin(),
                 [lowest](std::int8_t leaf) { return static_cast<std::uint8_t>(leaf - lowest); });
  return packed;
}

}  // namespace

ObliviousEvaluator::ObliviousEvaluator(const ObliviousForest& forest)
    : bias_(forest.bias), leaf_unit_(forest.leaf_unit) {
  for (const ObliviousTree& tree : forest.trees) {
    trees_.push_back(packTree(tree));
    const auto [lowest, highest] = std::minmax_element(tree.leaves.begin(), tree.leaves.end());
    lowest_sum_ += *lowest;
    highest_sum_ += *highest;
  }
}

void ObliviousEvaluator::sumLeaves(int first_tree, int tree_count, const std::int8_t* codes,
                                   int count, std::uint16_t* sums) const {
  HWY_DYNAMIC_DISPATCH(sumLeavesOf)(trees_.data() + first_tree, tree_count, codes, count, sums);
}

}  // namespace cbmv
#endif  // HWY_ONCE
