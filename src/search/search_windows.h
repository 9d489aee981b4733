#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/per_thread.h"
#include "base/search_space.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// Makes the search space of a level from the disparities at half of its size, and from mutual
/// matches at its own size. Holds its memory, which is kept from pair to pair.
///
/// A pixel's disparities are those within margin_px of twice a coarse disparity, where that is of a
/// pixel at most neighborhood_px rows and columns away from the pixel's place in the coarse image,
/// and d − 1 … d + 1 of the mutual matches at most kRescueRows rows and kRescueColumns columns
/// away. A tile has those of all its pixels, cut to the range; where there are none, the whole
/// range.
class SearchWindows {
 public:
  static constexpr int kRescueRows = 3;
  static constexpr int kRescueColumns = 2;

  /// `coarse` is CV_32FC1 of half the size of `matches` (rounded down, at least 1), in coarse
  /// pixels; `invalid` marks pixels without a disparity. `matches` is CV_16SC1 as MutualMatcher
  /// makes it. Parallel over rows by oneTBB; the result does not depend on earlier pairs.
  void build(const cv::Mat& coarse, float invalid, const cv::Mat& matches,
             const DisparityRange& range, const SearchOptions& options, SearchSpace& space);

 private:
  /// For each tile of each row, a set of indices, one bit each.
  class TileSets {
   public:
    void reset(int rows, int tiles, int words);
    std::uint64_t* tile(int row, int t) {
      return bits_.data() + (static_cast<std::size_t>(row) * tiles_ + t) * words_;
    }

   private:
    int tiles_ = 0;
    int words_ = 0;
    std::vector<std::uint64_t> bits_;
  };

  void collectCoarse(const cv::Mat& coarse, float invalid, const DisparityRange& range,
                     const SearchOptions& options, int tiles, int words);
  void collectMatches(const cv::Mat& matches, const DisparityRange& range, int tiles, int words);

  TileSets coarse_sets_;  ///< of the coarse rows, over the indices of the level
  TileSets match_sets_;   ///< of the rows of the level
  PerThread<std::vector<std::uint64_t>> sets_;
};

}  // namespace cbmv
