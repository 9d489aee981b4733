#include "matching/census_transform.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/census_transform.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;

/// Sets `bits[x]` to the bits of the `count` ≤ 8 neighbors at the given memory distances. A bit is
/// 1 if the neighbor is darker than the pixel.
HWY_INLINE void compareNeighbors(const std::uint8_t* pixels, const std::ptrdiff_t* first_distance,
                                 int count, int width, std::uint8_t* bits) {
  std::array<std::ptrdiff_t, 8> distances{};  // local copy: storing a byte may alias others
  std::copy_n(first_distance, count, distances.begin());
  forLanes(Bytes(), 0, width, [=](auto tag, int x, int) HWY_ATTR {
    const auto center = hn::LoadU(tag, pixels + x);
    auto darker = hn::Zero(tag);
    for (int bit = 0; bit < count; ++bit) {
      const auto neighbor = hn::LoadU(tag, pixels + x + distances[bit]);
      darker = hn::Or(darker, hn::IfThenElseZero(hn::Lt(neighbor, center),
                                                 hn::Set(tag, 1U << static_cast<unsigned>(bit))));
    }
    hn::StoreU(darker, tag, bits + x);
  });
}

void transformRow(const std::uint8_t* pixels, const std::vector<std::ptrdiff_t>& distances,
                  int width, std::uint8_t* bits) {
  std::size_t first = 0;
  for (; first + 8 <= distances.size(); first += 8, bits += width) {
    compareNeighbors(pixels, &distances[first], 8, width, bits);
  }
  if (first < distances.size()) {
    compareNeighbors(pixels, &distances[first], static_cast<int>(distances.size() - first), width,
                     bits);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(transformRow);

/// Distances in memory from a pixel to its neighbors, in raster order.
void findNeighbors(cv::Size window, std::ptrdiff_t stride, std::vector<std::ptrdiff_t>& distances) {
  distances.clear();
  for (int dy = -window.height / 2; dy <= window.height / 2; ++dy) {
    for (int dx = -window.width / 2; dx <= window.width / 2; ++dx) {
      if (dy != 0 || dx != 0) {
        distances.push_back(dy * stride + dx);
      }
    }
  }
}

}  // namespace

void CensusTransform::prepare(const cv::Mat& padded, cv::Size window) {
  padded_ = padded;
  width_ = padded.cols - 2 * kMatchingBorderPx;
  findNeighbors(window, static_cast<std::ptrdiff_t>(padded.step1()), neighbor_distances_);
}

void CensusTransform::computeRow(int y, std::uint8_t* bits) const {
  HWY_DYNAMIC_DISPATCH(transformRow)
  (paddedRow<std::uint8_t>(padded_, y), neighbor_distances_, width_, bits);
}

}  // namespace cbmv
#endif  // HWY_ONCE
