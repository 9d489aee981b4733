#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/per_thread.h"
#include "base/search_space.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// Builds the search space of a level from the disparities at half its size and from mutual matches
/// at its own size. The object keeps its memory from pair to pair.
///
/// The disparities of a pixel are:
/// - those within margin_px of twice a coarse disparity, from coarse pixels that are at most
///   neighborhood_px rows and columns away from the position of the pixel in the coarse image;
/// - d − 1 … d + 1 of mutual matches that are at most kRescueRows rows and kRescueColumns
///   columns away.
///
/// A tile has the disparities of all its pixels, limited to the range. A tile without any has the
/// whole range.
class SearchWindows {
 public:
  static constexpr int kRescueRows = 3;
  static constexpr int kRescueColumns = 2;

  /// `coarse` is CV_32FC1 with half the size of `matches` (rounded down, at least 1), in coarse px.
  /// `invalid` marks pixels without a disparity. `matches` is CV_16SC1, from MutualMatcher.
  /// Parallel over rows by oneTBB. The result does not depend on earlier pairs.
  void build(const cv::Mat& coarse, float invalid, const cv::Mat& matches,
             const DisparityRange& range, const SearchOptions& options, SearchSpace& space);

 private:
  /// A set of indices for each tile of each row, one bit per index.
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

  TileSets coarse_sets_;  ///< per coarse row, with the indices of this level
  TileSets match_sets_;   ///< per row of this level
  PerThread<std::vector<std::uint64_t>> sets_;
};

}  // namespace cbmv
