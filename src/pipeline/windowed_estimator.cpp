#include "pipeline/windowed_estimator.h"

#include <algorithm>
#include <cstdint>

#include <tbb/parallel_for.h>

#include "base/stopwatch.h"
#include "optimization/prepared_image.h"
#include "optimization/semi_global_matching.h"
#include "optimization/sgm_penalties.h"
#include "optimization/windowed_aggregation.h"
#include "optimization/windowed_sgm.h"
#include "optimization/windowed_winner_maps.h"
#include "optimization/windowed_winners.h"
#include "pipeline/cost_optimizer.h"
#include "refinement/disparity_refiner.h"
#include "volume/windowed_right_view.h"

namespace cbmv {
namespace {

constexpr std::size_t kEntriesPerTask = 4096;

void widen(const WindowedMatchingVolume& volume, const SearchSpace& space,
           WindowedAggregatedVolume& costs) {
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
    const WindowedAggregatedVolume& costs = optimize(View::kLeft, space, volume, result.times);
    {
      const Stopwatch watch(result.times.refinement_ms);
      windowedWinnerMaps(space, costs, volume, options_.refinement.subpixel,
                         {winners_, result.disparity, result.confidence, result.margin});
    }
    findRightWinners(space, volume, costs, result);
    const Stopwatch watch(result.times.refinement_ms);
    refiner_.refine(winners_, space.range(), options_.refinement,
                    {result.disparity, result.right_disparity, result.labels, result.confidence});
  }

 private:
  /// `costs` are the aggregated costs of the left view.
  void findRightWinners(const SearchSpace& space, const WindowedMatchingVolume& volume,
                        const WindowedAggregatedVolume& costs, StereoResult& result) {
    if (!options_.refinement.left_right_check) {
      return;
    }
    if (!options_.refinement.optimize_right_view) {
      const Stopwatch watch(result.times.refinement_ms);
      windowedRightWinners(space, costs, right_winner_rows_, result.right_disparity);
      return;
    }
    {
      const Stopwatch watch(result.times.volume_ms);
      right_view_.build(space, volume, right_space_, right_volume_);
    }
    const WindowedAggregatedVolume& right_costs =
        optimize(View::kRight, right_space_, right_volume_, result.times);
    const Stopwatch watch(result.times.refinement_ms);
    windowedWinners(right_space_, right_costs, View::kRight, result.right_disparity);
  }

  /// Cost aggregation and SGM of `volume`, which is of `view`.
  const WindowedAggregatedVolume& optimize(View view, const SearchSpace& space,
                                           const WindowedMatchingVolume& volume,
                                           StageTimes& times) {
    const PreparedImage& reference = view == View::kLeft ? left_ : right_;
    const PreparedImage& other = view == View::kLeft ? right_ : left_;
    const SupportArms arms = supportArmsOf(reference, other, options_.aggregation);
    const EdgeImages edges = edgeImagesOf(reference, other, options_.sgm);
    const int max_cost = sgmCostBound(options_.sgm);
    return optimizer_.optimize(
        volume, options_, times,
        [&](const auto& costs, WindowedAggregatedVolume& aggregated) {
          aggregator_.aggregate(space, costs, max_cost, arms, view, aggregated);
        },
        [&](const auto& costs, WindowedAggregatedVolume& mean) {
          sgm_.match(space, costs, edges, reference.surface, view, options_.sgm, mean);
        },
        [&](const auto& costs, WindowedAggregatedVolume& wide) { widen(costs, space, wide); });
  }

  StereoOptions options_;
  PreparedImage left_;
  PreparedImage right_;
  CostOptimizer<WindowedMatchingVolume, WindowedAggregatedVolume> optimizer_;
  cv::Mat winners_;  ///< left view, whole pixels

  SearchSpace right_space_;
  WindowedMatchingVolume right_volume_;

  // Memory of the stages.
  WindowedSgm sgm_;
  WindowedAggregator aggregator_;
  WindowedRightView right_view_;
  PerThread<WindowedRightWinnersRow> right_winner_rows_;
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
