#include "search/search_windows.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "search/mutual_matches.h"

namespace cbmv {
namespace {

constexpr float kInvalid = -100;

/// The indices of a tile, by the definition in the header.
std::set<int> tileIndices(const cv::Mat_<float>& coarse, const cv::Mat_<std::int16_t>& matches,
                          const DisparityRange& range, const SearchOptions& options, int y, int t) {
  std::set<int> found;
  const auto add = [&](int first, int last) {
    for (int i = std::max(first, 0); i <= std::min(last, range.count - 1); ++i) {
      found.insert(i);
    }
  };
  for (int x = t * kTileColumns; x < (t + 1) * kTileColumns; ++x) {
    for (int cy = 0; cy < coarse.rows; ++cy) {
      for (int cx = 0; cx < coarse.cols; ++cx) {
        const int place_x = std::min(x / 2, coarse.cols - 1);
        const int place_y = std::min(y / 2, coarse.rows - 1);
        const int reach = options.neighborhood_px;
        if (std::abs(cx - place_x) <= reach && std::abs(cy - place_y) <= reach &&
            coarse(cy, cx) != kInvalid) {
          const double fine = 2.0 * coarse(cy, cx) - range.min;
          add(static_cast<int>(std::floor(fine)) - options.margin_px,
              static_cast<int>(std::ceil(fine)) + options.margin_px);
        }
      }
    }
    for (int my = y - 3; my <= y + 3; ++my) {
      for (int mx = x - 2; mx <= x + 2; ++mx) {
        if (my >= 0 && my < matches.rows && mx >= 0 && mx < matches.cols &&
            matches(my, mx) != kNoMatch) {
          add(matches(my, mx) - 1, matches(my, mx) + 1);
        }
      }
    }
  }
  if (found.empty()) {
    add(0, range.count - 1);
  }
  return found;
}

void expectWindows(SearchWindows& windows, cv::Size size, const DisparityRange& range,
                   const SearchOptions& options, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat_<float> coarse(size.height / 2, size.width / 2);
  random.fill(coarse, cv::RNG::UNIFORM, range.min / 2.0 - 2, range.max() / 2.0 + 2);
  coarse.setTo(kInvalid, coarse > range.max() / 4.0);  // most pixels
  cv::Mat_<std::int16_t> matches(size);
  random.fill(matches, cv::RNG::UNIFORM, 0, range.count);
  for (std::int16_t& match : matches) {
    match = random.uniform(0, 40) == 0 ? match : kNoMatch;
  }
  SearchSpace space;
  windows.build(coarse, kInvalid, matches, range, options, space);
  for (int y = 0; y < size.height; ++y) {
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      const std::set<int> found(tile.indices, tile.indices + tile.count);
      ASSERT_EQ(static_cast<int>(found.size()), tile.count);
      ASSERT_EQ(found, tileIndices(coarse, matches, range, options, y, t)) << y << ", " << t;
    }
  }
}

TEST(SearchWindows, EqualTheDefinition) {
  SearchWindows windows;
  expectWindows(windows, {70, 20}, {0, 40}, {2, 1, 1}, 1);
  expectWindows(windows, {64, 21}, {-30, 150}, {2, 2, 3}, 2);
  expectWindows(windows, {49, 6}, {5, 64}, {1, 0, 2}, 3);
  expectWindows(windows, {33, 5}, {0, 65}, {1, 3, 0}, 4);
}

TEST(SearchWindows, TheWholeRangeWhereNothingIsKnown) {
  SearchWindows windows;
  SearchSpace space;
  windows.build(cv::Mat(8, 16, CV_32FC1, cv::Scalar(kInvalid)), kInvalid,
                cv::Mat(16, 32, CV_16SC1, cv::Scalar(kNoMatch)), {0, 70}, {}, space);
  EXPECT_EQ(space.entries(), 16U * 2 * 70);
}

}  // namespace
}  // namespace cbmv
