#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "search/mutual_matches.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Finds the disparity range of a pair from the pair alone, by a cheap match at a fraction of its
/// size. Holds its memory, which is kept from pair to pair.
///
/// The pair is halved until it is at most 320 px wide, and MutualMatcher scans half of that width.
/// The largest disparity is that of the nearest object: at least kSmallestObjectPx matched pixels
/// of the coarse image that touch and differ by at most one disparity from pixel to pixel. Smaller
/// groups are taken for outliers. A quarter of the found range is added, for what is nearer but not
/// seen by both cameras, and for what the coarse image does not show.
///
/// Checked on 137 scenes (Middlebury, KITTI, RealSense): docs/method.md.
class RangeFinder {
 public:
  static constexpr int kSmallestObjectPx = 32;
  /// Numbers of disparities are multiples of it, but where the image ends before.
  static constexpr int kStep = 16;
  /// Number of disparities where nothing is found.
  static constexpr int kDefaultCount = 64;

  /// `left` and `right` are CV_8UC1 of one size, not empty. The range begins at `min_disparity` and
  /// ends below the width of the images. Nothing where no object is found, as in images without
  /// texture. Parallel by oneTBB; the result depends neither on earlier pairs nor on the number of
  /// threads.
  std::optional<DisparityRange> find(const cv::Mat& left, const cv::Mat& right, int min_disparity);

  /// What to take where nothing is found.
  static DisparityRange defaultRange(int min_disparity, int image_width);

 private:
  struct Pixel {
    int x, y, match;
  };

  /// Index of the largest disparity of an object, or kNoMatch. Takes objects out of `matches_`.
  int findNearest(int disparities);
  void sortByDisparity(int disparities);
  bool isObject(const Pixel& seed);

  MutualMatcher matcher_{80};
  std::vector<cv::Mat> left_halves_, right_halves_;
  cv::Mat_<std::int16_t> matches_;
  std::vector<int> places_;    ///< in sorted_, of each disparity
  std::vector<Pixel> sorted_;  ///< those that have a match, the largest disparity last
  std::vector<Pixel> stack_;
};

}  // namespace cbmv
