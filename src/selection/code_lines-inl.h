// Loops that convert the values of a row to codes: bytes minus 128. These are plain loops, which
// the compiler vectorizes for each instruction set. Included once per instruction set.
#if defined(CBMV_SELECTION_CODE_LINES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_SELECTION_CODE_LINES_INL_H
#undef CBMV_SELECTION_CODE_LINES_INL_H
#else
#define CBMV_SELECTION_CODE_LINES_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <hwy/highway.h>

#include "selection/cell_grid.h"
#include "selection/map_planes.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

/// Left-right difference in units of the disparity plane, up to 254. 255: unknown. `units` is the
/// disparity in these units. `match` is the matching column in the row `right`.
HWY_INLINE std::int32_t leftRightUnits(float units, std::int32_t match,
                                       const float* HWY_RESTRICT right, float right_invalid,
                                       std::int32_t last_column) {
  const std::int32_t column = std::min(std::max(match, 0), last_column);
  const float other = right[column];
  const float difference = std::min(std::abs(units - other * kPlaneUnitsPerPx), 254.0F);
  const bool is_known = (match == column) & (other != right_invalid);  // `&` avoids a branch
  return is_known ? static_cast<std::int32_t>(difference) : kUnknownDifference;
}

/// Matching column in the right image for a disparity of the plane.
HWY_INLINE std::int32_t matchOf(std::int32_t x, std::int32_t units) {
  return x - ((units + kPlaneUnitsPerPx / 2) >> 3);
}

HWY_INLINE std::int8_t asCode(std::int32_t value) { return static_cast<std::int8_t>(value - 128); }

/// A sum over 5 × 5 pixels, which is up to 2^16, divided by 25. Rounded down, with one exception:
/// sums from 43690 on that are 1 below a multiple of 25 are rounded up.
HWY_INLINE std::int32_t meanOf25(std::int32_t sum) { return (sum * 10486) >> 18; }

HWY_INLINE void codeBytes(const std::uint8_t* HWY_RESTRICT values, int count,
                          std::int8_t* HWY_RESTRICT codes) {
  for (int x = 0; x < count; ++x) {
    codes[x] = asCode(values[x]);
  }
}

HWY_INLINE void codeMeans(const std::int32_t* HWY_RESTRICT sums, int count,
                          std::int8_t* HWY_RESTRICT codes) {
  for (int x = 0; x < count; ++x) {
    codes[x] = asCode(meanOf25(sums[x]));
  }
}

/// Codes `value_of` the mean of each pixel's cell. `cells` begins at the cell of the first pixel.
template <typename ValueOf>
HWY_INLINE void codeCellValues(const std::int32_t* HWY_RESTRICT cells, int count,
                               std::int8_t* HWY_RESTRICT codes, const ValueOf& value_of) {
  const int whole = count / CellGrid::kCellPx;
  for (int cell = 0; cell < whole; ++cell) {
    const std::uint32_t four =
        static_cast<std::uint8_t>(asCode(value_of(cells[cell]))) * 0x01010101U;
    std::memcpy(codes + cell * CellGrid::kCellPx, &four, sizeof(four));
  }
  for (int x = whole * CellGrid::kCellPx; x < count; ++x) {
    codes[x] = asCode(value_of(cells[whole]));
  }
}

/// For values up to 255.
HWY_INLINE void codeCells(const std::int32_t* HWY_RESTRICT cells, int count,
                          std::int8_t* HWY_RESTRICT codes) {
  codeCellValues(cells, count, codes, [](std::int32_t mean) HWY_ATTR { return mean; });
}

/// For margins.
HWY_INLINE void codeCompressedCells(const std::int32_t* HWY_RESTRICT cells, int count,
                                    std::int8_t* HWY_RESTRICT codes) {
  codeCellValues(cells, count, codes, [](std::int32_t mean) HWY_ATTR { return compressed(mean); });
}

/// Difference between disparities and the means of their cells.
HWY_INLINE void codeCellDeviations(const std::int16_t* HWY_RESTRICT disparity,
                                   const std::int32_t* HWY_RESTRICT cells, int count,
                                   std::int8_t* HWY_RESTRICT codes) {
  constexpr int kCell = CellGrid::kCellPx;
  const int whole = count / kCell;
  for (int cell = 0; cell < whole; ++cell) {
    for (int i = 0; i < kCell; ++i) {
      const int x = cell * kCell + i;
      codes[x] = asCode(compressed(std::abs(disparity[x] - cells[cell])));
    }
  }
  for (int x = whole * kCell; x < count; ++x) {
    codes[x] = asCode(compressed(std::abs(disparity[x] - cells[whole])));
  }
}

/// Column of the match relative to the left border of the right image. `x` is the column of the
/// first pixel.
HWY_INLINE void codeBorder(const std::int16_t* HWY_RESTRICT disparity, int x, int count,
                           std::int8_t* HWY_RESTRICT codes) {
  for (int i = 0; i < count; ++i) {
    const std::int32_t inside = x + i - (disparity[i] >> 3) + 5;
    codes[i] = asCode(3 * std::min(std::max(inside, 0), 84));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif
