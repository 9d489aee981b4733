#include "cbmv_stereo/pipeline/stereo_matcher.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/forest/forest_evaluator.h"
#include "cbmv_stereo/optimization/cross_based_aggregation.h"
#include "cbmv_stereo/optimization/semi_global_matching.h"
#include "cbmv_stereo/optimization/support_arms.h"
#include "cbmv_stereo/optimization/winner_takes_all.h"
#include "cbmv_stereo/pipeline/parameters.h"
#include "cbmv_stereo/refinement/bilateral_filter.h"
#include "cbmv_stereo/refinement/interpolation.h"
#include "cbmv_stereo/refinement/median_filter.h"
#include "cbmv_stereo/refinement/subpixel.h"
#include "cbmv_stereo/volume/volume_builder.h"

namespace cbmv {
namespace {

/// Adds the time from its construction to its destruction.
class Stopwatch {
 public:
  explicit Stopwatch(double& total_ms) : total_ms_(total_ms) {}
  ~Stopwatch() {
    total_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& total_ms_;
  Clock::time_point start_ = Clock::now();
};

void requireConsistent(const StereoOptions& options) {
  StereoOptions corrected = options;
  const std::vector<std::string> mends = correctOptions(corrected);
  if (!mends.empty()) {
    throw Error("options: " + mends.front());
  }
}

void requirePair(const cv::Mat& left, const cv::Mat& right) {
  if (left.empty() || right.empty()) {
    throw Error(std::string("the ") + (left.empty() ? "left" : "right") + " image is empty");
  }
  if (left.type() != CV_8UC1 || right.type() != CV_8UC1) {
    throw Error("the images must be grey with 8 bits a pixel");
  }
  if (left.size() != right.size()) {
    const auto text = [](const cv::Size& size) {
      return std::to_string(size.width) + "x" + std::to_string(size.height);
    };
    throw Error("the left image has " + text(left.size()) + " pixels, the right one " +
                text(right.size()) + "; a rectified pair has one size");
  }
}

float standardDeviation(const cv::Mat& grey) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(grey, mean, deviation);
  return static_cast<float>(deviation[0]);
}

void widen(const MatchingVolume& volume, OptimizedVolume& costs) {
  costs.resize(volume.height(), volume.width(), volume.disparities());
  tbb::parallel_for(0, volume.height(), [&](int y) {
    std::copy_n(volume.row(y), static_cast<std::size_t>(volume.width()) * volume.disparities(),
                costs.row(y));
  });
}

/// Probability of the winner of each pixel; 0 where there is none.
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

class StereoMatcher::Impl {
 public:
  Impl(std::shared_ptr<const Forest> forest, const StereoOptions& options)
      : forest_(std::move(forest)), evaluator_(*forest_) {
    setOptions(options);
  }

  const StereoOptions& options() const { return options_; }

  void setOptions(const StereoOptions& options) {
    requireConsistent(options);
    options_ = options;
    arena_ = std::make_unique<tbb::task_arena>(
        options.threads > 0 ? options.threads : static_cast<int>(tbb::task_arena::automatic));
  }

  StereoResult match(const cv::Mat& left, const cv::Mat& right, const VerticalOffset* offset) {
    requirePair(left, right);
    StereoResult result;
    arena_->execute([&] { run(left, right, offset, result); });
    return result;
  }

 private:
  /// One of the images with what aggregation and semi-global matching need of it.
  struct PreparedImage {
    cv::Mat grey;
    cv::Mat arms;
    float deviation = 0;
  };

  void run(const cv::Mat& left, const cv::Mat& right, const VerticalOffset* offset,
           StereoResult& result) {
    const Stopwatch total(result.times.total_ms);
    result.range = options_.range;
    const cv::Mat aligned = alignPair(left, right, offset, result);
    {
      const Stopwatch watch(result.times.volume_ms);
      builder_.build(left, aligned, options_.range, *forest_, evaluator_, volume_);
    }
    {
      const Stopwatch watch(result.times.aggregation_ms);
      prepare(left, left_);
      prepare(aligned, right_);
    }
    optimize(View::kLeft, result.times);
    cv::Mat winners;
    {
      const Stopwatch watch(result.times.refinement_ms);
      winnerTakesAll(*optimized_, View::kLeft, options_.range, winners);
      readConfidence(volume_, winners, options_.range, result.confidence);
      result.disparity = winners.clone();
      if (options_.refinement.subpixel) {
        refineSubpixel(*optimized_, View::kLeft, options_.range, result.disparity);
      }
    }
    if (options_.refinement.left_right_check) {
      matchRightView(result);
    }
    const Stopwatch watch(result.times.refinement_ms);
    refine(winners, result);
  }

  void matchRightView(StereoResult& result) {
    {
      const Stopwatch watch(result.times.volume_ms);
      shiftToRightView(options_.range, volume_);
    }
    optimize(View::kRight, result.times);
    const Stopwatch watch(result.times.refinement_ms);
    winnerTakesAll(*optimized_, View::kRight, options_.range, result.right_disparity);
  }

  cv::Mat alignPair(const cv::Mat& left, const cv::Mat& right, const VerticalOffset* offset,
                    StereoResult& result) const {
    const Stopwatch watch(result.times.rectification_ms);
    if (!options_.rectification.enabled) {
      return right;
    }
    result.rectification = offset != nullptr ? *offset
                                             : estimateVerticalOffset(left, right, options_.range,
                                                                      options_.rectification);
    return alignRightRows(right, result.rectification);
  }

  void prepare(const cv::Mat& grey, PreparedImage& image) const {
    image.grey = grey;
    image.deviation = standardDeviation(grey);
    computeSupportArms(grey, options_.aggregation.arm_length_px,
                       options_.aggregation.intensity_threshold * image.deviation, image.arms);
  }

  /// Aggregation, semi-global matching and aggregation again of `volume_`, which is of `view`.
  /// Leaves the costs in *optimized_.
  void optimize(View view, StageTimes& times) {
    const PreparedImage& reference = view == View::kLeft ? left_ : right_;
    const PreparedImage& other = view == View::kLeft ? right_ : left_;
    is_matching_cost_ = true;
    aggregate(options_.aggregation.iterations_before, view, reference, other, times);
    const EdgeImages edges{reference.grey, other.grey,
                           options_.sgm.edge_threshold * reference.deviation,
                           options_.sgm.edge_threshold * other.deviation};
    for (int i = 0; i < options_.sgm.iterations; ++i) {
      const Stopwatch watch(times.sgm_ms);
      apply([&](const auto& costs, OptimizedVolume& mean) {
        semiGlobalMatching(costs, edges, view, options_.range, options_.sgm, mean);
      });
    }
    aggregate(options_.aggregation.iterations_after, view, reference, other, times);
    if (is_matching_cost_) {
      widen(volume_, *optimized_);
    }
  }

  void aggregate(int iterations, View view, const PreparedImage& reference,
                 const PreparedImage& other, StageTimes& times) {
    const Stopwatch watch(times.aggregation_ms);
    const int max_cost = sgmCostBound(options_.sgm);
    for (int i = 0; i < iterations; ++i) {
      apply([&](const auto& costs, OptimizedVolume& aggregated) {
        aggregateCosts(costs, max_cost, reference.arms, other.arms, view, options_.range,
                       aggregated);
      });
    }
  }

  /// Replaces the costs by what a stage makes of them. The first stage reads the matching costs.
  template <typename Stage>
  void apply(const Stage& stage) {
    if (is_matching_cost_) {
      stage(volume_, *spare_);
    } else {
      stage(*optimized_, *spare_);
    }
    is_matching_cost_ = false;
    std::swap(optimized_, spare_);
  }

  /// Check, filling and filters. The filled pixels take sub-pixel disparities from their
  /// neighbours.
  void refine(const cv::Mat& winners, StereoResult& result) {
    const RefinementOptions& options = options_.refinement;
    const DisparityRange& range = options_.range;
    result.labels = cv::Mat(winners.size(), CV_8UC1, cv::Scalar(kMatch));
    if (options.left_right_check) {
      leftRightCheck(winners, result.right_disparity, range, options.max_left_right_difference_px,
                     result.labels);
      replaceUnmatched(result);
    }
    cv::Mat filtered;
    medianFilter(result.disparity, range, options.median_size_px, filtered);
    bilateralFilter(filtered, range, options.bilateral_sigma_px, options.bilateral_threshold_px,
                    result.disparity);
  }

  void replaceUnmatched(StereoResult& result) const {
    const RefinementOptions& options = options_.refinement;
    const cv::Mat failed = result.labels != kMatch;
    cv::Mat halved = 0.5 * result.confidence;
    halved.copyTo(result.confidence, failed);
    result.disparity.setTo(options_.range.invalid(), failed);
    if (options.fill_occlusions) {
      fillOcclusions(result.labels, options_.range, result.disparity);
    }
    if (options.fill_mismatches) {
      fillMismatches(result.labels, options_.range, result.disparity);
    }
  }

  std::shared_ptr<const Forest> forest_;
  ForestEvaluator evaluator_;
  StereoOptions options_;
  std::unique_ptr<tbb::task_arena> arena_;
  VolumeBuilder builder_;
  PreparedImage left_;
  PreparedImage right_;
  MatchingVolume volume_;
  OptimizedVolume first_;
  OptimizedVolume second_;
  OptimizedVolume* optimized_ = &first_;
  OptimizedVolume* spare_ = &second_;
  bool is_matching_cost_ = true;  // the costs are still those of volume_
};

StereoMatcher::StereoMatcher(std::shared_ptr<const Forest> forest, const StereoOptions& options)
    : impl_(std::make_unique<Impl>(std::move(forest), options)) {}
StereoMatcher::~StereoMatcher() = default;

const StereoOptions& StereoMatcher::options() const { return impl_->options(); }

void StereoMatcher::setOptions(const StereoOptions& options) { impl_->setOptions(options); }

StereoResult StereoMatcher::match(const cv::Mat& left, const cv::Mat& right) {
  return impl_->match(left, right, nullptr);
}

StereoResult StereoMatcher::match(const cv::Mat& left, const cv::Mat& right,
                                  const VerticalOffset& offset) {
  return impl_->match(left, right, &offset);
}

}  // namespace cbmv
