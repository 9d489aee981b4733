#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <hwy/targets.h>
#include <opencv2/core.hpp>

namespace cbmv::benchmarks {

/// FNV-1a checksum of results. It allows comparing a timed result with the correct one without
/// storing it.
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

/// Instruction sets that are compiled in and supported by the machine, best first, without emulated
/// vectors.
inline std::vector<std::int64_t> realSimdTargets() {
  std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  if (targets.size() > 1 && targets.back() == HWY_EMU128) {
    targets.pop_back();
  }
  return targets;
}

}  // namespace cbmv::benchmarks
