#pragma once

#include <cstddef>
#include <cstdint>

#include "cbmv_stereo/disparity_range.h"

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

/// Costs and the indices of their disparities in one word, so that the least key is that of the
/// least cost, the smallest index on ties: as many disparities as kIndexBits number are a block.
constexpr int kIndexBits = 6;
constexpr int kBlock = 1 << kIndexBits;

/// Sums of three rows of distances.
struct SumRows {
  const std::uint8_t* sums;  ///< of column 0 at range.min
  std::ptrdiff_t pitch;      ///< from disparity to disparity
  int width;
  DisparityRange range;
};

/// What the pixels of a row have found, from column 0 on.
struct RowWinners {
  std::uint16_t* cost;
  std::uint16_t* second_cost;  ///< of disparities more than 1 away from the winner
  std::uint16_t* index;
  std::uint16_t* right_index;
};

}  // namespace cbmv
