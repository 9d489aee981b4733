#include "pipeline/disparity_estimator.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <tbb/parallel_for.h>

#include "base/per_thread.h"
#include "base/stopwatch.h"
#include "optimization/cross_based_aggregation.h"
#include "optimization/prepared_image.h"
#include "optimization/semi_global_matching.h"
#include "optimization/sgm_penalties.h"
#include "optimization/surface_prior.h"
#include "optimization/winner_takes_all.h"
#include "pipeline/cost_optimizer.h"
#include "refinement/disparity_refiner.h"
#include "refinement/subpixel.h"
#include "volume/coarse_volume.h"
#include "volume/volume_builder.h"

namespace cbmv {
namespace {

/// Shorter side of the smallest pair that is first matched at half the size. In smaller images,
/// surfaces are only a few pixels large.
constexpr int kSmallestSidePx = 128;

void widen(const MatchingVolume& volume, AggregatedVolume& costs) {
  costs.resize(volume.height(), volume.width(), volume.disparities());
  tbb::parallel_for(0, volume.height(), [&](int y) {
    std::copy_n(volume.row(y), static_cast<std::size_t>(volume.width()) * volume.disparities(),
                costs.row(y));
  });
}

/// Probability of the winner per pixel. 0 where there is no winner.
void readConfidence(const MatchingVolume& volume, const cv::Mat& winners,
                    const DisparityRange& range, cv::Mat& confidence) {
  confidence.create(winners.size(), CV_32FC1);
  tbb::parallel_for(0, winners.rows, [&](int y) {
    for (int x = 0; x < winners.cols; ++x) {
      const float d = winners.at<float>(y, x);
      const bool valid = d != range.invalid();
      confidence.at<float>(y, x) =
          valid ? 1.0F - static_cast<float>(volume.pixel(y, x)[static_cast<int>(d) - range.min]) /
                             255.0F
                : 0.0F;
    }
  });
}

}  // namespace

class DisparityEstimator::Impl {
 public:
  void estimate(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options,
                MatchingVolume& volume, StereoResult& result) {
    options_ = options;
    result.range = options.range;
    {
      const Stopwatch watch(result.times.aggregation_ms);
      left_.prepare(left, options_.aggregation);
      right_.prepare(right, options_.aggregation);
    }
    {
      const Stopwatch watch(result.times.sgm_ms);
      findSurfaces(volume);
    }
    const AggregatedVolume& costs = optimize(View::kLeft, volume, result.times);
    {
      const Stopwatch watch(result.times.refinement_ms);
      winnerTakesAll(costs, View::kLeft, options_.range, winners_);
      readConfidence(volume, winners_, options_.range, result.confidence);
      winnerMargins(costs, options_.range, winners_, result.margin);
      winners_.copyTo(result.disparity);
      if (options_.refinement.subpixel) {
        refineSubpixel(costs, View::kLeft, options_.range, result.disparity);
      }
    }
    if (matchesRightView()) {
      matchRightView(volume, result);
    } else if (options_.refinement.left_right_check) {
      const Stopwatch watch(result.times.refinement_ms);
      rightWinners(costs, options_.range, right_winner_rows_, result.right_disparity);
    }
    const Stopwatch watch(result.times.refinement_ms);
    refiner_.refine(winners_, options_.range, options_.refinement,
                    {result.disparity, result.right_disparity, result.labels, result.confidence});
  }

 private:
  /// The pair at half the size.
  struct CoarsePair {
    DisparityEstimator estimator;
    SurfacePrior prior;
    cv::Mat left;
    cv::Mat right;
    MatchingVolume volume;
    StereoResult result;
  };

  bool matchesRightView() const {
    return options_.refinement.left_right_check && options_.refinement.optimize_right_view;
  }

  /// Finds the surfaces of both views by matching the pair at half the size, which in turn begins
  /// at half of that size. Pixels that fail the left-right consistency check there are invalidated,
  /// so they do not define surfaces.
  void findSurfaces(const MatchingVolume& volume) {
    const cv::Size size = left_.gray.size();
    if (!findsSurfaces(size, options_)) {
      left_.surface.release();
      right_.surface.release();
      return;
    }
    if (coarse_ == nullptr) {
      coarse_ = std::make_unique<CoarsePair>();
    }
    StereoOptions options = options_;
    options.range = halveRange(options_.range);
    options.refinement.fill_occlusions = false;
    options.refinement.fill_mismatches = false;
    halveImage(left_.gray, coarse_->left);
    halveImage(right_.gray, coarse_->right);
    halveVolume(volume, options_.range, coarse_->volume);
    coarse_->estimator.estimate(coarse_->left, coarse_->right, options, std::move(coarse_->volume),
                                coarse_->result);
    coarse_->prior.estimate(coarse_->result.disparity, options.range.invalid(),
                            options.surface.reach_px, size, left_.surface);
    if (matchesRightView()) {
      coarse_->prior.estimate(coarse_->result.right_disparity, options.range.invalid(),
                              options.surface.reach_px, size, right_.surface);
    }
  }

  void matchRightView(MatchingVolume& volume, StereoResult& result) {
    {
      const Stopwatch watch(result.times.volume_ms);
      shiftToRightView(options_.range, volume, shift_rows_);
    }
    const AggregatedVolume& costs = optimize(View::kRight, volume, result.times);
    const Stopwatch watch(result.times.refinement_ms);
    winnerTakesAll(costs, View::kRight, options_.range, result.right_disparity);
  }

  /// Cost aggregation and SGM of `volume`, which is of `view`.
  const AggregatedVolume& optimize(View view, const MatchingVolume& volume, StageTimes& times) {
    const PreparedImage& reference = view == View::kLeft ? left_ : right_;
    const PreparedImage& other = view == View::kLeft ? right_ : left_;
    const SupportArms arms = supportArmsOf(reference, other, options_.aggregation);
    const EdgeImages edges = edgeImagesOf(reference, other, options_.sgm);
    const int max_cost = sgmCostBound(options_.sgm);
    return optimizer_.optimize(
        volume, options_, times,
        [&](const auto& costs, AggregatedVolume& aggregated) {
          aggregator_.aggregate(costs, max_cost, arms, view, options_.range, aggregated);
        },
        [&](const auto& costs, AggregatedVolume& mean) {
          sgm_.match(costs, edges, reference.surface, view, options_.range, options_.sgm, mean);
        },
        [&](const auto& costs, AggregatedVolume& wide) { widen(costs, wide); });
  }

  StereoOptions options_;
  PreparedImage left_;
  PreparedImage right_;
  CostOptimizer<MatchingVolume, AggregatedVolume> optimizer_;
  cv::Mat winners_;  ///< left view, whole pixels

  std::unique_ptr<CoarsePair> coarse_;

  // Memory of the stages.
  SemiGlobalMatcher sgm_;
  CostAggregator aggregator_;
  PerThread<std::vector<std::uint8_t>> shift_rows_;
  PerThread<RightWinnersRow> right_winner_rows_;
  DisparityRefiner refiner_;
};

bool findsSurfaces(const cv::Size& image_size, const StereoOptions& options) {
  return options.surface.enabled && options.sgm.iterations > 0 &&
         std::min(image_size.width, image_size.height) >= kSmallestSidePx;
}

DisparityEstimator::DisparityEstimator() : impl_(std::make_unique<Impl>()) {}
DisparityEstimator::~DisparityEstimator() = default;

void DisparityEstimator::estimate(const cv::Mat& left, const cv::Mat& right,
                                  const StereoOptions& options, MatchingVolume&& volume,
                                  StereoResult& result) {
  impl_->estimate(left, right, options, volume, result);
}

}  // namespace cbmv
