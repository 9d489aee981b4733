#pragma once

#include <algorithm>
#include <array>
#include <optional>

namespace cbmv {

/// Rows above and below that are used at the left border.
constexpr int kBorderRows = 4;

/// The median of the values of the rows around `row` (the lower of two middle values).
/// `value_of(row)` returns an optional float. Empty if no row has a value.
template <typename ValueOf>
std::optional<float> medianOfRows(int row, int rows, const ValueOf& value_of) {
  std::array<float, 2 * kBorderRows + 1> values;
  auto end = values.begin();
  const int last = std::min(row + kBorderRows, rows - 1);
  for (int y = std::max(row - kBorderRows, 0); y <= last; ++y) {
    if (const std::optional<float> value = value_of(y)) {
      *end++ = *value;
    }
  }
  if (end == values.begin()) {
    return std::nullopt;
  }
  const auto middle = values.begin() + (end - values.begin() - 1) / 2;
  std::nth_element(values.begin(), middle, end);
  return *middle;
}

}  // namespace cbmv
