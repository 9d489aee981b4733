#include "pipeline/memory.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "base/search_space.h"
#include "matching/matcher_set.h"
#include "optimization/cross_based_aggregation.h"
#include "optimization/edge_maps.h"
#include "optimization/prepared_image.h"
#include "optimization/semi_global_matching.h"
#include "pipeline/disparity_estimator.h"
#include "pipeline/pyramid_matcher.h"
#include "rectification/sparse_matches.h"
#include "refinement/disparity_refiner.h"
#include "refinement/speckle_filter.h"
#include "search/mutual_matches.h"
#include "selection/map_selector.h"
#include "volume/volume_builder.h"

namespace cbmv {
namespace {

/// A pair size with its options. Sizes are floating point, because their products can overflow
/// integers.
struct Problem {
  Problem(const cv::Size& image_size, const StereoOptions& all_options)
      : options(all_options),
        width(image_size.width),
        pixels(width * image_size.height),
        disparities(all_options.range.count),
        threads(all_options.threads > 0 ? all_options.threads
                                        : std::thread::hardware_concurrency()) {}

  bool aggregates() const {
    return options.aggregation.iterations_before + options.aggregation.iterations_after > 0;
  }
  bool matchesRightView() const {
    return options.refinement.left_right_check && options.refinement.optimize_right_view;
  }

  /// The pair at half the size.
  Problem half() const {
    Problem result = *this;
    result.width /= 2;
    result.pixels /= 4;
    result.disparities /= 2;
    result.options.refinement.speckle_size_px = 0;
    result.options.refinement.second_forest = false;
    return result;
  }

  StereoOptions options;
  double width;
  double pixels;
  double disparities;
  double threads;
};

double ifSet(bool set, double bytes) { return set ? bytes : 0; }

double bytesOfHypothesis(const StereoOptions& options) {
  const int steps = options.aggregation.iterations_before + options.sgm.iterations +
                    options.aggregation.iterations_after;
  return 1 + 2 * std::clamp(steps, 1, 2);
}

double bytesOfVolumes(const Problem& problem) {
  return problem.pixels * problem.disparities * bytesOfHypothesis(problem.options);
}

/// Maps of the rectification correction (with the corrected image) and of the matchers.
double bytesOfMatchingMaps(const Problem& problem) {
  const double correction =
      ifSet(problem.options.rectification.enabled, 1 + kMeasurementBytesPerPixel);
  return problem.pixels * (correction + MatcherSet::kBytesPerPixel);
}

/// Maps of cost aggregation, SGM and refinement.
double bytesOfEstimationMaps(const Problem& problem) {
  const StereoOptions& options = problem.options;
  const double edges = ifSet(options.sgm.iterations > 0, 2 * EdgeMaps::kBytesPerPixel);
  const double arms = ifSet(problem.aggregates(),
                            2 * PreparedImage::kBytesPerPixel +
                                CostAggregator::bytesPerPixel(problem.width, problem.disparities));
  const double winners = sizeof(float);
  const double refinement =
      DisparityRefiner::bytesPerPixel(options.refinement) +
      ifSet(options.refinement.speckle_size_px > 0, SpeckleBuffers::kBytesPerPixel);
  // Disparity, confidence, labels, margin; disparities of the right view.
  const double result = 4 + 4 + 1 + 2 + ifSet(options.refinement.left_right_check, 4);
  return problem.pixels * (edges + arms + winners + refinement + result);
}

double bytesOfSelection(const Problem& problem) {
  const RefinementOptions& options = problem.options.refinement;
  return ifSet(options.second_forest,
               MapSelector::memoryBytes(problem.pixels, problem.width, problem.threads,
                                        options.replace_improbable));
}

double bytesOfRows(const Problem& problem) {
  return problem.threads * VolumeBuilder::bytesPerThread(problem.width, problem.disparities,
                                                         problem.matchesRightView());
}

double bytesOfPaths(const Problem& problem) {
  return ifSet(problem.options.sgm.iterations > 0,
               SemiGlobalMatcher::bytesOfPaths(problem.width, problem.disparities));
}

double bytesOfSums(const Problem& problem) {
  const int longest_arm_px = problem.options.aggregation.arm_length_px - 1;
  return ifSet(problem.aggregates(),
               problem.threads * CostAggregator::bytesPerThread(problem.width, problem.disparities,
                                                                longest_arm_px));
}

/// Both views of a level of a search: volumes and lists. Lists may have twice the capacity that
/// they need.
double bytesOfLists(const Problem& problem, double hypotheses) {
  const double right = ifSet(problem.matchesRightView(), 1);
  const double lists = (1 + right) * 2 * sizeof(std::int16_t) / kTileColumns;
  return hypotheses * (bytesOfHypothesis(problem.options) + right + lists);
}

/// Mutual matches and windows, SGM steps, and the coarser level.
double bytesOfSearchMaps(const Problem& problem) {
  const double matches = MutualMatcher::kBytesPerPixel;
  const double windows = 1.5 * problem.disparities / 8 / kTileColumns;
  const double steps = 2 * (1 + problem.disparities / problem.width);
  const double surfaces = ifSet(problem.options.surface.enabled, 2 + 2 + 2 + 4.0 / 4);
  const double half_pair = 2.0 / 4;
  return problem.pixels * (matches + windows + steps + surfaces + half_pair);
}

double bytesOfScan(const Problem& problem) {
  return problem.threads * MutualMatcher::bytesPerThread(problem.width, problem.disparities);
}

double bytesOfLevel(const Problem& problem, double hypotheses) {
  return bytesOfLists(problem, hypotheses) + bytesOfMatchingMaps(problem) +
         bytesOfEstimationMaps(problem) + bytesOfSearchMaps(problem) + bytesOfRows(problem) +
         bytesOfScan(problem) + bytesOfPaths(problem) + bytesOfSums(problem) +
         bytesOfSelection(problem);
}

/// Cost aggregation, SGM and refinement.
double bytesOfEstimation(const Problem& problem) {
  return bytesOfVolumes(problem) + bytesOfEstimationMaps(problem) + bytesOfPaths(problem) +
         bytesOfSums(problem);
}

/// Finding the surfaces of a pair at half the size, a quarter and so on.
double bytesOfSurfaces(const cv::Size& image_size, const Problem& problem) {
  if (!findsSurfaces(image_size, problem.options)) {
    return 0;
  }
  const double surfaces = 2 + 2 + ifSet(problem.matchesRightView(), 2);  // one with a border
  const Problem half = problem.half();
  return problem.pixels * surfaces + half.pixels * 2 + bytesOfEstimation(half) +
         bytesOfSurfaces(image_size / 2, half);
}

std::string memoryErrorOf(double required_mb, const cv::Size& image_size,
                          const StereoOptions& options) {
  if (options.max_memory_mb == 0 || required_mb <= options.max_memory_mb) {
    return {};
  }
  return "images of " + std::to_string(image_size.width) + "x" + std::to_string(image_size.height) +
         " pixels with " + std::to_string(options.range.count) + " disparities need " +
         std::to_string(std::lround(std::ceil(required_mb))) + " MB, but max_memory_mb allows " +
         std::to_string(options.max_memory_mb) +
         ". Lower disparity_range, use smaller images or increase max_memory_mb";
}

}  // namespace

std::vector<double> expectedHypotheses(const cv::Size& image_size, const StereoOptions& options) {
  const int levels = searchLevels(image_size, options);
  const int longer = 2 * (options.search.margin_px - SearchOptions().margin_px);
  const double listed = kListedDisparities + std::max(0, longer);
  std::vector<double> hypotheses;
  Problem problem(image_size, options);
  for (int level = 0; level < levels; ++level, problem = problem.half()) {
    hypotheses.push_back(problem.pixels * std::min(listed, problem.disparities));
  }
  hypotheses.push_back(problem.pixels * problem.disparities);
  return hypotheses;
}

double searchMemoryMb(const cv::Size& image_size, const StereoOptions& options,
                      const std::vector<double>& hypotheses) {
  double bytes = 0;
  Problem problem(image_size, options);
  for (const double of_level : hypotheses) {
    bytes += bytesOfLevel(problem, of_level);
    problem = problem.half();
    problem.options.refinement.optimize_right_view = true;
  }
  return bytes / (1 << 20);
}

double requiredMemoryMb(const cv::Size& image_size, const StereoOptions& options) {
  if (searchLevels(image_size, options) > 0) {
    return searchMemoryMb(image_size, options, expectedHypotheses(image_size, options));
  }
  const Problem problem(image_size, options);
  return (bytesOfMatchingMaps(problem) + bytesOfRows(problem) + bytesOfEstimation(problem) +
          bytesOfSurfaces(image_size, problem) + bytesOfSelection(problem)) /
         (1 << 20);
}

std::string memoryError(const cv::Size& image_size, const StereoOptions& options) {
  return memoryErrorOf(requiredMemoryMb(image_size, options), image_size, options);
}

std::string searchMemoryError(const cv::Size& image_size, const StereoOptions& options,
                              const std::vector<double>& hypotheses) {
  return memoryErrorOf(searchMemoryMb(image_size, options, hypotheses), image_size, options);
}

}  // namespace cbmv
