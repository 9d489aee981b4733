#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cbmv {

/// Arms of a row of a tile in two opposite directions. The combined arm of hypothesis h of column i
/// is the shorter of reference[·][4 * i] and other[·][i * other_step + h].
struct ArmRows {
  std::array<const std::uint8_t*, 2> reference;
  std::array<const std::uint8_t*, 2> other;
  std::ptrdiff_t other_step;
};

/// Sums of the costs on the horizontal arms of a row of a tile, to be computed. `sums` holds for
/// each column two lines of `pitch` elements: sums and numbers of pixels.
template <typename Cost, typename Sum>
struct RowToSum {
  const Cost* costs;          // of the first column
  std::ptrdiff_t pixel_step;  // from one column to the next, in costs
  int columns;
  int hypotheses;
  ArmRows arms;  // left, right
  Sum* sums;
  std::ptrdiff_t pitch;
};

/// Means over the regions of a row of a tile, to be computed. rows[k] are the sums of the row k
/// rows below, as in RowToSum.
template <typename Sum>
struct RowToAverage {
  const Sum* const* rows;
  std::ptrdiff_t pitch;
  int columns;
  int hypotheses;
  ArmRows arms;               // up, down
  std::uint16_t* means;       // of the first column
  std::ptrdiff_t pixel_step;  // from one column to the next, in means
};

}  // namespace cbmv
