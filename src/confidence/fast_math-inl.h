// Computes exp2 and log of vectors. Results are bit-identical on every machine: no fused
// multiply-add, no approximate reciprocal. The accuracy is sufficient for features, which become
// one of 256 codes: the relative error of exp2 is below 8e-5, the absolute error of log is
// below 1.1e-5 plus one ulp. Included once per instruction set.
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

/// Computes first + x · rest.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V plusTimes(D d, float first, V x, V rest) {
  namespace hn = hwy::HWY_NAMESPACE;
  return hn::Add(hn::Set(d, first), hn::Mul(x, rest));
}

/// Adding this constant to a number from −2²² to 2²² rounds it to an integer, which is then in the
/// low bits.
constexpr float kUnitIsLowestBit = 0x1.8p23F;

/// Computes 2^x for x ≤ 0. For x < −126, the result is 2^−126.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V exp2OfNegative(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::RebindToUnsigned<D> integer;
  const V magic = hn::Set(d, kUnitIsLowestBit);
  const V exponent = hn::Max(x, hn::Set(d, -126.0F));
  const V shifted = hn::Add(exponent, magic);
  const V t = hn::Sub(exponent, hn::Sub(shifted, magic));  // in [−1/2, 1/2]
  V power = hn::Set(d, 0.05517167F);                       // least relative error
  for (const float coefficient : {0.24261114F, 0.69326097F, 0.99992806F}) {
    power = plusTimes(d, coefficient, t, power);
  }
  const auto exponent_bits = hn::ShiftLeft<23>(hn::BitCast(integer, shifted));
  return hn::BitCast(d, hn::Add(hn::BitCast(integer, power), exponent_bits));
}

/// Computes log(x) for normal x > 0.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V logOfPositive(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr float kLn2 = 0.693147181F;
  constexpr std::int32_t kBitsOfOne = 0x3f800000;
  constexpr std::int32_t kTwoThirdsOfMantissa = 0x555555;
  const hn::RebindToSigned<D> integer;
  const auto bits = hn::BitCast(integer, x);
  const auto exponent =
      hn::ShiftRight<23>(hn::Sub(bits, hn::Set(integer, kBitsOfOne - kTwoThirdsOfMantissa)));
  const V mantissa = hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(exponent)));
  const V t = hn::Sub(mantissa, hn::Set(d, 1.0F));  // in [−1/3, 1/3]
  V series = hn::Set(d, 0.23482452F);               // log(1 + t) / t, least absolute error
  for (const float coefficient : {-0.27846855F, 0.3310864F, -0.49898756F, 1.0000343F}) {
    series = plusTimes(d, coefficient, t, series);
  }
  return hn::Add(hn::Mul(hn::ConvertTo(d, exponent), hn::Set(d, kLn2)), hn::Mul(t, series));
}

}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#endif
