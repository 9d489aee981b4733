#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "forest/forest.h"
#include "forest/forest_evaluator.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// Levels below the full size at which a pair of that size is searched: options.search.levels,
/// fewer where the shorter side would fall below 32 px.
int searchLevels(const cv::Size& image_size, const StereoOptions& options);

/// Coarse-to-fine search: the pair is matched exhaustively at 1 / 2^levels of its size; every finer
/// level is matched over the search space that SearchWindows makes of the level before and of
/// mutual matches. Coarse levels optimize the right view, too, where there is a left-right check.
/// The coarser level also tells the surfaces that semi-global matching follows. After Rothermel et
/// al. 2012 (tSGM) and Hirschmüller, Buder, Ernst 2012. Holds the memory of all levels, so one
/// object serves one pair at a time.
class PyramidMatcher {
 public:
  PyramidMatcher();
  ~PyramidMatcher();
  PyramidMatcher(const PyramidMatcher&) = delete;
  PyramidMatcher& operator=(const PyramidMatcher&) = delete;

  /// `left` and `right` are the aligned pair, CV_8UC1. Sets all maps, range and memory of `result`
  /// and adds to its times. Throws InputError if the pair needs more than options.max_memory_mb,
  /// which is known when its search space is, before the volumes are there. Parallel by oneTBB; the
  /// result depends neither on earlier pairs nor on the number of threads.
  void match(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options,
             const Forest& forest, const ForestEvaluator& evaluator, StereoResult& result);

  /// What was matched of the last pair at a level, from 0, the full size, to searchLevels(). Valid
  /// until the next pair.
  const SearchSpace& space(int level) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
