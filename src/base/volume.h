#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

namespace cbmv {

/// Allocates memory that starts at a cache line, which is the alignment of the widest vectors.
template <typename Value>
struct CacheLineAllocator {
  using value_type = Value;
  static constexpr std::align_val_t kCacheLine{64};

  CacheLineAllocator() = default;
  template <typename Other>
  explicit CacheLineAllocator(const CacheLineAllocator<Other>& /*other*/) {}

  Value* allocate(std::size_t count) {
    return static_cast<Value*>(::operator new(count * sizeof(Value), kCacheLine));
  }
  void deallocate(Value* values, std::size_t /*count*/) { ::operator delete(values, kCacheLine); }

  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
  friend bool operator!=(const CacheLineAllocator&, const CacheLineAllocator&) { return false; }
};

/// This many bytes beyond the last value may be read, but not written. So two whole vectors can be
/// read from any value on.
constexpr std::size_t kReadableBytesBeyond = 128;

/// Dense array with one cost per hypothesis, laid out [y][x][d]: the costs of a pixel are
/// contiguous. kReadableBytesBeyond the last cost are readable. `resize` keeps the memory if the
/// new volume fits, so a stream of frames allocates once.
template <typename Cost>
class Volume {
 public:
  Volume() = default;
  Volume(int height, int width, int disparities) { resize(height, width, disparities); }

  /// Contents are unspecified afterwards.
  void resize(int height, int width, int disparities) {
    height_ = height;
    width_ = width;
    disparities_ = disparities;
    costs_.resize(size() + kReadableBytesBeyond / sizeof(Cost));
  }

  int height() const { return height_; }
  int width() const { return width_; }
  int disparities() const { return disparities_; }
  std::size_t size() const { return offset(height_, 0); }

  Cost* pixel(int y, int x) { return costs_.data() + offset(y, x); }
  const Cost* pixel(int y, int x) const { return costs_.data() + offset(y, x); }
  Cost* row(int y) { return pixel(y, 0); }
  const Cost* row(int y) const { return pixel(y, 0); }

 private:
  std::size_t offset(int y, int x) const {
    return (static_cast<std::size_t>(y) * width_ + x) * disparities_;
  }

  int height_ = 0;
  int width_ = 0;
  int disparities_ = 0;
  std::vector<Cost, CacheLineAllocator<Cost>> costs_;
};

/// Matching cost volume, from the forest: 1 − probability, in units of 1/255 (Batsos et al. 2018,
/// section 3.3). Hypotheses whose match is outside of the other image have kOutsideCost.
using MatchingVolume = Volume<std::uint8_t>;
constexpr std::uint8_t kOutsideCost = 255;

/// Cost volume during CBCA and SGM, in the same unit (1/255) unless a function states another one.
using AggregatedVolume = Volume<std::uint16_t>;

}  // namespace cbmv
