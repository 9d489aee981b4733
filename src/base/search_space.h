#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Columns per tile: neighboring pixels of a row that share their hypotheses.
constexpr int kTileColumns = 16;

/// The disparities that are matched at each place of the image. Every tile of a row has an
/// ascending list of disparities. Tile t has the columns 16 t … 16 t + 15; the last tile may reach
/// beyond the image. In an exhaustive search, every tile has the whole disparity range.
///
/// The hypotheses of a tile at one disparity are an entry of a WindowedVolume. Entries are numbered
/// row by row, tile by tile, in the order of the lists.
class SearchSpace {
 public:
  /// The list of a tile: indices i of the disparities d = range.min + i, ascending.
  struct Tile {
    const std::int16_t* indices;
    int count;
    std::size_t first_entry;  ///< number in the volume
  };

  /// The lists of a row while they are built, tile by tile.
  class Row {
   public:
    /// Appends to the list of the current tile. Indices must ascend.
    void push(int index) { indices_.push_back(static_cast<std::int16_t>(index)); }
    void endTile() { ends_.push_back(static_cast<std::uint32_t>(indices_.size())); }

   private:
    friend class SearchSpace;
    std::vector<std::int16_t> indices_;
    std::vector<std::uint32_t> ends_;  ///< end of each tile's list
  };

  /// Calls fill(y, row) for every row of the image. `fill` must end each of the tiles() tiles.
  /// Parallel over rows by oneTBB. Memory is kept from frame to frame.
  template <typename Fill>
  void build(int height, int width, const DisparityRange& range, const Fill& fill) {
    reset(height, width, range);
    tbb::parallel_for(0, height, [&](int y) {
      rows_[y].indices_.clear();
      rows_[y].ends_.clear();
      fill(y, rows_[y]);
    });
    numberEntries();
  }

  /// Puts the whole disparity range into every tile.
  void buildExhaustive(int height, int width, const DisparityRange& range);

  int height() const { return height_; }
  int width() const { return width_; }
  /// Tiles per row.
  int tiles() const { return (width_ + kTileColumns - 1) / kTileColumns; }
  const DisparityRange& range() const { return range_; }
  /// Entries of all rows.
  std::size_t entries() const { return entries_; }

  Tile tile(int y, int t) const {
    const Row& row = rows_[y];
    const std::uint32_t begin = t == 0 ? 0 : row.ends_[t - 1];
    return {row.indices_.data() + begin, static_cast<int>(row.ends_[t] - begin),
            first_entries_[y] + begin};
  }

 private:
  void reset(int height, int width, const DisparityRange& range);
  void numberEntries();

  int height_ = 0;
  int width_ = 0;
  DisparityRange range_;
  std::size_t entries_ = 0;
  std::vector<Row> rows_;
  std::vector<std::size_t> first_entries_;  ///< per row
};

/// One cost per hypothesis of a search space, laid out [entry][column of the tile]. Costs of
/// columns beyond the image are unspecified, and so are the costs of entries whose matches are all
/// outside of the other image. kReadableBytesBeyond the last cost are readable.
template <typename Cost>
class WindowedVolume {
 public:
  /// Contents are unspecified afterwards. Keeps the memory if the new volume fits. Otherwise
  /// allocates one eighth more than needed, because the next volumes of a stream may be slightly
  /// larger.
  void resize(const SearchSpace& space) {
    entries_ = space.entries();
    const std::size_t costs = entries_ * kTileColumns + kReadableBytesBeyond / sizeof(Cost);
    if (costs > costs_.capacity()) {
      costs_ = {};  // first, so that old and new memory do not exist together
      costs_.reserve(costs + costs / 8);
    }
    costs_.resize(costs);
  }
  std::size_t entries() const { return entries_; }
  Cost* entry(std::size_t number) { return costs_.data() + number * kTileColumns; }
  const Cost* entry(std::size_t number) const { return costs_.data() + number * kTileColumns; }

 private:
  std::size_t entries_ = 0;
  std::vector<Cost, CacheLineAllocator<Cost>> costs_;
};

/// Cost types as in MatchingVolume and AggregatedVolume.
using WindowedMatchingVolume = WindowedVolume<std::uint8_t>;
using WindowedAggregatedVolume = WindowedVolume<std::uint16_t>;

}  // namespace cbmv
