#pragma once

#include <cstddef>
#include <cstdint>

#include "cbmv_stereo/volume/disparity_range.h"

// Rows as the vector code of the scan for mutual matches takes them.

namespace cbmv {

constexpr std::uint16_t kNoCost = 0xffff;

/// Two rows of census bits, and where the distances of their hypotheses go: line i, of disparity
/// range.min + i, begins i · pitch behind `distances`.
struct CensusRows {
  static constexpr int kBytes = 8;  ///< of a pixel

  const std::uint8_t* left;  ///< [byte][x]
  const std::uint8_t* right;
  int width;
  DisparityRange range;
  std::ptrdiff_t pitch;
  std::uint8_t* distances;
};

/// What a row of left pixels and the right pixels that match them have found; indices of
/// disparities. Pointers to column 0; right ones are readable and writable so far as x − d reaches.
struct RowWinners {
  std::uint16_t* cost;
  std::uint16_t* second_cost;  ///< of disparities more than 1 away from the winner
  std::uint16_t* index;
  std::uint16_t* right_cost;
  std::uint16_t* right_index;
};

}  // namespace cbmv
