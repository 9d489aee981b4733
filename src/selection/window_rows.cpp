#include "selection/window_rows.h"

#include <algorithm>
#include <array>

#ifndef CBMV_WINDOW_ROWS_ONCE
#define CBMV_WINDOW_ROWS_ONCE
namespace cbmv {
namespace {

constexpr int kWindowRows = 2 * WindowRow::kRadius + 1;

template <typename Value>
using WindowLines = std::array<const Value*, kWindowRows>;

}  // namespace
}  // namespace cbmv
#endif

// Plain loops, which the compiler vectorizes for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "selection/window_rows.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

template <typename Value>
HWY_INLINE void addRows(const WindowLines<Value>& lines, int width, std::int32_t* sums) {
  for (int x = 0; x < width; ++x) {
    sums[x] = lines[0][x] + lines[1][x] + lines[2][x] + lines[3][x] + lines[4][x];
  }
}

void addRowsU8(const WindowLines<std::uint8_t>& lines, int width, std::int32_t* sums) {
  addRows(lines, width, sums);
}
void addRowsU16(const WindowLines<std::uint16_t>& lines, int width, std::int32_t* sums) {
  addRows(lines, width, sums);
}
void addRowsS16(const WindowLines<std::int16_t>& lines, int width, std::int32_t* sums) {
  addRows(lines, width, sums);
}

void addColumns(const std::int32_t* vertical, int width, std::int32_t* sums) {
  for (int x = 0; x < width; ++x) {
    sums[x] = vertical[x] + vertical[x + 1] + vertical[x + 2] + vertical[x + 3] + vertical[x + 4];
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(addRowsU8);
HWY_EXPORT(addRowsU16);
HWY_EXPORT(addRowsS16);
HWY_EXPORT(addColumns);

template <typename Value>
WindowLines<Value> linesAround(const cv::Mat& plane, int y) {
  WindowLines<Value> lines{};
  for (int i = 0; i < kWindowRows; ++i) {
    lines[i] = plane.ptr<Value>(std::clamp(y + i - WindowRow::kRadius, 0, plane.rows - 1));
  }
  return lines;
}

}  // namespace

void WindowRow::resize(int width) {
  vertical_.resize(static_cast<std::size_t>(width) + 2 * kRadius);
  sums_.resize(width);
}

const std::int32_t* WindowRow::sums(const cv::Mat& plane, int y) {
  const int width = plane.cols;
  std::int32_t* inner = vertical_.data() + kRadius;
  if (plane.type() == CV_8UC1) {
    HWY_DYNAMIC_DISPATCH(addRowsU8)(linesAround<std::uint8_t>(plane, y), width, inner);
  } else if (plane.type() == CV_16UC1) {
    HWY_DYNAMIC_DISPATCH(addRowsU16)(linesAround<std::uint16_t>(plane, y), width, inner);
  } else {
    CV_Assert(plane.type() == CV_16SC1);
    HWY_DYNAMIC_DISPATCH(addRowsS16)(linesAround<std::int16_t>(plane, y), width, inner);
  }
  std::fill_n(vertical_.data(), kRadius, inner[0]);
  std::fill_n(inner + width, kRadius, inner[width - 1]);
  HWY_DYNAMIC_DISPATCH(addColumns)(vertical_.data(), width, sums_.data());
  return sums_.data();
}

}  // namespace cbmv
#endif  // HWY_ONCE
