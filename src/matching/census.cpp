#include "cbmv_stereo/matching/census.h"

#include <tbb/parallel_for.h>

#include "cbmv_stereo/matching/padded_image.h"

namespace cbmv {
namespace {

constexpr int kRadius = CensusMatcher::kWindowPx / 2;

/// Bits of the neighbours in window rows [first_row, last_row], in raster order, without the
/// centre.
std::uint64_t compareNeighbours(const cv::Mat& padded, int y, int x, int first_row, int last_row) {
  const std::uint8_t centre = paddedRow<std::uint8_t>(padded, y)[x];
  std::uint64_t bits = 0;
  for (int dy = first_row; dy <= last_row; ++dy) {
    const std::uint8_t* row = paddedRow<std::uint8_t>(padded, y + dy) + x;
    // The centre's row is split between the two words: left half above, right half below.
    const int first_column = dy == 0 && first_row == 0 ? 1 : -kRadius;
    const int last_column = dy == 0 && last_row == 0 ? -1 : kRadius;
    for (int dx = first_column; dx <= last_column; ++dx) {
      bits = (bits << 1U) | static_cast<std::uint64_t>(row[dx] < centre);
    }
  }
  return bits;
}

/// Number of set bits; written out so that it vectorises on machines without such an instruction.
inline std::uint64_t countBits(std::uint64_t bits) {
  bits -= (bits >> 1U) & 0x5555555555555555ULL;
  bits = (bits & 0x3333333333333333ULL) + ((bits >> 2U) & 0x3333333333333333ULL);
  bits = (bits + (bits >> 4U)) & 0x0f0f0f0f0f0f0f0fULL;
  bits += bits >> 8U;
  bits += bits >> 16U;
  bits += bits >> 32U;
  return bits & 0x7fU;
}

}  // namespace

void CensusMatcher::transform(const cv::Mat& padded, BitStrings& bits) {
  const int height = padded.rows - 2 * kMatchingBorderPx;
  const int width = padded.cols - 2 * kMatchingBorderPx;
  bits.upper.resize(static_cast<std::size_t>(height) * width);
  bits.lower.resize(static_cast<std::size_t>(height) * width);
  tbb::parallel_for(0, height, [&](int y) {
    const std::size_t row = static_cast<std::size_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      bits.upper[row + x] = compareNeighbours(padded, y, x, -kRadius, 0);
      bits.lower[row + x] = compareNeighbours(padded, y, x, 0, kRadius);
    }
  });
}

void CensusMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  width_ = padded_left.cols - 2 * kMatchingBorderPx;
  transform(padded_left, left_);
  transform(padded_right, right_);
}

void CensusMatcher::computeRow(int y, const DisparityRange& range, CostRow& costs) const {
  costs.resize(width_, range.count);
  const std::size_t row = static_cast<std::size_t>(y) * width_;
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const ColumnSpan span = matchedColumns(width_, d);
    float* line = costs.line(i);
    for (int x = span.begin; x < span.end; ++x) {
      const std::uint64_t distance = countBits(left_.upper[row + x] ^ right_.upper[row + x - d]) +
                                     countBits(left_.lower[row + x] ^ right_.lower[row + x - d]);
      line[x] = static_cast<float>(static_cast<std::int32_t>(distance));
    }
  }
}

}  // namespace cbmv
