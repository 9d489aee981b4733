#include "cbmv_stereo/refinement/median_filter.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// Median of the valid pixels of `window`, the lower one of two; `values` is scratch.
float validMedian(const cv::Mat& disparity, const cv::Rect& window, float invalid,
                  std::vector<float>& values) {
  auto end = values.begin();
  for (int y = window.y; y < window.y + window.height; ++y) {
    const auto* row = disparity.ptr<float>(y) + window.x;
    end = std::remove_copy(row, row + window.width, end, invalid);
  }
  const auto median = values.begin() + (end - values.begin() - 1) / 2;
  std::nth_element(values.begin(), median, end);
  return *median;
}

float medianOfThree(float a, float b, float c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

/// The 3 × 3 medians of a row, away from the image border. A median of nine is the median of three:
/// the largest minimum, the median of the medians and the smallest maximum of the columns.
class MedianOfNine {
 public:
  explicit MedianOfNine(int width) : low_(width), middle_(width), high_(width) {}

  /// Writes `out` from its second to its last but one pixel: `invalid` where the window holds a
  /// pixel that is. `invalid` is below every valid value.
  void filterRow(const float* above, const float* here, const float* below, float invalid,
                 float* __restrict out) {
    sortColumns(above, here, below);
    const auto last = static_cast<int>(low_.size()) - 1;
    for (int x = 1; x < last; ++x) {
      const float low = std::max(std::max(low_[x - 1], low_[x]), low_[x + 1]);
      const float middle = medianOfThree(middle_[x - 1], middle_[x], middle_[x + 1]);
      const float high = std::min(std::min(high_[x - 1], high_[x]), high_[x + 1]);
      const float lowest = std::min(std::min(low_[x - 1], low_[x]), low_[x + 1]);
      out[x] = lowest > invalid ? medianOfThree(low, middle, high) : invalid;
    }
  }

 private:
  void sortColumns(const float* above, const float* here, const float* below) {
    for (std::size_t x = 0; x < low_.size(); ++x) {
      low_[x] = std::min(std::min(above[x], here[x]), below[x]);
      middle_[x] = medianOfThree(above[x], here[x], below[x]);
      high_[x] = std::max(std::max(above[x], here[x]), below[x]);
    }
  }

  std::vector<float> low_;
  std::vector<float> middle_;
  std::vector<float> high_;
};

class MedianFilter {
 public:
  MedianFilter(const cv::Mat& disparity, float invalid, int size_px)
      : disparity_(disparity),
        invalid_(invalid),
        size_px_(size_px),
        image_(0, 0, disparity.cols, disparity.rows),
        values_(static_cast<std::size_t>(size_px) * size_px),
        median_of_nine_(disparity.cols) {}

  void filterRow(int y, float* out) {
    const auto* in = disparity_.ptr<float>(y);
    std::fill(out, out + disparity_.cols, invalid_);
    if (size_px_ == 3 && y > 0 && y < disparity_.rows - 1) {
      median_of_nine_.filterRow(disparity_.ptr<float>(y - 1), in, disparity_.ptr<float>(y + 1),
                                invalid_, out);
    }
    for (int x = 0; x < disparity_.cols; ++x) {
      if (in[x] != invalid_ && out[x] == invalid_) {
        const int radius = size_px_ / 2;
        const cv::Rect window(x - radius, y - radius, size_px_, size_px_);
        out[x] = validMedian(disparity_, window & image_, invalid_, values_);
      }
    }
  }

 private:
  const cv::Mat& disparity_;
  float invalid_;
  int size_px_;
  cv::Rect image_;
  std::vector<float> values_;
  MedianOfNine median_of_nine_;
};

}  // namespace

void medianFilter(const cv::Mat& disparity, const DisparityRange& range, int size_px,
                  cv::Mat& filtered) {
  CV_Assert(disparity.type() == CV_32FC1 && disparity.data != filtered.data);
  if (size_px < 1 || size_px % 2 == 0) {
    throw Error("The size of the median filter is " + std::to_string(size_px) +
                " px; it must be odd and at least 1.");
  }
  filtered.create(disparity.size(), CV_32FC1);
  tbb::parallel_for(tbb::blocked_range<int>(0, disparity.rows), [&](const auto& rows) {
    MedianFilter filter(disparity, range.invalid(), size_px);
    for (int y = rows.begin(); y != rows.end(); ++y) {
      filter.filterRow(y, filtered.ptr<float>(y));
    }
  });
}

}  // namespace cbmv
