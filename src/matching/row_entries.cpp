#include "matching/row_entries.h"

#include <algorithm>

namespace cbmv {
namespace {

/// Part [begin, end) of the list of a tile.
struct ListPart {
  int begin;
  int end;
};

/// The part of a tile's list whose hypotheses have at least one column inside of both images.
/// `columns` are the columns of the tile inside of the left image.
ListPart matchedPart(const SearchSpace::Tile& tile, const ColumnSpan& columns, int width,
                     const DisparityRange& range) {
  const int lowest = columns.begin - width + 1 - range.min;
  const int highest = columns.end - 1 - range.min;
  ListPart part{0, tile.count};
  while (part.begin < part.end && tile.indices[part.begin] < lowest) {
    ++part.begin;
  }
  while (part.begin < part.end && tile.indices[part.end - 1] > highest) {
    --part.end;
  }
  return part;
}

ColumnSpan columnsOfTile(int t, int width) {
  return {t * kTileColumns, std::min((t + 1) * kTileColumns, width)};
}

}  // namespace

void RowEntries::reserve(const DisparityRange& range, std::size_t entries) {
  entries_.reserve(entries);
  runs_.reserve(entries);
  outside_.reserve(entries);
  ends_.reserve(range.count);
}

void RowEntries::build(const SearchSpace& space, int y) {
  countEntries(space, y);
  placeEntries(space, y);
  findRuns();
}

/// Afterwards ends_ has the first place of each disparity.
void RowEntries::countEntries(const SearchSpace& space, int y) {
  ends_.assign(space.range().count, 0);
  int* counts = ends_.data();
  for (int t = 0; t < space.tiles(); ++t) {
    const SearchSpace::Tile tile = space.tile(y, t);
    const ListPart part =
        matchedPart(tile, columnsOfTile(t, space.width()), space.width(), space.range());
    const std::int16_t* const end = tile.indices + part.end;
    for (const std::int16_t* index = tile.indices + part.begin; index != end; ++index) {
      ++counts[*index];
    }
  }
  int first = 0;
  for (int& end : ends_) {
    first += end;
    end = first - end;
  }
  entries_.resize(first);
}

void RowEntries::placeEntries(const SearchSpace& space, int y) {
  const int width = space.width();
  const DisparityRange range = space.range();
  const std::size_t first_entry = space.tile(y, 0).first_entry;
  Entry* entries = entries_.data();
  int* next_places = ends_.data();
  outside_.clear();
  for (int t = 0; t < space.tiles(); ++t) {
    const SearchSpace::Tile tile = space.tile(y, t);
    const ColumnSpan columns = columnsOfTile(t, width);
    const ListPart part = matchedPart(tile, columns, width, range);
    const auto number = static_cast<std::int32_t>(tile.first_entry - first_entry);
    for (int k = 0; k < part.begin; ++k) {
      outside_.push_back(number + k);
    }
    for (int k = part.begin; k < part.end; ++k) {
      const int right_column = columns.begin - range.min - tile.indices[k];
      entries[next_places[tile.indices[k]]++] = {
          columns.begin, right_column, number + k,
          static_cast<std::int16_t>(std::max(0, -right_column)),
          static_cast<std::int16_t>(std::min(columns.end - columns.begin, width - right_column))};
    }
    for (int k = part.end; k < tile.count; ++k) {
      outside_.push_back(number + k);
    }
  }
}

void RowEntries::findRuns() {
  runs_.clear();
  const Entry* const first = entries_.data();
  const Entry* const end = first + entries_.size();
  for (const Entry* entry = first; entry != end;) {
    const Entry* last = entry;
    while (last + 1 != end && last[1].column == last->column + kTileColumns &&
           last[1].right_column == last->right_column + kTileColumns) {
      ++last;
    }
    runs_.push_back({{entry->column + entry->begin, last->column + last->end},
                     (entry - first) * kTileColumns - entry->column,
                     entry->column - entry->right_column});
    entry = last + 1;
  }
}

std::size_t mostEntriesOfRow(const SearchSpace& space) {
  std::size_t most = 0;
  for (int y = 0; y < space.height(); ++y) {
    const SearchSpace::Tile last = space.tile(y, space.tiles() - 1);
    most = std::max(most, last.first_entry + last.count - space.tile(y, 0).first_entry);
  }
  return most;
}

}  // namespace cbmv
