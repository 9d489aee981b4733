#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/search_space.h"

namespace cbmv {

/// Part of a search space that is worked on at once: in all rows, some tiles beside each other and
/// some of the disparities. Indices of disparities count from the first one of the block.
///
/// Horizontal arms reach into `margin` tiles beyond either end. Lists of a row are the parts of the
/// tiles' lists that lie in the block, from the first tile of the left margin on.
struct BlockShape {
  int tiles;
  int margin;
  int first_index;  ///< of the disparities of the search space
  int disparities;

  int tilesWithMargins() const { return tiles + 2 * margin; }
  /// Even and odd index beside each other.
  int pairs() const { return (disparities + 1) / 2; }
};

/// Left and right arms of a row of a block. The combined arm of column x of the block at index i is
/// the shorter of reference[·][x] and other[·][x + i * other_step]. Each element is a pair: the
/// lower byte belongs to the index, the upper one to the next index.
struct HorizontalArms {
  std::array<const std::uint16_t*, 2> reference;
  std::array<const std::uint16_t*, 2> other;
  int other_step;
};

/// The same of up and down arms, which are the two upper bytes of an element.
struct VerticalArms {
  const std::uint32_t* reference;
  const std::uint32_t* other;
  int other_step;
};

/// Sums of the costs on the horizontal arms of a row of a block, to be computed. `Lane` holds the
/// sum of an arm with its centre, `Sum`, which is twice as wide, that of a region and the number
/// of its pixels.
template <typename Cost, typename Lane, typename Sum>
struct BlockRowToSum {
  const BlockShape& shape;
  const SearchSpace::Tile* lists;
  const SearchSpace::Tile* next_lists;  ///< of the row that will come next
  const Cost* costs;                    ///< of entry 0
  HorizontalArms arms;
  int longest_arm_px;
  Sum* sums;  ///< [tile][index][column of the tile]

  // Scratch, with the margins.
  Sum* line;                   ///< [pair][column]: pairs of costs
  std::uint16_t* present;      ///< [tile][pair]: a byte for each, 255 if it is in the list, or 0
  std::uint16_t* left_reach;   ///< [tile][pair]
  std::uint16_t* right_reach;  ///< the same
  Sum* unused;                 ///< a tile
};

/// Means over the regions of a row of a block, to be computed. rows[k] are the sums of the row k
/// rows below.
template <typename Sum>
struct BlockRowToAverage {
  const BlockShape& shape;
  const SearchSpace::Tile* lists;
  const Sum* const* rows;
  VerticalArms arms;
  int longest_arm_px;
  std::uint16_t* means;  ///< of entry 0
};

/// Sums of a row that are no longer needed, to become 0.
template <typename Sum>
struct BlockRowToClear {
  const BlockShape& shape;
  const SearchSpace::Tile* lists;
  const SearchSpace::Tile* replacing;  ///< of the row that will have its place, or none
  Sum* sums;
};

}  // namespace cbmv
