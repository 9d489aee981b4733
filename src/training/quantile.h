#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cbmv {

/// The value that a part `share` of the values lie below, rounded down to one of them. Reorders the
/// values, of which there must be one.
template <typename Value>
Value quantile(std::vector<Value>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace cbmv
