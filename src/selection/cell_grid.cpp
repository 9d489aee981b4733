#include "selection/cell_grid.h"

#include <algorithm>
#include <cstddef>
#include <functional>

#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

int cellsOf(int pixels) { return (pixels + CellGrid::kCellPx - 1) / CellGrid::kCellPx; }

/// Adds a row of pixels to the sums of its cells.
template <typename Value>
void addRow(const Value* row, int width, std::int32_t* sums) {
  const int whole = width / CellGrid::kCellPx;
  for (int cell = 0; cell < whole; ++cell) {
    const Value* pixel = row + static_cast<std::ptrdiff_t>(cell) * CellGrid::kCellPx;
    sums[cell] += pixel[0] + pixel[1] + pixel[2] + pixel[3];
  }
  for (int x = whole * CellGrid::kCellPx; x < cellsOf(width) * CellGrid::kCellPx; ++x) {
    sums[whole] += row[std::min(x, width - 1)];
  }
}

template <typename Value>
void sumCells(const cv::Mat& map, cv::Mat& sums) {
  tbb::parallel_for(0, sums.rows, [&](int cell) {
    auto* row = sums.ptr<std::int32_t>(cell);
    std::fill_n(row, sums.cols, 0);
    for (int y = cell * CellGrid::kCellPx; y < (cell + 1) * CellGrid::kCellPx; ++y) {
      addRow(map.ptr<Value>(std::min(y, map.rows - 1)), map.cols, row);
    }
  });
}

}  // namespace

void CellGrid::sum(const cv::Mat& map) {
  CV_Assert(map.type() == CV_8UC1 || map.type() == CV_16UC1 || map.type() == CV_16SC1);
  CV_Assert(!map.empty());
  sums_.create(cellsOf(map.rows), cellsOf(map.cols), CV_32SC1);
  if (map.type() == CV_8UC1) {
    sumCells<std::uint8_t>(map, sums_);
  } else if (map.type() == CV_16UC1) {
    sumCells<std::uint16_t>(map, sums_);
  } else {
    sumCells<std::int16_t>(map, sums_);
  }
}

void CellGrid::windowMeans(int cells, cv::Mat& means) {
  CV_Assert(cells % 2 == 1 && cells >= 1 && cells <= kMostCells);
  const int radius = cells / 2;
  // Large enough for all windows.
  vertical_sums_.create(sums_.rows, sums_.cols + kMostCells - 1, CV_32SC1);
  means.create(sums_.size(), CV_32SC1);
  const int pixels = cells * cells * kCellPx * kCellPx;
  tbb::parallel_for(0, sums_.rows, [&](int y) {
    auto* vertical = vertical_sums_.ptr<std::int32_t>(y);
    auto* inner = vertical + radius;
    std::fill_n(inner, sums_.cols, 0);
    for (int offset = -radius; offset <= radius; ++offset) {
      const auto* row = sums_.ptr<std::int32_t>(std::clamp(y + offset, 0, sums_.rows - 1));
      std::transform(row, row + sums_.cols, inner, inner, std::plus<>());
    }
    std::fill_n(vertical, radius, inner[0]);
    std::fill_n(inner + sums_.cols, radius, inner[sums_.cols - 1]);
    auto* out = means.ptr<std::int32_t>(y);
    std::int32_t sum = 0;
    for (int x = 0; x < 2 * radius; ++x) {
      sum += vertical[x];
    }
    for (int x = 0; x < sums_.cols; ++x) {
      sum += vertical[x + 2 * radius];
      out[x] = sum >= 0 ? sum / pixels : -((pixels - 1 - sum) / pixels);
      sum -= vertical[x];
    }
  });
}

}  // namespace cbmv
