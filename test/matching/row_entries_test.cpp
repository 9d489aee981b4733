#include "matching/row_entries.h"

#include <algorithm>
#include <set>
#include <vector>

#include "support/random_images.h"
#include "support/random_search_space.h"

namespace cbmv::test {
namespace {

class RowEntriesTest : public testing::TestWithParam<Shape> {
 protected:
  SearchSpace windows() const {
    const Shape& shape = GetParam();
    return makeSearchSpace(shape.height, shape.width, shape.range, 9);
  }
};

/// Calls check(place, entry, i) for all places of the row.
template <typename Check>
void forPlaces(const RowEntries& entries, const DisparityRange& range, const Check& check) {
  int next = 0;
  for (int i = 0; i < range.count; ++i) {
    const PlaceSpan places = entries.places(i);
    ASSERT_EQ(places.begin, next);
    next = places.end;
    for (int place = places.begin; place < places.end; ++place) {
      check(place, entries.entries()[place], i);
    }
  }
  ASSERT_EQ(next, entries.count());
}

TEST_P(RowEntriesTest, HasEachEntryOnceByDisparityAndColumn) {
  const Shape& shape = GetParam();
  const SearchSpace space = windows();
  RowEntries entries;  // reused for all cases
  for (int y = 0; y < shape.height; ++y) {
    entries.build(space, y);
    std::set<int> numbers(entries.outside().begin(), entries.outside().end());
    int last_column = -1;
    int last_i = -1;
    forPlaces(entries, shape.range, [&](int, const RowEntries::Entry& entry, int i) {
      const SearchSpace::Tile tile = space.tile(y, entry.column / kTileColumns);
      const auto first = static_cast<int>(tile.first_entry - space.tile(y, 0).first_entry);
      ASSERT_EQ(tile.indices[entry.number - first], i);
      ASSERT_EQ(entry.right_column, entry.column - shape.range.min - i);
      ASSERT_TRUE(i > last_i || entry.column > last_column);
      last_i = i;
      last_column = entry.column;
      EXPECT_TRUE(numbers.insert(entry.number).second);
      ASSERT_LT(entry.begin, entry.end);
      for (int k = 0; k < kTileColumns; ++k) {
        const bool inside = entry.column + k < shape.width && entry.right_column + k >= 0 &&
                            entry.right_column + k < shape.width;
        ASSERT_EQ(k >= entry.begin && k < entry.end, inside);
      }
    });
    const SearchSpace::Tile last = space.tile(y, space.tiles() - 1);
    EXPECT_EQ(numbers.size(), last.first_entry + last.count - space.tile(y, 0).first_entry);
    EXPECT_LE(numbers.size(), mostEntriesOfRow(space));
  }
}

TEST_P(RowEntriesTest, RunsCoverTheHypothesesInside) {
  const Shape& shape = GetParam();
  const SearchSpace space = windows();
  RowEntries entries;
  entries.build(space, 0);
  std::vector<int> covered(static_cast<std::size_t>(entries.count()) * kTileColumns);
  for (const RowEntries::Run& run : entries.runs()) {
    ASSERT_FALSE(run.span.empty());
    for (int x = run.span.begin; x < run.span.end; ++x) {
      const auto h = static_cast<int>(run.offset + x);
      const RowEntries::Entry& entry = entries.entries()[h / kTileColumns];
      ASSERT_EQ(entry.column + h % kTileColumns, x);
      ASSERT_EQ(entry.right_column, entry.column - run.d);
      ++covered[h];
    }
  }
  forPlaces(entries, shape.range, [&](int place, const RowEntries::Entry& entry, int) {
    for (int k = 0; k < kTileColumns; ++k) {
      ASSERT_EQ(covered[place * kTileColumns + k], k >= entry.begin && k < entry.end ? 1 : 0);
    }
  });
}

TEST(RowEntries, NeighborsBecomeOneRun) {
  SearchSpace space;
  space.buildExhaustive(1, 70, {-3, 9});
  RowEntries entries;
  entries.build(space, 0);
  EXPECT_EQ(entries.runs().size(), 9U);
}

INSTANTIATE_TEST_SUITE_P(Shapes, RowEntriesTest, testing::ValuesIn(awkwardShapes()));

}  // namespace
}  // namespace cbmv::test
