#include "base/search_space.h"

#include <gtest/gtest.h>

#include "support/random_search_space.h"

namespace cbmv {
namespace {

TEST(SearchSpace, NumbersTheEntriesRowByRow) {
  SearchSpace space;
  space.build(2, 40, {-3, 10}, [](int y, SearchSpace::Row& row) {
    for (int t = 0; t < 3; ++t) {
      for (int i = 0; i <= y + t; ++i) {
        row.push(2 * i);
      }
      row.endTile();
    }
  });
  ASSERT_EQ(space.tiles(), 3);
  EXPECT_EQ(space.entries(), 1U + 2 + 3 + 2 + 3 + 4);
  EXPECT_EQ(space.tile(0, 0).first_entry, 0U);
  EXPECT_EQ(space.tile(0, 2).first_entry, 3U);
  EXPECT_EQ(space.tile(1, 0).first_entry, 6U);
  const SearchSpace::Tile last = space.tile(1, 2);
  EXPECT_EQ(last.first_entry, 11U);
  ASSERT_EQ(last.count, 4);
  EXPECT_EQ(last.indices[3], 6);
  WindowedMatchingVolume volume;
  volume.resize(space);
  EXPECT_EQ(volume.entry(14) - volume.entry(0), 14 * kTileColumns);
}

TEST(SearchSpace, ExhaustiveOnesHaveTheWholeRange) {
  SearchSpace space = test::makeSearchSpace(5, 33, {0, 20}, 1);  // reused for another space
  space.buildExhaustive(4, 50, {-2, 7});
  EXPECT_EQ(space.entries(), 4U * 4 * 7);
  for (int y = 0; y < 4; ++y) {
    for (int t = 0; t < 4; ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      ASSERT_EQ(tile.count, 7);
      for (int i = 0; i < 7; ++i) {
        EXPECT_EQ(tile.indices[i], i);
      }
    }
  }
}

}  // namespace
}  // namespace cbmv
