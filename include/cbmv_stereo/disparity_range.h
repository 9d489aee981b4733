#pragma once

namespace cbmv {

/// The disparities that are tested at every pixel: `min`, `min + 1`, … `min + count − 1`, in
/// pixels. Disparity is d = x_L − x_R; `min` may be negative. Index i of a volume stands for d =
/// min + i. In options, a `count` of 0 asks for the largest disparity to be found in the images;
/// every other range has one disparity at least.
struct DisparityRange {
  int min = 0;
  int count = 64;

  bool isAutomatic() const { return count == 0; }
  int max() const { return min + count - 1; }
  /// The single value, below every disparity of the range, that marks a pixel without a disparity.
  float invalid() const { return static_cast<float>(min - 1); }
  bool operator==(const DisparityRange& other) const {
    return min == other.min && count == other.count;
  }
  bool operator!=(const DisparityRange& other) const { return !(*this == other); }
};

/// Which image a map or a volume is registered to. In the left view, hypothesis (x, d) matches x in
/// the left image with x − d in the right one; in the right view, x in the right image with x + d
/// in the left one.
enum class View { kLeft, kRight };

/// Column in the other image of hypothesis (x, d) of `view`; may lie outside of that image.
inline int matchingColumn(View view, int x, int d) { return view == View::kLeft ? x - d : x + d; }

}  // namespace cbmv
