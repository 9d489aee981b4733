#include "matching/zero_mean_sad.h"

#include <cmath>

#include "support/matching_reference.h"

namespace cbmv::test {
namespace {

/// Mean rounded to a quarter, halves up, as documented in the header.
double windowMean(const cv::Mat& gray, int y, int x) {
  double sum = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      sum += at(gray, y + dy, x + dx);
    }
  }
  return std::floor(4 * sum / 25 + 0.5) / 4;
}

class ZeroMeanSadTest : public testing::TestWithParam<MatchingCase> {};

TEST_P(ZeroMeanSadTest, EqualsDefinition) {
  const auto [shape, content] = GetParam();
  const MatchingPair pair = makePair(shape, content);
  expectCosts<std::uint16_t, ZeroMeanSadMatcher>(
      pair, shape, 0,
      [](const ZeroMeanSadMatcher& matcher, int y, const RowEntries& entries,
         CostRow<std::uint16_t>& costs) {
        ZeroMeanSadMatcher::Scratch scratch;
        matcher.computeRow(y, entries, scratch, costs);
      },
      [&](int y, int x, int x_right) {
        const double mean_left = windowMean(pair.left, y, x);
        const double mean_right = windowMean(pair.right, y, x_right);
        double sum = 0;
        for (int dy = -2; dy <= 2; ++dy) {
          for (int dx = -2; dx <= 2; ++dx) {
            sum += std::abs(at(pair.left, y + dy, x + dx) - mean_left -
                            (at(pair.right, y + dy, x_right + dx) - mean_right));
          }
        }
        return 4 * sum;
      });
}

INSTANTIATE_TEST_SUITE_P(Shapes, ZeroMeanSadTest, allMatchingCases());

TEST(ZeroMeanSad, LargestCostFits) {
  cv::Mat left(11, 11, CV_8UC1, cv::Scalar(0));
  cv::Mat right(11, 11, CV_8UC1, cv::Scalar(255));
  left.colRange(0, 5).setTo(255);
  right.colRange(0, 5).setTo(0);
  MatchingPair pair;
  padImage(left, pair.padded_left);
  padImage(right, pair.padded_right);
  ZeroMeanSadMatcher matcher;
  matcher.prepare(pair.padded_left, pair.padded_right);
  ZeroMeanSadMatcher::Scratch scratch;
  CostRow<std::uint16_t> costs;
  matcher.computeRow(5, allEntries({11, 11, {0, 1}}), scratch, costs);
  EXPECT_EQ(costs.entry(0)[4], 4 * (15 * (255 - 51) + 10 * (255 + 51)));
}

}  // namespace
}  // namespace cbmv::test
