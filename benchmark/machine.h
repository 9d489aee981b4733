#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cbmv::benchmarks {

/// Copies memory that does not fit into any cache, on all threads of the calling arena. Returns the
/// bytes read and written.
double streamCopy(const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to);

/// Computes on vectors in registers on one core: independent chains of byte minima and additions
/// keep every vector unit busy. Returns the bytes computed: one per instruction and byte of its
/// lanes. `result` receives the computed value.
double computeBytes(int rounds, std::uint8_t& result);

}  // namespace cbmv::benchmarks
