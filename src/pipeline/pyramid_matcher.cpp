#include "pipeline/pyramid_matcher.h"

#include <algorithm>
#include <deque>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "optimization/surface_prior.h"
#include "pipeline/disparity_estimator.h"
#include "pipeline/memory.h"
#include "pipeline/windowed_estimator.h"
#include "search/mutual_matches.h"
#include "search/search_windows.h"
#include "volume/coarse_volume.h"
#include "volume/windowed_volume_builder.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr int kSmallestSidePx = 32;

/// At a quarter of the pixels or less, SGM on the right view costs little. The occlusions that it
/// finds keep wrong disparities out of the lists of the finer levels.
StereoOptions optionsOfCoarseLevels(const StereoOptions& options) {
  StereoOptions coarse = options;
  coarse.refinement.optimize_right_view = true;
  return coarse;
}

void addTimes(const StageTimes& more, StageTimes& times) {
  times.volume_ms += more.volume_ms;
  times.aggregation_ms += more.aggregation_ms;
  times.sgm_ms += more.sgm_ms;
  times.refinement_ms += more.refinement_ms;
}

/// Copies the disparities that pass the left-right consistency check.
void copyMatches(const StereoResult& result, cv::Mat& matches) {
  matches.create(result.disparity.size(), CV_32FC1);
  const float invalid = result.range.invalid();
  for (int y = 0; y < matches.rows; ++y) {
    const auto* labels = result.labels.ptr<std::uint8_t>(y);
    std::transform(labels, labels + matches.cols, result.disparity.ptr<float>(y),
                   matches.ptr<float>(y), [invalid](std::uint8_t label, float disparity) {
                     return label == kMatch ? disparity : invalid;
                   });
  }
}

}  // namespace

int searchLevels(const cv::Size& image_size, const StereoOptions& options) {
  int levels = 0;
  int side = std::min(image_size.width, image_size.height) / 2;
  for (; levels < options.search.levels && side >= kSmallestSidePx; side /= 2) {
    ++levels;
  }
  return levels;
}

class PyramidMatcher::Impl {
 public:
  void match(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options,
             const Forest& forest, const ForestEvaluator& evaluator, StereoResult& result) {
    const int coarser = searchLevels(left.size(), options);
    while (static_cast<int>(levels_.size()) < coarser) {
      levels_.emplace_back();
    }
    full_size_ = left.size();
    hypotheses_ = expectedHypotheses(full_size_, options);
    const cv::Mat* left_image = &left;
    const cv::Mat* right_image = &right;
    DisparityRange range = options.range;
    for (int i = 0; i < coarser; ++i) {
      Level& level = levels_[i];
      halveImage(*left_image, level.left);
      halveImage(*right_image, level.right);
      range = halveRange(range);
      level.range = range;
      level.stages.halvings = i + 1;
      left_image = &level.left;
      right_image = &level.right;
    }
    const Level* before = nullptr;
    const StereoOptions coarse_options = optionsOfCoarseLevels(options);
    for (int i = coarser - 1; i >= 0; --i) {
      Level& level = levels_[i];
      level.result.times = {};
      matchLevel(level.left, level.right, level.range, before, coarse_options, forest, evaluator,
                 level.stages, level.result);
      addTimes(level.result.times, result.times);
      before = &level;
    }
    matchLevel(left, right, options.range, before, options, forest, evaluator, finest_, result);
    result.memory_mb = searchMemoryMb(full_size_, options, hypotheses_);
  }

  const SearchSpace& space(int level) const {
    return level == 0 ? finest_.space : levels_[level - 1].stages.space;
  }

 private:
  /// Memory of the stages of one level.
  struct Stages {
    int halvings = 0;  ///< of the full size
    MutualMatcher mutual;
    SearchWindows windows;
    WindowedVolumeBuilder builder;
    WindowedEstimator estimator;
    SurfacePrior prior;
    cv::Mat matches;
    cv::Mat matched;  ///< disparities of the coarser level that passed the check
    SurfaceMaps surfaces;
    SearchSpace space;
    WindowedMatchingVolume volume;
  };

  /// A level below the full size.
  struct Level {
    cv::Mat left;
    cv::Mat right;
    DisparityRange range;
    Stages stages;
    StereoResult result;
  };

  /// `before` is the coarser level. Null: the level is searched exhaustively.
  void matchLevel(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
                  const Level* before, const StereoOptions& options, const Forest& forest,
                  const ForestEvaluator& evaluator, Stages& stages, StereoResult& result) {
    {
      const Stopwatch watch(result.times.volume_ms);
      if (before == nullptr) {
        stages.space.buildExhaustive(left.rows, left.cols, range);
      } else {
        stages.mutual.find(left, right, range, stages.matches);
        stages.windows.build(before->result.disparity, before->result.range.invalid(),
                             stages.matches, range, options.search, stages.space);
      }
      requireMemory(stages, options);
      stages.builder.build(left, right, stages.space, forest, evaluator, stages.volume);
    }
    {
      const Stopwatch watch(result.times.sgm_ms);
      findSurfaces(left.size(), before, options, stages);
    }
    stages.estimator.estimate(left, right, stages.surfaces, options, stages.space, stages.volume,
                              result);
  }

  /// Throws InputError if the pair needs too much memory. Called when the lists of this level are
  /// known.
  void requireMemory(const Stages& stages, const StereoOptions& options) {
    hypotheses_[stages.halvings] = static_cast<double>(stages.space.entries()) * kTileColumns;
    const std::string error = searchMemoryError(full_size_, options, hypotheses_);
    if (!error.empty()) {
      throw InputError(InputFault::kMemory, error);
    }
  }

  /// Ignores pixels that fail the left-right consistency check at the coarser level.
  static void findSurfaces(const cv::Size& size, const Level* before, const StereoOptions& options,
                           Stages& stages) {
    if (before == nullptr || !findsSurfaces(size, options)) {
      stages.surfaces = {};
      return;
    }
    const StereoResult& coarse = before->result;
    const float invalid = coarse.range.invalid();
    const float reach_px = options.surface.reach_px;
    copyMatches(coarse, stages.matched);
    stages.prior.estimate(stages.matched, invalid, reach_px, size, stages.surfaces.left);
    if (options.refinement.left_right_check && options.refinement.optimize_right_view) {
      stages.prior.estimate(coarse.right_disparity, invalid, reach_px, size, stages.surfaces.right);
    }
  }

  cv::Size full_size_;
  std::vector<double> hypotheses_;  ///< per level, full size first; expected until known
  std::deque<Level> levels_;        ///< half the size first
  Stages finest_;
};

PyramidMatcher::PyramidMatcher() : impl_(std::make_unique<Impl>()) {}
PyramidMatcher::~PyramidMatcher() = default;

void PyramidMatcher::match(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options,
                           const Forest& forest, const ForestEvaluator& evaluator,
                           StereoResult& result) {
  impl_->match(left, right, options, forest, evaluator, result);
}

const SearchSpace& PyramidMatcher::space(int level) const { return impl_->space(level); }

}  // namespace cbmv
