#include "cbmv_stereo/stereo_matcher.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "base/stopwatch.h"
#include "base/thread_limit.h"
#include "forest/forest_evaluator.h"
#include "pipeline/disparity_estimator.h"
#include "pipeline/memory.h"
#include "pipeline/pyramid_matcher.h"
#include "refinement/speckle_filter.h"
#include "search/range_source.h"
#include "selection/map_selector.h"
#include "volume/volume_builder.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

void requireConsistent(const StereoOptions& options) {
  StereoOptions corrected = options;
  const std::vector<std::string> corrections = correctOptions(corrected);
  if (!corrections.empty()) {
    throw Error("options: " + corrections.front());
  }
}

void requirePair(const cv::Mat& left, const cv::Mat& right) {
  if (left.empty() || right.empty()) {
    throw Error(std::string("the ") + (left.empty() ? "left" : "right") +
                " image is empty, expected at least 1x1 pixels. Check the input");
  }
  if (left.type() != CV_8UC1 || right.type() != CV_8UC1) {
    throw Error("the images have the types " + cv::typeToString(left.type()) + " and " +
                cv::typeToString(right.type()) +
                ", expected gray with 8 bits per pixel (CV_8UC1). Convert them");
  }
  if (left.size() != right.size()) {
    const auto text = [](const cv::Size& size) {
      return std::to_string(size.width) + "x" + std::to_string(size.height);
    };
    throw Error("the left image has " + text(left.size()) + " pixels, the right image " +
                text(right.size()) + ", expected equal sizes. Use a rectified pair");
  }
}

/// Sets `map` to `value` where there is no disparity.
void setWhereInvalid(const StereoResult& result, float value, cv::Mat& map) {
  const float invalid = result.range.invalid();
  for (int y = 0; y < map.rows; ++y) {
    const auto* disparity = result.disparity.ptr<float>(y);
    auto* values = map.ptr<float>(y);
    std::transform(disparity, disparity + map.cols, values, values,
                   [=](float d, float old) { return d == invalid ? value : old; });
  }
}

void requireMemory(const cv::Size& size, const StereoOptions& options) {
  const std::string error = memoryError(size, options);
  if (!error.empty()) {
    throw Error(error);
  }
}

}  // namespace

class StereoMatcher::Impl {
 public:
  Impl(std::shared_ptr<const Forest> forest, const StereoOptions& options)
      : forest_(std::move(forest)), evaluator_(*forest_) {
    if (forest_->confidence != nullptr) {
      selector_ = std::make_unique<MapSelector>(forest_);
    }
    setOptions(options);
  }

  const StereoOptions& options() const { return options_; }

  void setOptions(const StereoOptions& options) {
    requireConsistent(options);
    options_ = options;
    checked_size_.reset();
    threads_.set(options.threads);
  }

  void match(const cv::Mat& left, const cv::Mat& right, const VerticalOffset* offset,
             StereoResult& result) {
    requirePair(left, right);
    result.times = {};
    result.rectification = {};
    threads_.run([&] { run(left, right, offset, result); });
  }

 private:
  void run(const cv::Mat& left, const cv::Mat& right, const VerticalOffset* offset,
           StereoResult& result) {
    const Stopwatch total(result.times.total_ms);
    const StereoOptions options = optionsOf(left, right);
    const cv::Mat aligned = alignPair(left, right, options, offset, result);
    matchAligned(left, aligned, options, result);
    judge(options, result);
    if (options.refinement.speckle_size_px > 0) {
      const Stopwatch watch(result.times.refinement_ms);
      removeSpeckles(result.range, options.refinement.speckle_size_px,
                     options.refinement.speckle_range_px, speckle_buffers_, result.disparity);
      setWhereInvalid(result, 0, result.confidence);
      setWhereInvalid(result, std::numeric_limits<float>::quiet_NaN(), result.disparity_sigma);
    }
  }

  void matchAligned(const cv::Mat& left, const cv::Mat& aligned, const StereoOptions& options,
                    StereoResult& result) {
    if (searchLevels(left.size(), options) > 0) {
      pyramid_.match(left, aligned, options, *forest_, evaluator_, result);
      return;
    }
    {
      const Stopwatch watch(result.times.volume_ms);
      builder_.build(left, aligned, options.range, *forest_, evaluator_, volume_);
    }
    estimator_.estimate(left, aligned, options, std::move(volume_), result);
    result.memory_mb = requiredMemoryMb(left.size(), options);
  }

  /// Applies the second forest if there is one.
  void judge(const StereoOptions& options, StereoResult& result) {
    if (selector_ == nullptr || !options.refinement.second_forest) {
      result.disparity_sigma.release();
      return;
    }
    const Stopwatch watch(result.times.selection_ms);
    const RefinementOptions& refinement = options.refinement;
    selector_->select(
        {result.disparity, result.right_disparity, result.labels, result.confidence, result.margin,
         result.range},
        {refinement.replace_improbable, refinement.fill_occlusions && refinement.fill_mismatches,
         refinement.confidence_scale, refinement.confidence_shift, refinement.sigma_scale},
        {result.disparity, result.confidence, result.disparity_sigma});
  }

  /// The options for this pair, with its range. Throws Error if they need too much memory.
  StereoOptions optionsOf(const cv::Mat& left, const cv::Mat& right) {
    StereoOptions options = options_;
    if (options.range.isAutomatic()) {
      options.range = own_range_.rangeOf({left, right}, options.range.min);
    }
    if (checked_size_ != left.size() || options_.range.isAutomatic()) {
      requireMemory(left.size(), options);
      checked_size_ = left.size();
    }
    return options;
  }

  cv::Mat alignPair(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options,
                    const VerticalOffset* offset, StereoResult& result) {
    const Stopwatch watch(result.times.rectification_ms);
    if (!options.rectification.enabled) {
      return right;
    }
    result.rectification = offset != nullptr ? *offset
                                             : estimateVerticalOffset(left, right, options.range,
                                                                      options.rectification);
    return alignRightRows(right, result.rectification, aligned_);
  }

  std::shared_ptr<const Forest> forest_;
  ForestEvaluator evaluator_;
  StereoOptions options_;
  std::optional<cv::Size> checked_size_;  ///< image size that passed the memory check
  ThreadLimit threads_;
  OwnRange own_range_;
  cv::Mat aligned_;
  VolumeBuilder builder_;
  MatchingVolume volume_;
  DisparityEstimator estimator_;
  PyramidMatcher pyramid_;
  SpeckleBuffers speckle_buffers_;
  std::unique_ptr<MapSelector> selector_;  ///< null: the forest file has no second forest
};

StereoMatcher::StereoMatcher(std::shared_ptr<const Forest> forest, const StereoOptions& options)
    : impl_(std::make_unique<Impl>(std::move(forest), options)) {}
StereoMatcher::~StereoMatcher() = default;

const StereoOptions& StereoMatcher::options() const { return impl_->options(); }

void StereoMatcher::setOptions(const StereoOptions& options) { impl_->setOptions(options); }

StereoResult StereoMatcher::match(const cv::Mat& left, const cv::Mat& right) {
  StereoResult result;
  impl_->match(left, right, nullptr, result);
  return result;
}

StereoResult StereoMatcher::match(const cv::Mat& left, const cv::Mat& right,
                                  const VerticalOffset& offset) {
  StereoResult result;
  match(left, right, offset, result);
  return result;
}

void StereoMatcher::match(const cv::Mat& left, const cv::Mat& right, const VerticalOffset& offset,
                          StereoResult& result) {
  impl_->match(left, right, &offset, result);
}

}  // namespace cbmv
