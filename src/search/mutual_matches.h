#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Value of a map of matches where there is no match.
constexpr std::int16_t kNoMatch = -1;

/// Finds reliable matches by a cheap scan over the whole disparity range. The coarse levels of a
/// search cannot see objects thinner than their pixels, such as poles in front of a far background.
/// The object keeps the memory of the scan from pair to pair.
///
/// The cost of (x, y, d) is the sum of Hamming distances over the 3 × 3 pixels around (x, y), with
/// census in a 9 × 7 window (62 neighbors). Beyond the first or last row, and where the left or
/// right pixel is beyond the first or last column, the nearest neighbor inside is repeated. The
/// winner of a left pixel is its d of lowest cost. The winner of a right pixel is the d of lowest
/// cost among the left pixels that match it. The smallest d wins ties.
///
/// A left pixel has a match if
/// - its winner and the winner of the matching right pixel differ by at most 1, and
/// - its cost is below `clear_percent` percent of the lowest cost among its disparities that are
///   more than 1 away from the winner. There must be at least one of these.
///
/// So windows without texture or with repeated texture have no match.
class MutualMatcher {
 public:
  /// Memory for both images: the matches, and the census of each.
  static constexpr double kBytesPerPixel = 2 + 2 * 1;
  /// Memory of a thread that scans a row.
  static double bytesPerThread(double width, double disparities) {
    return 4 * (width + 128) * disparities;
  }

  /// `clear_percent` is in (0, 100]. Lower values give fewer but more reliable matches.
  explicit MutualMatcher(int clear_percent = 99);
  ~MutualMatcher();
  MutualMatcher(const MutualMatcher&) = delete;
  MutualMatcher& operator=(const MutualMatcher&) = delete;

  /// Sets `matches` to a CV_16SC1 map of indices d − range.min, or kNoMatch. `left` and `right` are
  /// CV_8UC1 of the same size. Vectors by Highway, parallel over rows by oneTBB. The result does
  /// not depend on the instruction set, the number of threads or earlier pairs.
  void find(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
            cv::Mat& matches);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
