// exp and log of vectors, the same to the last bit on every machine: no fused multiply-add, no
// approximate reciprocal. Relative error of exp and absolute error of log below 1e-6. Included once
// per instruction set.
#if defined(CBMV_FAST_MATH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CBMV_FAST_MATH_INL_H
#undef CBMV_FAST_MATH_INL_H
#else
#define CBMV_FAST_MATH_INL_H
#endif

#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {

/// first + x · rest
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V plusTimes(D d, float first, V x, V rest) {
  namespace hn = hwy::HWY_NAMESPACE;
  return hn::Add(hn::Set(d, first), hn::Mul(x, rest));
}

/// Whole numbers from −2²² to 2²² as the low bits of integers.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::RebindToUnsigned<D>> lowBitsOfWhole(
    D d, V whole) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr float kUnitIsLowestBit = 0x1.8p23F;
  return hn::BitCast(hn::RebindToUnsigned<D>(), hn::Add(whole, hn::Set(d, kUnitIsLowestBit)));
}

/// exp(x) for x ≤ 0; below −80 the result is exp(−80).
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V expOfNegative(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr float kLog2E = 1.44269504F;
  constexpr float kLn2 = 0.693147181F;
  const V exponent = hn::Mul(hn::Max(x, hn::Set(d, -80.0F)), hn::Set(d, kLog2E));
  // Nearest whole number: the argument is never positive, so subtracting before the cut is enough.
  const V whole = hn::Trunc(hn::Sub(exponent, hn::Set(d, 0.5F)));
  const V t = hn::Mul(hn::Sub(exponent, whole), hn::Set(d, kLn2));
  V series = hn::Set(d, 1.0F / 720);  // Taylor's; t is in [−0.35, 0.35]
  for (const float coefficient : {1.0F / 120, 1.0F / 24, 1.0F / 6, 1.0F / 2, 1.0F, 1.0F}) {
    series = plusTimes(d, coefficient, t, series);
  }
  const auto exponent_bits =
      hn::ShiftLeft<23>(lowBitsOfWhole(d, hn::Add(whole, hn::Set(d, 127.0F))));
  return hn::Mul(series, hn::BitCast(d, exponent_bits));
}

/// log(x) for normal x > 0.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V logOfPositive(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr float kLn2 = 0.693147181F;
  // The exponent for a mantissa between 2/3 and 4/3, which keeps |s| ≤ 1/5: five terms are enough.
  constexpr std::int32_t kBitsOfOne = 0x3f800000;
  constexpr std::int32_t kTwoThirdsOfMantissa = 0x555555;
  const hn::RebindToSigned<D> integer;
  const auto bits = hn::BitCast(integer, x);
  const auto exponent =
      hn::ShiftRight<23>(hn::Sub(bits, hn::Set(integer, kBitsOfOne - kTwoThirdsOfMantissa)));
  const V mantissa = hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(exponent)));
  const V one = hn::Set(d, 1.0F);
  const V s = hn::Div(hn::Sub(mantissa, one), hn::Add(mantissa, one));
  const V s2 = hn::Mul(s, s);
  V series = hn::Set(d, 1.0F / 9);
  for (const float coefficient : {1.0F / 7, 1.0F / 5, 1.0F / 3, 1.0F}) {
    series = plusTimes(d, coefficient, s2, series);
  }
  return hn::Add(hn::Mul(hn::ConvertTo(d, exponent), hn::Set(d, kLn2)),
                 hn::Mul(hn::Add(s, s), series));
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif
