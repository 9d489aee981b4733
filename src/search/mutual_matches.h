#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Value of a map of matches where there is none.
constexpr std::int16_t kNoMatch = -1;

/// Finds pixels that certainly belong together, by a cheap scan over the whole range: the coarse
/// levels of a search do not see what is thinner than their pixels, such as poles in front of a far
/// background. Holds the memory of the scan, which is kept from pair to pair.
///
/// The cost of (x, y, d) is the sum, over the 3 × 3 pixels around (x, y), of the Hamming distances
/// of census in a window of 9 × 7 (62 neighbours). Neighbours beyond the first or last row, or
/// whose left or right pixel lies beyond the first or last column, repeat the nearest one inside.
/// The winner of a left pixel is its cheapest d, that of a right pixel the cheapest d of the left
/// pixels that match it; the smallest d on ties. A left pixel has a match if its winner and that of
/// the matching right pixel differ by at most 1, and its cost is below `clear_percent` percent of
/// the least cost of its disparities that are more than 1 away, of which there is one at least:
/// windows without texture, or with a repeated one, have none.
class MutualMatcher {
 public:
  /// `clear_percent` is in (0, 100]; the lower it is, the fewer and the surer are the matches.
  explicit MutualMatcher(int clear_percent = 99);
  ~MutualMatcher();
  MutualMatcher(const MutualMatcher&) = delete;
  MutualMatcher& operator=(const MutualMatcher&) = delete;

  /// `left` and `right` are CV_8UC1 of one size. `matches` becomes CV_16SC1 of indices
  /// d − range.min, or kNoMatch. Vectors by Highway, parallel over rows by oneTBB; the result
  /// depends neither on the instruction set nor on the number of threads nor on earlier pairs.
  void find(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
            cv::Mat& matches);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
