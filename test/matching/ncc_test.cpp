#include "matching/ncc.h"

#include <cmath>

#include "support/matching_reference.h"

namespace cbmv::test {
namespace {

double naiveNccCost(const MatchingPair& pair, int y, int x, int x_right) {
  double mean_left = 0;
  double mean_right = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      mean_left += at(pair.left, y + dy, x + dx) / 9;
      mean_right += at(pair.right, y + dy, x_right + dx) / 9;
    }
  }
  double covariance = 0;
  double variance_left = 0;
  double variance_right = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const double left = at(pair.left, y + dy, x + dx) - mean_left;
      const double right = at(pair.right, y + dy, x_right + dx) - mean_right;
      covariance += left * right;
      variance_left += left * left;
      variance_right += right * right;
    }
  }
  const bool textureless = variance_left < 1e-6 || variance_right < 1e-6;
  return textureless ? 1 : -covariance / std::sqrt(variance_left * variance_right);
}

class NccTest : public testing::TestWithParam<MatchingCase> {};

TEST_P(NccTest, EqualsDefinition) {
  const auto [shape, content] = GetParam();
  const MatchingPair pair = makePair(shape, content);
  expectCosts<float, NccMatcher>(
      pair, shape, 2e-6,
      [](const NccMatcher& matcher, int y, const RowEntries& entries, CostRow<float>& costs) {
        NccMatcher::Scratch scratch;
        matcher.computeRow(y, entries, scratch, costs);
      },
      [&](int y, int x, int x_right) { return naiveNccCost(pair, y, x, x_right); });
}

INSTANTIATE_TEST_SUITE_P(Shapes, NccTest, allMatchingCases());

}  // namespace
}  // namespace cbmv::test
