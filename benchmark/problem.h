#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "forest/forest.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv::benchmarks {

/// How large a pair is.
struct Problem {
  int width;
  int height;
  int disparities;

  double pixels() const { return static_cast<double>(width) * height; }
  double hypotheses() const { return pixels() * disparities; }
  DisparityRange range() const { return {0, disparities}; }
  /// As 640x480x64.
  std::string name() const;
};

/// From the smallest to the largest.
const std::vector<Problem>& problems();

/// The problem of that name. Throws Error if there is none.
Problem findProblem(const std::string& name);

struct Pair {
  cv::Mat left;
  cv::Mat right;
};

/// The pair Motorcycle of Middlebury v3 scaled to the size of the problem; a rendered one where
/// CBMV_DATA does not name a folder that holds it.
Pair loadPair(const Problem& problem);

/// Where loadPair takes its pairs from, for people.
std::string pairSource();

/// Presets of config/, from the slowest to the fastest.
const std::vector<std::string>& presets();

/// Options of a preset over the problem's range.
StereoOptions presetOptions(const std::string& preset, const Problem& problem, int threads);

/// The shipped forest that goes with a preset (docs/performance.md).
std::shared_ptr<const Forest> presetForest(const std::string& preset);

}  // namespace cbmv::benchmarks
