#pragma once

#include <cstdint>
#include <cstring>

namespace cbmv {

// exp and log without branches, tables or calls, so that loops over them vectorise, and the same to
// the last bit on every machine. Relative error of exp and absolute error of log below 1e-6.

inline float bitsToFloat(std::int32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

inline std::int32_t floatToBits(float value) {
  std::int32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// exp(x) for x ≤ 0; below −80 the result is exp(−80).
inline float expOfNegative(float x) {
  constexpr float kLog2E = 1.44269504F;
  constexpr float kLn2 = 0.693147181F;
  const float exponent = (x > -80.0F ? x : -80.0F) * kLog2E;
  // Nearest whole number: the argument is never positive, so adding before the cut is enough.
  const auto whole = static_cast<std::int32_t>(exponent - 0.5F);
  const float t = (exponent - static_cast<float>(whole)) * kLn2;  // in [−0.35, 0.35]: Taylor series
  const float series =
      1.0F +
      t * (1.0F +
           t * (1.0F / 2 + t * (1.0F / 6 + t * (1.0F / 24 + t * (1.0F / 120 + t * (1.0F / 720))))));
  return series * bitsToFloat((whole + 127) << 23);
}

/// log(x) for normal x > 0.
inline float logOfPositive(float x) {
  constexpr float kLn2 = 0.693147181F;
  constexpr std::int32_t kMantissa = 0x007fffff;
  const std::int32_t bits = floatToBits(x);
  // Halving mantissas above 4/3 keeps |s| ≤ 1/7 … 1/5, where five terms are enough.
  const std::int32_t upper = (bits & kMantissa) > 0x2aaaaa ? 1 : 0;
  const float mantissa = bitsToFloat((bits & kMantissa) | ((127 - upper) << 23));
  const auto exponent = static_cast<float>((bits >> 23) - 127 + upper);
  const float s = (mantissa - 1.0F) / (mantissa + 1.0F);
  const float s2 = s * s;
  const float series = 1.0F + s2 * (1.0F / 3 + s2 * (1.0F / 5 + s2 * (1.0F / 7 + s2 * (1.0F / 9))));
  return exponent * kLn2 + 2.0F * s * series;
}

}  // namespace cbmv
