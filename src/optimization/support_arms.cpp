#include "cbmv_stereo/optimization/support_arms.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// Arms of a row of pixels in one direction, all at once: each step looks at the neighbours of the
/// whole row, which the compiler turns into vectors.
class ArmRow {
 public:
  explicit ArmRow(int width) : growing_(width), lengths_(width) {}

  /// `centres` is the row; neighbours lie `stride` elements apart. `inside(k)` are the columns
  /// whose k-th neighbour lies inside of the image. Arms take in neighbours that differ by at most
  /// `largest_step` grey levels.
  template <typename Inside>
  void grow(const std::uint8_t* centres, std::ptrdiff_t stride, int reach, int largest_step,
            const Inside& inside) {
    std::fill(growing_.begin(), growing_.end(), std::uint8_t{1});
    std::fill(lengths_.begin(), lengths_.end(), std::uint8_t{0});
    bool any = true;
    for (int k = 1; k <= reach && any; ++k) {
      any =
          takeIn(centres, centres + k * stride, inside(k), static_cast<std::uint8_t>(largest_step));
    }
  }

  std::uint8_t length(int x) const { return lengths_[x]; }

 private:
  /// Whether any arm still grows.
  bool takeIn(const std::uint8_t* centres, const std::uint8_t* neighbours, const cv::Range& columns,
              std::uint8_t largest_step) {
    std::uint8_t* growing = growing_.data();
    std::uint8_t* lengths = lengths_.data();
    std::uint8_t any = 0;
    for (int x = columns.start; x < columns.end; ++x) {
      const std::uint8_t low = std::min(centres[x], neighbours[x]);
      const std::uint8_t high = std::max(centres[x], neighbours[x]);
      const auto step = static_cast<std::uint8_t>(high - low);
      growing[x] = step <= largest_step ? growing[x] : 0;
      lengths[x] = static_cast<std::uint8_t>(lengths[x] + growing[x]);
      any |= growing[x];
    }
    return any != 0;
  }

  std::vector<std::uint8_t> growing_;  // 1 or 0
  std::vector<std::uint8_t> lengths_;
};

/// The four arms of the pixels of a row.
class ArmsOfRow {
 public:
  ArmsOfRow(const cv::Mat& image, int reach, int largest_step)
      : image_(image), reach_(reach), largest_step_(largest_step), arms_(4, ArmRow(image.cols)) {}

  void compute(int y, cv::Vec4b* out) {
    const auto stride = static_cast<std::ptrdiff_t>(image_.step1());
    const auto* centres = image_.ptr<std::uint8_t>(y);
    const int width = image_.cols;
    const auto all = [width](int) { return cv::Range(0, width); };
    arms_[0].grow(centres, -1, std::min(reach_, width), largest_step_,
                  [width](int k) { return cv::Range(k, width); });
    arms_[1].grow(centres, 1, std::min(reach_, width), largest_step_,
                  [width](int k) { return cv::Range(0, width - k); });
    arms_[2].grow(centres, -stride, std::min(reach_, y), largest_step_, all);
    arms_[3].grow(centres, stride, std::min(reach_, image_.rows - 1 - y), largest_step_, all);
    for (int x = 0; x < width; ++x) {
      out[x] = {arms_[0].length(x), arms_[1].length(x), arms_[2].length(x), arms_[3].length(x)};
    }
  }

 private:
  const cv::Mat& image_;
  int reach_;
  int largest_step_;
  std::vector<ArmRow> arms_;  // left, right, up, down
};

}  // namespace

void computeSupportArms(const cv::Mat& grey, int max_length, float threshold_grey, cv::Mat& arms) {
  CV_Assert(grey.type() == CV_8UC1);
  if (max_length < 1 || max_length > 255) {
    throw Error("The arm length of cost aggregation is " + std::to_string(max_length) +
                " px; it must be between 1 and 255.");
  }
  const cv::Mat image = grey;  // stays valid when `arms` is the same object
  arms.create(image.size(), CV_8UC4);
  // A whole number is below the threshold exactly when it is below the threshold rounded up.
  const int threshold = static_cast<int>(std::ceil(std::min(threshold_grey, 256.0F)));
  const int reach = threshold > 0 ? max_length - 1 : 0;
  tbb::parallel_for(tbb::blocked_range<int>(0, image.rows), [&](const auto& rows) {
    ArmsOfRow arms_of_row(image, reach, threshold - 1);
    for (int y = rows.begin(); y != rows.end(); ++y) {
      arms_of_row.compute(y, arms.ptr<cv::Vec4b>(y));
    }
  });
}

}  // namespace cbmv
