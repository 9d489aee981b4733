// Transposition of the costs of a tile. Compiled once per instruction set.
#if defined(CBMV_OPTIMIZATION_TILE_TRANSPOSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_OPTIMIZATION_TILE_TRANSPOSE_INL_H
#undef CBMV_OPTIMIZATION_TILE_TRANSPOSE_INL_H
#else
#define CBMV_OPTIMIZATION_TILE_TRANSPOSE_INL_H
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "base/search_space.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A vector has half a tile, or the whole tile with its halves in the two 128-bit blocks.
#undef CBMV_TRANSPOSE_COLUMNS
#if HWY_HAVE_SCALABLE || HWY_MAX_BYTES < 32
#define CBMV_TRANSPOSE_COLUMNS 8
#else
#define CBMV_TRANSPOSE_COLUMNS 16
#endif
using TransposeTag = hn::CappedTag<std::uint16_t, CBMV_TRANSPOSE_COLUMNS>;

/// Lanes that are transposed at once.
constexpr int kTransposeLanes = 8;

template <class V>
HWY_INLINE void interleave(V& a, V& b) {
  const TransposeTag tag;
  const auto lower = hn::InterleaveLower(tag, a, b);
  b = hn::InterleaveUpper(tag, a, b);
  a = lower;
}

/// Transposes the 8 x 8 values of each 128-bit block. An array of vectors is not possible on every
/// instruction set.
template <class V>
HWY_INLINE void transposeBlocks(V& a, V& b, V& c, V& d, V& e, V& f, V& g, V& h) {
  interleave(a, e);
  interleave(b, f);
  interleave(c, g);
  interleave(d, h);
  interleave(a, c);
  interleave(b, d);
  interleave(e, g);
  interleave(f, h);
  interleave(a, b);
  interleave(c, d);
  interleave(e, f);
  interleave(g, h);
}

/// Loads the kTransposeLanes values of a column in each block of a vector. Blocks are `distance`
/// apart in memory.
HWY_INLINE hn::Vec<TransposeTag> loadBlocks(const std::uint16_t* values,
                                            [[maybe_unused]] std::ptrdiff_t distance) {
  const TransposeTag tag;
#if CBMV_TRANSPOSE_COLUMNS == 8
  return hn::LoadU(tag, values);
#else
  const hn::Half<TransposeTag> half;
  return hn::Combine(tag, hn::LoadU(half, values + distance), hn::LoadU(half, values));
#endif
}
HWY_INLINE void storeBlocks(hn::Vec<TransposeTag> blocks, std::uint16_t* values,
                            [[maybe_unused]] std::ptrdiff_t distance) {
#if CBMV_TRANSPOSE_COLUMNS == 8
  hn::StoreU(blocks, TransposeTag(), values);
#else
  const hn::Half<TransposeTag> half;
  hn::StoreU(hn::LowerHalf(half, blocks), half, values);
  hn::StoreU(hn::UpperHalf(half, blocks), half, values + distance);
#endif
}

/// Transposes [lane][column] to [column][lane] with rows that are `stride` apart. load(lane,
/// column) returns CBMV_TRANSPOSE_COLUMNS values of a lane from a column on. Lanes are written up
/// to a multiple of kTransposeLanes; those from `lanes` on get the values of the last lane.
template <typename Load>
HWY_INLINE void lanesToPixels(int lanes, std::ptrdiff_t stride, std::uint16_t* pixels,
                              const Load& load) {
  for (int lane = 0; lane < lanes; lane += kTransposeLanes) {
    const auto load_lane = [&](int i, int column)
                               HWY_ATTR { return load(std::min(lane + i, lanes - 1), column); };
    for (int column = 0; column < kTileColumns; column += CBMV_TRANSPOSE_COLUMNS) {
      auto a = load_lane(0, column);
      auto b = load_lane(1, column);
      auto c = load_lane(2, column);
      auto d = load_lane(3, column);
      auto e = load_lane(4, column);
      auto f = load_lane(5, column);
      auto g = load_lane(6, column);
      auto h = load_lane(7, column);
      transposeBlocks(a, b, c, d, e, f, g, h);
      std::uint16_t* out = pixels + column * stride + lane;
      storeBlocks(a, out + 0 * stride, 8 * stride);
      storeBlocks(b, out + 1 * stride, 8 * stride);
      storeBlocks(c, out + 2 * stride, 8 * stride);
      storeBlocks(d, out + 3 * stride, 8 * stride);
      storeBlocks(e, out + 4 * stride, 8 * stride);
      storeBlocks(f, out + 5 * stride, 8 * stride);
      storeBlocks(g, out + 6 * stride, 8 * stride);
      storeBlocks(h, out + 7 * stride, 8 * stride);
    }
  }
}

/// The inverse, to rows of kTileColumns values. Lanes are read up to a multiple of kTransposeLanes.
HWY_INLINE void pixelsToLanes(const std::uint16_t* pixels, std::ptrdiff_t stride, int lanes,
                              std::uint16_t* entries) {
  const TransposeTag tag;
  for (int lane = 0; lane < lanes; lane += kTransposeLanes) {
    for (int column = 0; column < kTileColumns; column += CBMV_TRANSPOSE_COLUMNS) {
      const std::uint16_t* in = pixels + column * stride + lane;
      auto a = loadBlocks(in + 0 * stride, 8 * stride);
      auto b = loadBlocks(in + 1 * stride, 8 * stride);
      auto c = loadBlocks(in + 2 * stride, 8 * stride);
      auto d = loadBlocks(in + 3 * stride, 8 * stride);
      auto e = loadBlocks(in + 4 * stride, 8 * stride);
      auto f = loadBlocks(in + 5 * stride, 8 * stride);
      auto g = loadBlocks(in + 6 * stride, 8 * stride);
      auto h = loadBlocks(in + 7 * stride, 8 * stride);
      transposeBlocks(a, b, c, d, e, f, g, h);
      std::uint16_t* out = entries + lane * kTileColumns + column;
      const auto store = [&](int i, const auto& values) HWY_ATTR {
        if (lane + i < lanes) {
          hn::Store(values, tag, out + i * kTileColumns);
        }
      };
      store(0, a);
      store(1, b);
      store(2, c);
      store(3, d);
      store(4, e);
      store(5, f);
      store(6, g);
      store(7, h);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
