#include "matching/census.h"

#include "support/matching_reference.h"

namespace cbmv::test {
namespace {

class CensusTest : public testing::TestWithParam<MatchingCase> {};

TEST_P(CensusTest, EqualsHammingDistanceOfComparisons) {
  const auto [shape, content] = GetParam();
  const MatchingPair pair = makePair(shape, content);
  expectCosts<std::uint8_t, CensusMatcher>(
      pair, shape, 0,
      [](const CensusMatcher& matcher, int y, const RowEntries& entries,
         CostRow<std::uint8_t>& costs) {
        CensusMatcher::Scratch scratch;
        matcher.computeRow(y, entries, scratch, costs);
      },
      [&](int y, int x, int x_right) {
        int distance = 0;
        for (int dy = -5; dy <= 5; ++dy) {
          for (int dx = -5; dx <= 5; ++dx) {
            const bool left = at(pair.left, y + dy, x + dx) < at(pair.left, y, x);
            const bool right = at(pair.right, y + dy, x_right + dx) < at(pair.right, y, x_right);
            distance += left != right ? 1 : 0;
          }
        }
        return distance;
      });
}

INSTANTIATE_TEST_SUITE_P(Shapes, CensusTest, allMatchingCases());

}  // namespace
}  // namespace cbmv::test
