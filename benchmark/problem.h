#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "forest/forest.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv::benchmarks {

/// Image size and number of disparities of a pair.
struct Problem {
  int width;
  int height;
  int disparities;

  double pixels() const { return static_cast<double>(width) * height; }
  double hypotheses() const { return pixels() * disparities; }
  DisparityRange range() const { return {0, disparities}; }
  /// For example 640x480x64.
  std::string name() const;
};

/// From the smallest to the largest.
const std::vector<Problem>& problems();

/// The problem with this name. Throws Error if there is none.
Problem findProblem(const std::string& name);

struct Pair {
  cv::Mat left;
  cv::Mat right;
};

/// The pair Motorcycle of Middlebury v3, scaled to the size of the problem. A rendered pair if
/// CBMV_DATA does not name a folder that contains it.
Pair loadPair(const Problem& problem);

/// Source of the pairs of loadPair, for the output.
std::string pairSource();

/// Presets of config/, from the slowest to the fastest.
const std::vector<std::string>& presets();

/// Options of a preset over the problem's disparity range.
StereoOptions presetOptions(const std::string& preset, const Problem& problem, int threads);

/// The shipped forest for a preset (docs/performance.md).
std::shared_ptr<const Forest> presetForest(const std::string& preset);

}  // namespace cbmv::benchmarks
