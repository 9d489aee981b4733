#include "cbmv_stereo/matching/census.h"

#include <array>
#include <cstddef>

#include <tbb/parallel_for.h>

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
void compareNeighbours(const std::uint8_t* pixels, const std::ptrdiff_t* distances, int width,
                       std::uint8_t* bits) {
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

/// Hamming distances of all hypotheses. Byte k of a column lies `stride` behind byte k − 1. The
/// last vector of a run reaches beyond it, into places that come later.
void hammingDistances(const std::uint8_t* left, const std::uint8_t* right, int stride,
                      const RowEntries& entries, std::uint8_t* costs) {
  const Bytes tag;
  for (const RowEntries::Run& run : entries.runs()) {
    const std::uint8_t* match = right - run.d;
    std::uint8_t* line = costs + run.offset;
    for (int x = run.span.begin; x < run.span.end; x += static_cast<int>(hn::Lanes(tag))) {
      auto distance = hn::Zero(tag);
      for (int k = 0; k < CensusMatcher::kBytes; ++k) {
        const auto difference =
            hn::Xor(hn::LoadU(tag, left + k * stride + x), hn::LoadU(tag, match + k * stride + x));
        distance = hn::Add(distance, hn::PopulationCount(difference));
      }
      hn::StoreU(distance, tag, line + x);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(compareNeighbours);
HWY_EXPORT(hammingDistances);

/// From a pixel to its neighbours in memory, in raster order.
std::array<std::ptrdiff_t, 8 * CensusMatcher::kBytes> neighbourDistances(std::ptrdiff_t stride) {
  constexpr int kRadius = CensusMatcher::kWindowPx / 2;
  std::array<std::ptrdiff_t, 8 * CensusMatcher::kBytes> distances{};
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

void CensusMatcher::transform(const cv::Mat& padded, std::vector<std::uint8_t>& bits) const {
  const int height = padded.rows - 2 * kMatchingBorderPx;
  bits.resize(rowOffset(height) + kReadableBytesBeyond);
  const auto distances = neighbourDistances(static_cast<std::ptrdiff_t>(padded.step1()));
  tbb::parallel_for(0, height, [&](int y) {
    for (int k = 0; k < kBytes; ++k) {
      HWY_DYNAMIC_DISPATCH(compareNeighbours)
      (paddedRow<std::uint8_t>(padded, y), &distances[8 * k], width_,
       bits.data() + rowOffset(y) + static_cast<std::size_t>(k) * width_);
    }
  });
}

void CensusMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  width_ = padded_left.cols - 2 * kMatchingBorderPx;
  transform(padded_left, left_);
  transform(padded_right, right_);
}

void CensusMatcher::computeRow(int y, const RowEntries& entries,
                               CostRow<std::uint8_t>& costs) const {
  costs.resize(entries.count());
  HWY_DYNAMIC_DISPATCH(hammingDistances)
  (left_.data() + rowOffset(y), right_.data() + rowOffset(y), width_, entries, costs.entry(0));
}

}  // namespace cbmv
#endif  // HWY_ONCE
