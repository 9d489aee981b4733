#include "matching/census.h"

#include <cstddef>

#include "matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/census.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;

/// Hamming distances of all hypotheses. Byte k of a column is `width` bytes after byte k − 1. The
/// last vector of a run writes beyond its end, into places that are written later.
void hammingDistances(const std::uint8_t* left, const std::uint8_t* right, int width,
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(hammingDistances);

}  // namespace

void CensusMatcher::Scratch::resize(int width) {
  const std::size_t size = static_cast<std::size_t>(width) * kBytes + kReadableBytesBeyond;
  left.resize(size);
  right.resize(size);
}

void CensusMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  const cv::Size window(kWindowPx, kWindowPx);
  left_.prepare(padded_left, window);
  right_.prepare(padded_right, window);
}

void CensusMatcher::computeRow(int y, const RowEntries& entries, Scratch& scratch,
                               CostRow<std::uint8_t>& costs) const {
  costs.resize(entries.count());
  scratch.resize(left_.width());
  left_.computeRow(y, scratch.left.data());
  right_.computeRow(y, scratch.right.data());
  HWY_DYNAMIC_DISPATCH(hammingDistances)
  (scratch.left.data(), scratch.right.data(), left_.width(), entries, costs.entry(0));
}

}  // namespace cbmv
#endif  // HWY_ONCE
