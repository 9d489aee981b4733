#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/search_space.h"
#include "matching/cost_row.h"

namespace cbmv {

/// Half-open interval of places (RowEntries).
struct PlaceSpan {
  int begin = 0;
  int end = 0;
  int count() const { return end - begin; }
  bool empty() const { return begin >= end; }
};

/// The entries of one image row of a search space in the order in which they are matched: by
/// disparity, then by column. A place is a number in this order. So neighboring tiles stand side by
/// side, and sums over the hypotheses of a pixel, in either view, run through the disparities in
/// ascending order. Entries without a match inside of the right image have no place.
class RowEntries {
 public:
  struct Entry {
    std::int32_t column;        ///< of the left image: first of the tile
    std::int32_t right_column;  ///< its match, column − d; may lie outside of the right image
    std::int32_t number;        ///< among all entries of the row, from 0 on (SearchSpace)
    std::int16_t begin;  ///< columns of the tile that lie inside of both images: [begin, end)
    std::int16_t end;
    bool isWhole() const { return end - begin == kTileColumns; }
  };

  /// Neighboring entries at one disparity.
  struct Run {
    ColumnSpan span;        ///< left columns that lie inside of both images
    std::ptrdiff_t offset;  ///< of left column 0 in a CostRow
    int d;
  };

  /// Makes room for so many entries, so that `build` allocates nothing.
  void reserve(const DisparityRange& range, std::size_t entries);

  /// Row y of the space.
  void build(const SearchSpace& space, int y);

  /// Places are [0, count()).
  int count() const { return static_cast<int>(entries_.size()); }
  const Entry* entries() const { return entries_.data(); }
  const std::vector<Run>& runs() const { return runs_; }
  /// Places of disparity range.min + i.
  PlaceSpan places(int i) const { return {i == 0 ? 0 : ends_[i - 1], ends_[i]}; }
  /// Numbers of the entries without a match inside of the right image.
  const std::vector<std::int32_t>& outside() const { return outside_; }

 private:
  void countEntries(const SearchSpace& space, int y);
  void placeEntries(const SearchSpace& space, int y);
  void findRuns();

  std::vector<Entry> entries_;
  std::vector<Run> runs_;
  std::vector<int> ends_;  ///< behind the last place of each disparity
  std::vector<std::int32_t> outside_;
};

/// The largest number of entries in a row of the space.
std::size_t mostEntriesOfRow(const SearchSpace& space);

}  // namespace cbmv
