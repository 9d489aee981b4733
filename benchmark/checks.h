#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <hwy/targets.h>
#include <opencv2/core.hpp>

namespace cbmv::benchmarks {

/// FNV-1a of results, to compare what was timed with what is right without keeping it.
class Checksum {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* byte = static_cast<const std::uint8_t*>(data);
    for (std::size_t i = 0; i < bytes; ++i) {
      value_ = (value_ ^ byte[i]) * 1099511628211ULL;
    }
  }
  void add(const cv::Mat& map) {
    for (int y = 0; y < map.rows; ++y) {
      add(map.ptr(y), map.cols * map.elemSize());
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 1469598103934665603ULL;
};

/// The instruction sets that the kernels are compiled for and that the machine has, best first,
/// without emulated vectors.
inline std::vector<std::int64_t> realSimdTargets() {
  std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  if (targets.size() > 1 && targets.back() == HWY_EMU128) {
    targets.pop_back();
  }
  return targets;
}

}  // namespace cbmv::benchmarks
