#include "cbmv_stereo/matching/census_transform.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "cbmv_stereo/matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/census_transform.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;

/// `bits[x]`: which of the `count` ≤ 8 neighbours at the given distances in memory are darker than
/// the pixel itself.
void compareNeighbours(const std::uint8_t* pixels, const std::ptrdiff_t* distances, int count,
                       int width, std::uint8_t* bits) {
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(compareNeighbours);

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

void CensusTransform::compute(const cv::Mat& padded, cv::Size window) {
  findNeighbours(window, static_cast<std::ptrdiff_t>(padded.step1()), neighbour_distances_);
  const int neighbours = static_cast<int>(neighbour_distances_.size());
  const int height = padded.rows - 2 * kMatchingBorderPx;
  width_ = padded.cols - 2 * kMatchingBorderPx;
  bytes_ = (neighbours + 7) / 8;
  bits_.resize(static_cast<std::size_t>(height) * bytes_ * width_);
  tbb::parallel_for(0, height, [&](int y) {
    for (int k = 0; k < bytes_; ++k) {
      HWY_DYNAMIC_DISPATCH(compareNeighbours)
      (paddedRow<std::uint8_t>(padded, y), &neighbour_distances_[8 * k],
       std::min(8, neighbours - 8 * k), width_,
       bits_.data() + (static_cast<std::size_t>(y) * bytes_ + k) * width_);
    }
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
