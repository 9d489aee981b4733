#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cbmv {

/// Dense array of one cost per hypothesis, laid out [y][x][d]: the costs of a pixel are contiguous.
/// `resize` keeps the memory when the new volume fits, so a stream of frames allocates once.
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
    costs_.resize(static_cast<std::size_t>(height) * width * disparities);
  }

  int height() const { return height_; }
  int width() const { return width_; }
  int disparities() const { return disparities_; }
  std::size_t size() const { return costs_.size(); }

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
  std::vector<Cost> costs_;
};

/// Matching costs as the forest gives them: 1 − probability, in units of 1/255 (Batsos et al. 2018,
/// section 3.3). Hypotheses whose match lies outside of the other image hold kOutsideCost.
using MatchingVolume = Volume<std::uint8_t>;
constexpr std::uint8_t kOutsideCost = 255;

/// Costs during aggregation and semi-global matching, same unit (1/255) unless a function says
/// otherwise.
using OptimizedVolume = Volume<std::uint16_t>;

}  // namespace cbmv
