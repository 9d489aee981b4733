#include "cbmv_stereo/pipeline/windowed_estimator.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <tbb/parallel_for.h>

#include "stopwatch.h"

#include "cbmv_stereo/optimization/prepared_image.h"
#include "cbmv_stereo/optimization/semi_global_matching.h"
#include "cbmv_stereo/optimization/windowed_aggregation.h"
#include "cbmv_stereo/optimization/windowed_sgm.h"
#include "cbmv_stereo/optimization/windowed_winner_maps.h"
#include "cbmv_stereo/optimization/windowed_winners.h"
#include "cbmv_stereo/refinement/disparity_refiner.h"
#include "cbmv_stereo/volume/windowed_right_view.h"

namespace cbmv {
namespace {

constexpr std::size_t kEntriesPerTask = 4096;

void widen(const WindowedMatchingVolume& volume, const SearchSpace& space,
           WindowedOptimizedVolume& costs) {
  costs.resize(space);
  const std::size_t tasks = (space.entries() + kEntriesPerTask - 1) / kEntriesPerTask;
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    const std::size_t begin = task * kEntriesPerTask;
    const std::size_t count = std::min(kEntriesPerTask, space.entries() - begin);
    std::copy_n(volume.entry(begin), count * kTileColumns, costs.entry(begin));
  });
}

}  // namespace

class WindowedEstimator::Impl {
 public:
  void estimate(const cv::Mat& left, const cv::Mat& right, const SurfaceMaps& surfaces,
                const StereoOptions& options, const SearchSpace& space,
                const WindowedMatchingVolume& volume, StereoResult& result) {
    options_ = options;
    result.range = space.range();
    {
      const Stopwatch watch(result.times.aggregation_ms);
      left_.prepare(left, options_.aggregation);
      right_.prepare(right, options_.aggregation);
      left_.surface = surfaces.left;
      right_.surface = surfaces.right;
    }
    optimize(View::kLeft, space, volume, result.times);
    {
      const Stopwatch watch(result.times.refinement_ms);
      windowedWinnerMaps(space, *optimized_, volume, options_.refinement.subpixel,
                         {winners_, result.disparity, result.confidence});
    }
    findRightWinners(space, volume, result);
    const Stopwatch watch(result.times.refinement_ms);
    refiner_.refine(winners_, space.range(), options_.refinement,
                    {result.disparity, result.right_disparity, result.labels, result.confidence});
  }

 private:
  void findRightWinners(const SearchSpace& space, const WindowedMatchingVolume& volume,
                        StereoResult& result) {
    if (!options_.refinement.left_right_check) {
      return;
    }
    if (!options_.refinement.optimize_right_view) {
      const Stopwatch watch(result.times.refinement_ms);
      windowedWinnersAcross(space, *optimized_, across_rows_, result.right_disparity);
      return;
    }
    {
      const Stopwatch watch(result.times.volume_ms);
      right_view_.build(space, volume, right_space_, right_volume_);
    }
    optimize(View::kRight, right_space_, right_volume_, result.times);
    const Stopwatch watch(result.times.refinement_ms);
    windowedWinners(right_space_, *optimized_, View::kRight, result.right_disparity);
  }

  /// Aggregation, semi-global matching and aggregation again of `volume`, which is of `view`.
  /// Leaves the costs in *optimized_.
  void optimize(View view, const SearchSpace& space, const WindowedMatchingVolume& volume,
                StageTimes& times) {
    const PreparedImage& reference = view == View::kLeft ? left_ : right_;
    const PreparedImage& other = view == View::kLeft ? right_ : left_;
    matching_costs_ = &volume;
    aggregate(options_.aggregation.iterations_before, view, space, times);
    const EdgeImages edges{reference.gray, other.gray,
                           options_.sgm.edge_threshold * reference.deviation,
                           options_.sgm.edge_threshold * other.deviation};
    for (int i = 0; i < options_.sgm.iterations; ++i) {
      const Stopwatch watch(times.sgm_ms);
      apply([&](const auto& costs, WindowedOptimizedVolume& mean) {
        sgm_.match(space, costs, edges, reference.surface, view, options_.sgm, mean);
      });
    }
    aggregate(options_.aggregation.iterations_after, view, space, times);
    if (matching_costs_ != nullptr) {
      widen(volume, space, *optimized_);
    }
  }

  void aggregate(int iterations, View view, const SearchSpace& space, StageTimes& times) {
    const Stopwatch watch(times.aggregation_ms);
    const PreparedImage& reference = view == View::kLeft ? left_ : right_;
    const PreparedImage& other = view == View::kLeft ? right_ : left_;
    const int max_cost = sgmCostBound(options_.sgm);
    const SupportArms arms{reference.arms, other.arms, options_.aggregation.arm_length_px - 1};
    for (int i = 0; i < iterations; ++i) {
      apply([&](const auto& costs, WindowedOptimizedVolume& aggregated) {
        aggregator_.aggregate(space, costs, max_cost, arms, view, aggregated);
      });
    }
  }

  /// Replaces the costs by what a stage makes of them. The first stage reads the matching costs, so
  /// that a second volume is needed from the second stage on only.
  template <typename Stage>
  void apply(const Stage& stage) {
    if (matching_costs_ != nullptr) {
      stage(*matching_costs_, *optimized_);
      matching_costs_ = nullptr;
    } else {
      stage(*optimized_, *spare_);
      std::swap(optimized_, spare_);
    }
  }

  StereoOptions options_;
  PreparedImage left_;
  PreparedImage right_;
  WindowedOptimizedVolume first_;
  WindowedOptimizedVolume second_;
  WindowedOptimizedVolume* optimized_ = &first_;
  WindowedOptimizedVolume* spare_ = &second_;
  /// The costs, until a stage has replaced them.
  const WindowedMatchingVolume* matching_costs_ = nullptr;
  cv::Mat winners_;  ///< of the left view, whole pixels

  SearchSpace right_space_;
  WindowedMatchingVolume right_volume_;

  // Memory of the stages.
  WindowedSgm sgm_;
  WindowedAggregator aggregator_;
  WindowedRightView right_view_;
  PerThread<RightWinnersRow> across_rows_;
  DisparityRefiner refiner_;
};

WindowedEstimator::WindowedEstimator() : impl_(std::make_unique<Impl>()) {}
WindowedEstimator::~WindowedEstimator() = default;

void WindowedEstimator::estimate(const cv::Mat& left, const cv::Mat& right,
                                 const SurfaceMaps& surfaces, const StereoOptions& options,
                                 const SearchSpace& space, const WindowedMatchingVolume& volume,
                                 StereoResult& result) {
  impl_->estimate(left, right, surfaces, options, space, volume, result);
}

}  // namespace cbmv
