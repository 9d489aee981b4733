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

/// `bits[x]`: which of the `count` ≤ 8 neighbours at the given distances in memory are darker than
/// the pixel itself.
HWY_INLINE void compareNeighbours(const std::uint8_t* pixels, const std::ptrdiff_t* first_distance,
                                  int count, int width, std::uint8_t* bits) {
  std::array<std::ptrdiff_t, 8> distances{};  // own ones: a store of a byte may change others
  std::copy_n(first_distance, count, distances.begin());
  forLanes(Bytes(), 0, width, [=](auto tag, int x, int) HWY_ATTR {
    const auto centre = hn::LoadU(tag, pixels + x);
    auto darker = hn::Zero(tag);
    for (int bit = 0; bit < count; ++bit) {
      const auto neighbour = hn::LoadU(tag, pixels + x + distances[bit]);
      darker = hn::Or(darker, hn::IfThenElseZero(hn::Lt(neighbour, centre),
                                                 hn::Set(tag, 1U << static_cast<unsigned>(bit))));
    }
    hn::StoreU(darker, tag, bits + x);
  });
}

void transformRow(const std::uint8_t* pixels, const std::vector<std::ptrdiff_t>& distances,
                  int width, std::uint8_t* bits) {
  std::size_t first = 0;
  for (; first + 8 <= distances.size(); first += 8, bits += width) {
    compareNeighbours(pixels, &distances[first], 8, width, bits);
  }
  if (first < distances.size()) {
    compareNeighbours(pixels, &distances[first], static_cast<int>(distances.size() - first), width,
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

/// From a pixel to its neighbours in memory, in raster order.
void findNeighbours(cv::Size window, std::ptrdiff_t stride,
                    std::vector<std::ptrdiff_t>& distances) {
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
  findNeighbours(window, static_cast<std::ptrdiff_t>(padded.step1()), neighbour_distances_);
}

void CensusTransform::computeRow(int y, std::uint8_t* bits) const {
  HWY_DYNAMIC_DISPATCH(transformRow)
  (paddedRow<std::uint8_t>(padded_, y), neighbour_distances_, width_, bits);
}

}  // namespace cbmv
#endif  // HWY_ONCE
