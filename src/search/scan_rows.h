#pragma once

#include <cstddef>
#include <cstdint>

#include "cbmv_stereo/disparity_range.h"

// Rows in the layout for the vector code of MutualMatcher.

namespace cbmv {

constexpr std::uint16_t kNoCost = 0xffff;

/// Two rows of census bits, and the distances of their hypotheses. Line i, for disparity range.min
/// + i, begins at `distances` + i · pitch.
struct CensusRows {
  static constexpr int kBytes = 8;  ///< per pixel

  const std::uint8_t* left;  ///< [byte][x]
  const std::uint8_t* right;
  int width;
  DisparityRange range;
  std::ptrdiff_t pitch;
  std::uint8_t* distances;
};

/// A key has a cost and the index of its disparity in one word. The lowest key has the lowest cost,
/// and the smallest index on ties. A block has as many disparities as kIndexBits can number.
constexpr int kIndexBits = 6;
constexpr int kBlock = 1 << kIndexBits;

/// Sums over three rows of distances.
struct SumRows {
  const std::uint8_t* sums;  ///< at column 0 and range.min
  std::ptrdiff_t pitch;      ///< distance between disparities
  int width;
  DisparityRange range;
};

/// Winners of the pixels of a row, from column 0 on.
struct RowWinners {
  std::uint16_t* cost;
  std::uint16_t* second_cost;  ///< among the disparities more than 1 away from the winner
  std::uint16_t* index;
  std::uint16_t* right_index;
};

}  // namespace cbmv
