#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/search_space.h"
#include "matching/cost_row.h"

namespace cbmv {

/// Half-open interval of places (see RowEntries).
struct PlaceSpan {
  int begin = 0;
  int end = 0;
  int count() const { return end - begin; }
  bool empty() const { return begin >= end; }
};

/// The entries of one image row of a search space in matching order: by disparity, then by column.
/// A place is an index in this order. So neighboring tiles are adjacent, and sums over the
/// hypotheses of a pixel, in either view, run through the disparities in ascending order. Entries
/// without a match inside of the right image have no place.
class RowEntries {
 public:
  struct Entry {
    std::int32_t column;        ///< first column of the tile, left image
    std::int32_t right_column;  ///< column − d; may be outside of the right image
    std::int32_t number;        ///< index among all entries of the row (SearchSpace)
    std::int16_t begin;  ///< [begin, end): columns of the tile that are inside of both images
    std::int16_t end;
    bool isWhole() const { return end - begin == kTileColumns; }
  };

  /// Adjacent entries at one disparity.
  struct Run {
    ColumnSpan span;        ///< left columns that are inside of both images
    std::ptrdiff_t offset;  ///< position of left column 0 in a CostRow
    int d;
  };

  /// Makes room for `entries` entries, so that `build` does not allocate.
  void reserve(const DisparityRange& range, std::size_t entries);

  /// Builds the entries of row y of the space.
  void build(const SearchSpace& space, int y);

  /// Places are [0, count()).
  int count() const { return static_cast<int>(entries_.size()); }
  const Entry* entries() const { return entries_.data(); }
  const std::vector<Run>& runs() const { return runs_; }
  /// Places of the disparity range.min + i.
  PlaceSpan places(int i) const { return {i == 0 ? 0 : ends_[i - 1], ends_[i]}; }
  /// Indices of the entries without a match inside of the right image.
  const std::vector<std::int32_t>& outside() const { return outside_; }

 private:
  void countEntries(const SearchSpace& space, int y);
  void placeEntries(const SearchSpace& space, int y);
  void findRuns();

  std::vector<Entry> entries_;
  std::vector<Run> runs_;
  std::vector<int> ends_;  ///< end of the places of each disparity
  std::vector<std::int32_t> outside_;
};

/// The largest number of entries in a row of the space.
std::size_t mostEntriesOfRow(const SearchSpace& space);

}  // namespace cbmv
