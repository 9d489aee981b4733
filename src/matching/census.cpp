#include "cbmv_stereo/matching/census.h"

#include <array>
#include <cstddef>

#include "cbmv_stereo/matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/census.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;

/// `bits[x]`: which of the eight neighbours at the given distances in memory are darker than the
/// pixel itself.
HWY_INLINE void compareNeighbours(const std::uint8_t* pixels, const std::ptrdiff_t* distances,
                                  int width, std::uint8_t* bits) {
  forLanes(Bytes(), 0, width, [=](auto tag, int x, int) HWY_ATTR {
    const auto centre = hn::LoadU(tag, pixels + x);
    auto darker = hn::Zero(tag);
    for (int bit = 0; bit < 8; ++bit) {
      const auto neighbour = hn::LoadU(tag, pixels + x + distances[bit]);
      darker = hn::Or(darker, hn::IfThenElseZero(hn::Lt(neighbour, centre),
                                                 hn::Set(tag, 1U << static_cast<unsigned>(bit))));
    }
    hn::StoreU(darker, tag, bits + x);
  });
}

/// Byte k of column x at bits[k · width + x].
HWY_INLINE void transform(const std::uint8_t* pixels, const CensusMatcher::Distances& distances,
                          int width, std::uint8_t* bits) {
  for (int k = 0; k < CensusMatcher::kBytes; ++k) {
    compareNeighbours(pixels, &distances[8 * k], width, bits + k * width);
  }
}

/// Hamming distances of all hypotheses. The last vector of a run reaches beyond it, into places
/// that come later.
HWY_INLINE void hammingDistances(const std::uint8_t* left, const std::uint8_t* right, int width,
                                 const RowEntries& entries, std::uint8_t* costs) {
  const Bytes tag;
  for (const RowEntries::Run& run : entries.runs()) {
    const std::uint8_t* match = right - run.d;
    std::uint8_t* line = costs + run.offset;
    for (int x = run.span.begin; x < run.span.end; x += static_cast<int>(hn::Lanes(tag))) {
      auto distance = hn::Zero(tag);
      for (int k = 0; k < CensusMatcher::kBytes; ++k) {
        const auto difference =
            hn::Xor(hn::LoadU(tag, left + k * width + x), hn::LoadU(tag, match + k * width + x));
        distance = hn::Add(distance, hn::PopulationCount(difference));
      }
      hn::StoreU(distance, tag, line + x);
    }
  }
}

void matchRow(const std::uint8_t* left_pixels, const std::uint8_t* right_pixels,
              const CensusMatcher::Distances& distances, int width, const RowEntries& entries,
              CensusMatcher::Scratch& scratch, std::uint8_t* costs) {
  transform(left_pixels, distances, width, scratch.left.data());
  transform(right_pixels, distances, width, scratch.right.data());
  hammingDistances(scratch.left.data(), scratch.right.data(), width, entries, costs);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(matchRow);

CensusMatcher::Distances neighbourDistances(std::ptrdiff_t stride) {
  constexpr int kRadius = CensusMatcher::kWindowPx / 2;
  CensusMatcher::Distances distances{};
  std::size_t count = 0;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      if (dy != 0 || dx != 0) {
        distances[count++] = dy * stride + dx;
      }
    }
  }
  return distances;
}

}  // namespace

void CensusMatcher::Scratch::resize(int width) {
  const std::size_t size = static_cast<std::size_t>(width) * kBytes + kReadableBytesBeyond;
  left.resize(size);
  right.resize(size);
}

void CensusMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  padded_left_ = padded_left;
  padded_right_ = padded_right;
  distances_ = neighbourDistances(static_cast<std::ptrdiff_t>(padded_left.step1()));
}

void CensusMatcher::computeRow(int y, const RowEntries& entries, Scratch& scratch,
                               CostRow<std::uint8_t>& costs) const {
  const int width = padded_left_.cols - 2 * kMatchingBorderPx;
  costs.resize(entries.count());
  scratch.resize(width);
  HWY_DYNAMIC_DISPATCH(matchRow)
  (paddedRow<std::uint8_t>(padded_left_, y), paddedRow<std::uint8_t>(padded_right_, y), distances_,
   width, entries, scratch, costs.entry(0));
}

}  // namespace cbmv
#endif  // HWY_ONCE
