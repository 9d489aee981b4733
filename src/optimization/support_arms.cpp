#include "cbmv_stereo/optimization/support_arms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include <tbb/parallel_for.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// Pixels of a row whose arms grow at once: each step looks at the neighbours of them all, which
/// the compiler turns into vectors.
constexpr int kBlock = 256;

/// Arms of a block of pixels in one direction.
class BlockArms {
 public:
  /// `centres` is the row; neighbours lie `stride` elements apart. `inside(k)` are the columns
  /// whose k-th neighbour lies inside of the image. Arms take in neighbours that differ by at most
  /// `largest_step` grey levels.
  template <typename Inside>
  void grow(const std::uint8_t* centres, const cv::Range& block, std::ptrdiff_t stride, int reach,
            int largest_step, const Inside& inside) {
    growing_.fill(1);
    lengths_.fill(0);
    bool any = true;
    for (int k = 1; k <= reach && any; ++k) {
      const cv::Range columns = inside(k) & block;
      any = !columns.empty() &&
            takeIn(centres + columns.start, k * stride, columns.size(), columns.start - block.start,
                   static_cast<std::uint8_t>(largest_step));
    }
  }

  std::uint8_t length(int i) const { return lengths_[i]; }

 private:
  /// Whether any arm still grows.
  bool takeIn(const std::uint8_t* centres, std::ptrdiff_t distance, int count, int first,
              std::uint8_t largest_step) {
    const std::uint8_t* neighbours = centres + distance;
    std::uint8_t* growing = growing_.data() + first;
    std::uint8_t* lengths = lengths_.data() + first;
    std::uint8_t any = 0;
    for (int i = 0; i < count; ++i) {
      const std::uint8_t low = std::min(centres[i], neighbours[i]);
      const std::uint8_t high = std::max(centres[i], neighbours[i]);
      const auto step = static_cast<std::uint8_t>(high - low);
      growing[i] = step <= largest_step ? growing[i] : 0;
      lengths[i] = static_cast<std::uint8_t>(lengths[i] + growing[i]);
      any |= growing[i];
    }
    return any != 0;
  }

  std::array<std::uint8_t, kBlock> growing_{};  // 1 or 0
  std::array<std::uint8_t, kBlock> lengths_{};
};

/// The four arms of the pixels `block` of row y.
void computeBlock(const cv::Mat& image, int y, const cv::Range& block, int reach, int largest_step,
                  cv::Vec4b* out) {
  const auto stride = static_cast<std::ptrdiff_t>(image.step1());
  const auto* centres = image.ptr<std::uint8_t>(y);
  const int width = image.cols;
  const auto all = [width](int) { return cv::Range(0, width); };
  std::array<BlockArms, 4> arms;  // left, right, up, down
  arms[0].grow(centres, block, -1, reach, largest_step,
               [width](int k) { return cv::Range(std::min(k, width), width); });
  arms[1].grow(centres, block, 1, reach, largest_step,
               [width](int k) { return cv::Range(0, std::max(width - k, 0)); });
  arms[2].grow(centres, block, -stride, std::min(reach, y), largest_step, all);
  arms[3].grow(centres, block, stride, std::min(reach, image.rows - 1 - y), largest_step, all);
  for (int i = 0; i < block.size(); ++i) {
    out[block.start + i] = {arms[0].length(i), arms[1].length(i), arms[2].length(i),
                            arms[3].length(i)};
  }
}

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
  tbb::parallel_for(0, image.rows, [&](int y) {
    for (int x = 0; x < image.cols; x += kBlock) {
      computeBlock(image, y, {x, std::min(x + kBlock, image.cols)}, reach, threshold - 1,
                   arms.ptr<cv::Vec4b>(y));
    }
  });
}

}  // namespace cbmv
