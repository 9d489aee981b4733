#include "search/search_windows.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "search/mutual_matches.h"

namespace cbmv {
namespace {

constexpr int kWordBits = 64;

/// Sets the bits of the indices [first, last], limited to [0, count).
void setRange(int first, int last, int count, std::uint64_t* words) {
  first = std::max(first, 0);
  last = std::min(last, count - 1);
  for (int i = first; i <= last;) {
    const int bit = i % kWordBits;
    const int bits = std::min(kWordBits - bit, last - i + 1);
    const std::uint64_t ones =
        bits == kWordBits ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    words[i / kWordBits] |= ones << bit;
    i += bits;
  }
}

/// Adds the set `set` to `united`. Both have `words` words.
void unite(const std::uint64_t* set, int words, std::uint64_t* united) {
  for (int w = 0; w < words; ++w) {
    united[w] |= set[w];
  }
}

/// Appends the list of a tile. An empty set gives the whole range.
void appendTile(const std::uint64_t* set, int words, int count, SearchSpace::Row& row) {
  bool is_empty = true;
  for (int w = 0; w < words; ++w) {
    for (std::uint64_t rest = set[w]; rest != 0; rest &= rest - 1) {
      row.push(w * kWordBits + __builtin_ctzll(rest));
      is_empty = false;
    }
  }
  for (int i = 0; is_empty && i < count; ++i) {
    row.push(i);
  }
  row.endTile();
}

cv::Range around(int first, int last, int reach, int end) {
  return {std::max(first - reach, 0), std::min(last + reach + 1, end)};
}

}  // namespace

void SearchWindows::TileSets::reset(int rows, int tiles, int words) {
  tiles_ = tiles;
  words_ = words;
  bits_.assign(static_cast<std::size_t>(rows) * tiles * words, 0);
}

void SearchWindows::build(const cv::Mat& coarse, float invalid, const cv::Mat& matches,
                          const DisparityRange& range, const SearchOptions& options,
                          SearchSpace& space) {
  CV_Assert(coarse.type() == CV_32FC1 && matches.type() == CV_16SC1);
  const int tiles = (matches.cols + kTileColumns - 1) / kTileColumns;
  const int words = (range.count + kWordBits - 1) / kWordBits;
  collectCoarse(coarse, invalid, range, options, tiles, words);
  collectMatches(matches, range, tiles, words);
  sets_.prepare([&](auto& set) { set.resize(words); });
  space.build(matches.rows, matches.cols, range, [&](int y, SearchSpace::Row& row) {
    const int coarse_y = std::min(y / 2, coarse.rows - 1);
    const cv::Range coarse_rows = around(coarse_y, coarse_y, options.neighborhood_px, coarse.rows);
    const cv::Range match_rows = around(y, y, kRescueRows, matches.rows);
    std::vector<std::uint64_t>& set = sets_.local();
    for (int t = 0; t < tiles; ++t) {
      std::fill(set.begin(), set.end(), 0);
      for (int r = coarse_rows.start; r < coarse_rows.end; ++r) {
        unite(coarse_sets_.tile(r, t), words, set.data());
      }
      for (int r = match_rows.start; r < match_rows.end; ++r) {
        unite(match_sets_.tile(r, t), words, set.data());
      }
      appendTile(set.data(), words, range.count, row);
    }
  });
}

void SearchWindows::collectCoarse(const cv::Mat& coarse, float invalid, const DisparityRange& range,
                                  const SearchOptions& options, int tiles, int words) {
  coarse_sets_.reset(coarse.rows, tiles, words);
  tbb::parallel_for(0, coarse.rows, [&](int y) {
    const auto* disparities = coarse.ptr<float>(y);
    for (int t = 0; t < tiles; ++t) {
      std::uint64_t* set = coarse_sets_.tile(y, t);
      // In an image of odd width, the last column is beyond the coarse image.
      const int first = std::min(t * kTileColumns / 2, coarse.cols - 1);
      const cv::Range columns =
          around(first, first + kTileColumns / 2 - 1, options.neighborhood_px, coarse.cols);
      for (int x = columns.start; x < columns.end; ++x) {
        if (disparities[x] != invalid) {
          const float fine = 2 * disparities[x] - static_cast<float>(range.min);
          setRange(static_cast<int>(std::floor(fine)) - options.margin_px,
                   static_cast<int>(std::ceil(fine)) + options.margin_px, range.count, set);
        }
      }
    }
  });
}

void SearchWindows::collectMatches(const cv::Mat& matches, const DisparityRange& range, int tiles,
                                   int words) {
  match_sets_.reset(matches.rows, tiles, words);
  tbb::parallel_for(0, matches.rows, [&](int y) {
    const auto* indices = matches.ptr<std::int16_t>(y);
    for (int t = 0; t < tiles; ++t) {
      std::uint64_t* set = match_sets_.tile(y, t);
      const int first = t * kTileColumns;
      const cv::Range columns =
          around(first, first + kTileColumns - 1, kRescueColumns, matches.cols);
      for (int x = columns.start; x < columns.end; ++x) {
        if (indices[x] != kNoMatch) {
          setRange(indices[x] - 1, indices[x] + 1, range.count, set);
        }
      }
    }
  });
}

}  // namespace cbmv
