#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "search/mutual_matches.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Finds the disparity range of a pair from the pair itself, by cheap matching at reduced size. The
/// object keeps its memory from pair to pair.
///
/// The pair is halved until it is at most 320 px wide. MutualMatcher scans half of that width. The
/// largest disparity is that of the nearest object. An object has at least kSmallestObjectPx
/// matched pixels of the coarse image that are connected and differ by at most one disparity from
/// pixel to pixel. Smaller groups are treated as outliers. A quarter of the range found is added
/// for nearer points that only one camera sees and for details that are missing in the coarse
/// image.
///
/// Checked on 137 scenes (Middlebury, KITTI, RealSense): docs/method.md.
class RangeFinder {
 public:
  static constexpr int kSmallestObjectPx = 32;
  /// The number of disparities is a multiple of this, unless the image width limits it.
  static constexpr int kStep = 16;
  /// Number of disparities if no object is found.
  static constexpr int kDefaultCount = 64;

  /// Finds the range of `left` and `right`, which are CV_8UC1 of the same size and not empty. The
  /// range begins at `min_disparity` and ends below the width of the images. Empty if no object is
  /// found, as in images without texture. Parallel by oneTBB. The result does not depend on earlier
  /// pairs or the number of threads.
  std::optional<DisparityRange> find(const cv::Mat& left, const cv::Mat& right, int min_disparity);

  /// The range to use if no object is found.
  static DisparityRange defaultRange(int min_disparity, int image_width);

 private:
  struct Pixel {
    int x, y, match;
  };

  /// Index of the largest disparity of an object, or kNoMatch. Removes objects from `matches_`.
  int findNearest(int disparities);
  void sortByDisparity(int disparities);
  bool isObject(const Pixel& seed);

  MutualMatcher matcher_{80};
  std::vector<cv::Mat> left_halves_, right_halves_;
  cv::Mat_<std::int16_t> matches_;
  std::vector<int> places_;    ///< start of each disparity in sorted_
  std::vector<Pixel> sorted_;  ///< pixels with a match, by ascending disparity
  std::vector<Pixel> stack_;
};

}  // namespace cbmv
