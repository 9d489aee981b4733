#include "machine.h"

#include <algorithm>
#include <cstring>

#include <tbb/parallel_for.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "machine.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv::benchmarks {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Twelve chains, because instructions take a few cycles and there are up to four units.
double compute(int rounds, std::uint8_t* result) {
  const hn::ScalableTag<std::uint8_t> tag;
  const auto step = hn::Set(tag, 3);
  const auto bound = hn::Set(tag, *result);
  auto a = hn::Iota(tag, 0), b = hn::Iota(tag, 1), c = hn::Iota(tag, 2), d = hn::Iota(tag, 3);
  auto e = hn::Iota(tag, 4), f = hn::Iota(tag, 5), g = hn::Iota(tag, 6), h = hn::Iota(tag, 7);
  auto i = hn::Iota(tag, 8), j = hn::Iota(tag, 9), k = hn::Iota(tag, 10), l = hn::Iota(tag, 11);
  const auto next = [&](auto& value) HWY_ATTR { value = hn::Min(hn::Add(value, step), bound); };
  for (int round = 0; round < rounds; ++round) {
    next(a), next(b), next(c), next(d), next(e), next(f);
    next(g), next(h), next(i), next(j), next(k), next(l);
  }
  for (const auto& other : {b, c, d, e, f, g, h, i, j, k, l}) {
    a = hn::Xor(a, other);
  }
  *result = hn::GetLane(a);
  return 2.0 * 12 * rounds * static_cast<double>(hn::Lanes(tag));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv::benchmarks
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv::benchmarks {
namespace {

HWY_EXPORT(compute);

}  // namespace

double streamCopy(const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to) {
  constexpr std::size_t kBlock = 1 << 20;
  tbb::parallel_for(std::size_t{0}, from.size() / kBlock, [&](std::size_t block) {
    std::memcpy(to.data() + block * kBlock, from.data() + block * kBlock, kBlock);
  });
  return 2.0 * static_cast<double>(from.size() / kBlock * kBlock);
}

double computeBytes(int rounds, std::uint8_t& result) {
  return HWY_DYNAMIC_DISPATCH(compute)(rounds, &result);
}

}  // namespace cbmv::benchmarks
#endif  // HWY_ONCE
