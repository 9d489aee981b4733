#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/search_space.h"

namespace cbmv {

/// Part of a search space that is processed at once: some adjacent tiles and some of the
/// disparities, in all rows. Indices of disparities are relative to the first disparity of the
/// block.
///
/// Horizontal arms reach into `margin` tiles beyond either end. The lists of a row are the parts of
/// the tiles' lists that are in the block, from the first tile of the left margin on.
struct BlockShape {
  int tiles;
  int margin;
  int first_index;  ///< index in the search space
  int disparities;

  int tilesWithMargins() const { return tiles + 2 * margin; }
  /// Pairs of an even and the next odd index.
  int pairs() const { return (disparities + 1) / 2; }
};

/// Left and right arms of a row of a block. The combined arm of column x of the block at index i is
/// the shorter of reference[·][x] and other[·][x + i * other_step]. Each element is a pair: the
/// lower byte is for the index, the upper byte is for the next index.
struct HorizontalArms {
  std::array<const std::uint16_t*, 2> reference;
  std::array<const std::uint16_t*, 2> other;
  int other_step;
};

/// The same for up and down arms, which are the two upper bytes of an element.
struct VerticalArms {
  const std::uint32_t* reference;
  const std::uint32_t* other;
  int other_step;
};

/// Input and output of one summation: sums of the costs on the horizontal arms of a row of a block.
/// `Lane` has room for the sum of an arm with its center. `Sum` is twice as wide and has room for
/// the sum of a region and its number of pixels.
template <typename Cost, typename Lane, typename Sum>
struct BlockRowToSum {
  const BlockShape& shape;
  const SearchSpace::Tile* lists;
  const SearchSpace::Tile* next_lists;  ///< lists of the next row
  const Cost* costs;                    ///< at entry 0
  HorizontalArms arms;
  int longest_arm_px;
  Sum* sums;  ///< [tile][index][column of the tile]

  // Scratch memory, including the margins.
  Sum* line;  ///< [pair][column]: pairs of costs
  /// [tile][pair]: one byte per index, 255 if it is in the list, otherwise 0
  std::uint16_t* present;
  std::uint16_t* left_reach;   ///< [tile][pair]
  std::uint16_t* right_reach;  ///< [tile][pair]
  Sum* unused;                 ///< scratch memory for one tile
};

/// Input and output of one averaging: means over the regions of a row of a block. rows[k] are the
/// sums k rows below.
template <typename Sum>
struct BlockRowToAverage {
  const BlockShape& shape;
  const SearchSpace::Tile* lists;
  const Sum* const* rows;
  VerticalArms arms;
  int longest_arm_px;
  std::uint16_t* means;  ///< at entry 0
};

/// Sums of a row that are no longer needed and are set to 0.
template <typename Sum>
struct BlockRowToClear {
  const BlockShape& shape;
  const SearchSpace::Tile* lists;
  const SearchSpace::Tile* replacing;  ///< lists of the row that reuses the memory, or null
  Sum* sums;
};

}  // namespace cbmv
