#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cbmv::benchmarks {

/// Copies memory that no cache holds, by as many threads as the calling arena has. Returns the
/// bytes read and written.
double streamCopy(const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to);

/// Computes on vectors in registers by one core: independent chains of byte minima and additions,
/// so that every vector unit has work. Returns the bytes computed: one for each instruction and
/// byte of its lanes. `result` takes what has been computed.
double computeBytes(int rounds, std::uint8_t& result);

}  // namespace cbmv::benchmarks
