#include "matching/sobel_sad.h"

#include <cmath>

#include "support/matching_reference.h"

namespace cbmv::test {
namespace {

/// Response in an image whose border is repeated by kMatchingBorderPx only.
double response(const cv::Mat& gray, int y, int x) {
  const auto column = [&](int column_x) {
    const int inside = std::clamp(column_x, -kMatchingBorderPx, gray.cols - 1 + kMatchingBorderPx);
    return at(gray, y - 1, inside) + 2 * at(gray, y, inside) + at(gray, y + 1, inside);
  };
  return column(x + 1) - column(x - 1);
}

class SobelSadTest : public testing::TestWithParam<MatchingCase> {};

TEST_P(SobelSadTest, EqualsDefinition) {
  const auto [shape, content] = GetParam();
  const MatchingPair pair = makePair(shape, content);
  expectCosts<std::uint16_t, SobelSadMatcher>(
      pair, shape, 0,
      [](const SobelSadMatcher& matcher, int y, const RowEntries& entries,
         CostRow<std::uint16_t>& costs) {
        SobelSadMatcher::Scratch scratch;
        matcher.computeRow(y, entries, scratch, costs);
      },
      [&](int y, int x, int x_right) {
        double sum = 0;
        for (int dy = -2; dy <= 2; ++dy) {
          for (int dx = -2; dx <= 2; ++dx) {
            sum += std::abs(response(pair.left, y + dy, x + dx) -
                            response(pair.right, y + dy, x_right + dx));
          }
        }
        return sum;
      });
}

INSTANTIATE_TEST_SUITE_P(Shapes, SobelSadTest, allMatchingCases());

}  // namespace
}  // namespace cbmv::test
