#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cbmv {

/// Arms of a row of a tile in two opposite directions. The combined arm of hypothesis h in column i
/// is the shorter of reference[·][4 * i] and other[·][i * other_step + h].
struct ArmRows {
  std::array<const std::uint8_t*, 2> reference;
  std::array<const std::uint8_t*, 2> other;
  std::ptrdiff_t other_step;
};

/// Input and output of one summation: sums of the costs on the horizontal arms of a row of a tile.
/// `sums` has two lines of `pitch` elements per column: the sums and the numbers of pixels.
template <typename Cost, typename Sum>
struct RowToSum {
  const Cost* costs;          // at the first column
  std::ptrdiff_t pixel_step;  // distance between columns in `costs`
  int columns;
  int hypotheses;
  ArmRows arms;  // left, right
  Sum* sums;
  std::ptrdiff_t pitch;
};

/// Input and output of one averaging: means over the regions of a row of a tile. rows[k] are the
/// sums, as in RowToSum, k rows below.
template <typename Sum>
struct RowToAverage {
  const Sum* const* rows;
  std::ptrdiff_t pitch;
  int columns;
  int hypotheses;
  ArmRows arms;               // up, down
  std::uint16_t* means;       // at the first column
  std::ptrdiff_t pixel_step;  // distance between columns in `means`
};

}  // namespace cbmv
