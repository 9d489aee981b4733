#pragma once

#include <limits>
#include <string>
#include <vector>

#include "cbmv_stereo/pipeline/options.h"

namespace cbmv {

/// Mean errors over the scenes of one data set.
struct TunedDataSet {
  std::string title;
  std::string metric;  ///< name in kMetrics
  std::vector<std::string> scenes;
  double before = 0;  ///< with the preset that the search began with
  double after = 0;   ///< with the preset that was found
  /// Each fold with the parameters found on the other folds; NaN: not measured.
  double cross_validated = std::numeric_limits<double>::quiet_NaN();
};

/// What a search found, and from what.
struct TuningReport {
  std::string start;  ///< for people: the preset that the search began with
  std::vector<std::string> parameters;
  std::vector<std::string> forests;
  int evaluations = 0;
  int rows = 0;  ///< of each scene, from its middle; 0: all
  std::vector<TunedDataSet> data_sets;
  StereoOptions options;
};

/// Sentences for people, in lines of at most 98 columns.
std::string describeReport(const TuningReport& report);

/// A preset of all presetParameters with the description as its comment.
std::string presetText(const TuningReport& report);

/// Replaces the file as a whole, so that an interruption leaves the old one. Throws Error naming it
/// when it cannot be written.
void writePreset(const TuningReport& report, const std::string& path);

}  // namespace cbmv
