#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Mean errors over the scenes of one data set.
struct TunedDataSet {
  std::string title;
  std::string objective;  ///< names in kMetrics, joined by +
  std::vector<std::string> scenes;
  double before = 0;  ///< with the preset that the search began with
  double after = 0;   ///< with the preset that was found
  /// Each fold with the parameters found on the other folds; NaN: not measured.
  double cross_validated = std::numeric_limits<double>::quiet_NaN();
};

/// What was found without the scenes of one fold of Middlebury v3: the parameters to measure these
/// scenes with.
struct HeldOutFold {
  std::size_t fold = 0;  ///< in middleburyFolds
  StereoOptions options;
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
  std::vector<HeldOutFold> held_out_folds;  ///< by cross-validation
};

/// Sentences for people, in lines of at most 98 columns.
std::string describeReport(const TuningReport& report);

/// A preset of all presetParameters with the description as its comment.
std::string presetText(const TuningReport& report);

/// The preset of a fold, for cbmv_eval --folds 3.
std::string presetText(const HeldOutFold& fold);

/// PRESET_without_fold_N.yaml beside PRESET.yaml, N from 1 on.
std::string foldPresetPath(const std::string& path, std::size_t fold);

/// Writes `path`, and foldPresetPath for each fold held out. Replaces files as a whole, so that an
/// interruption leaves the old one. Throws Error naming the one that cannot be written.
void writePresets(const TuningReport& report, const std::string& path);

}  // namespace cbmv
