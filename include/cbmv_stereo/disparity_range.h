#pragma once

namespace cbmv {

/// The disparity range: `min`, `min + 1`, … `min + count − 1`, in px. `count` is the number of
/// disparities. A disparity is d = x_L − x_R; `min` may be negative. Index i of a cost volume is
/// the disparity d = min + i. In options, `count` = 0 selects the automatic range: the largest
/// disparity is found in the images. Every other range has at least one disparity.
struct DisparityRange {
  int min = 0;
  int count = 64;

  bool isAutomatic() const { return count == 0; }
  int max() const { return min + count - 1; }
  /// The value that marks a pixel without a disparity. It is below the range.
  float invalid() const { return static_cast<float>(min - 1); }
  bool operator==(const DisparityRange& other) const {
    return min == other.min && count == other.count;
  }
  bool operator!=(const DisparityRange& other) const { return !(*this == other); }
};

/// The image that a map or a cost volume is registered to. In the left view, hypothesis (x, d)
/// matches column x of the left image with column x − d of the right image. In the right view, it
/// matches column x of the right image with column x + d of the left image.
enum class View { kLeft, kRight };

/// The column of hypothesis (x, d) of `view` in the other image. It may lie outside of that image.
inline int matchingColumn(View view, int x, int d) { return view == View::kLeft ? x - d : x + d; }

}  // namespace cbmv
