#pragma once

namespace cbmv {

/// The lowest multiple that is not below `value` ≥ 0.
constexpr int roundUp(int value, int multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace cbmv
