#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "forest/forest.h"
#include "forest/forest_evaluator.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// Number of coarse levels for a pair of this size: options.search.levels, or fewer if the shorter
/// side would be below 32 px.
int searchLevels(const cv::Size& image_size, const StereoOptions& options);

/// Coarse-to-fine search, after Rothermel et al. 2012 (tSGM) and Hirschmüller, Buder, Ernst 2012:
/// - The pair is matched exhaustively at 1 / 2^levels of its size.
/// - Every finer level is matched over a search space. SearchWindows builds it from the coarser
///   level and from mutual matches.
/// - With the left-right consistency check, SGM also runs on the right view at coarse levels.
/// - SGM follows surfaces that are found at the coarser level.
///
/// The object has the memory of all levels, so it processes one pair at a time.
class PyramidMatcher {
 public:
  PyramidMatcher();
  ~PyramidMatcher();
  PyramidMatcher(const PyramidMatcher&) = delete;
  PyramidMatcher& operator=(const PyramidMatcher&) = delete;

  /// `left` and `right` are the rectified pair after the rectification correction, CV_8UC1. Sets
  /// all maps, range and memory of `result`, and adds to its times. Throws InputError if the pair
  /// needs more than options.max_memory_mb; this is checked when its search space is known, before
  /// the volumes are allocated. Parallel by oneTBB. The result does not depend on earlier pairs or
  /// the number of threads.
  void match(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options,
             const Forest& forest, const ForestEvaluator& evaluator, StereoResult& result);

  /// The search space of the last pair at a level, from 0 (full size) to searchLevels(). Valid
  /// until the next pair.
  const SearchSpace& space(int level) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
