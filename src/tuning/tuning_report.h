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
  double before = 0;  ///< with the preset at the start
  double after = 0;   ///< with the preset found
  /// Each fold with the parameters found on the other folds; NaN: not measured.
  double cross_validated = std::numeric_limits<double>::quiet_NaN();
};

/// The parameters found without one fold of Middlebury v3. Use them to evaluate the scenes of this
/// fold.
struct HeldOutFold {
  std::size_t fold = 0;  ///< in middleburyFolds
  StereoOptions options;
};

/// Result and inputs of a search.
struct TuningReport {
  std::string start;  ///< display name of the preset at the start
  std::vector<std::string> parameters;
  std::vector<std::string> forests;
  int evaluations = 0;
  int rows = 0;  ///< rows used per scene, from the middle; 0: all
  std::vector<TunedDataSet> data_sets;
  StereoOptions options;
  std::vector<HeldOutFold> held_out_folds;  ///< from cross-validation
};

/// Text description, in lines of at most 98 columns.
std::string describeReport(const TuningReport& report);

/// A preset with all presetParameters and the description as its comment.
std::string presetText(const TuningReport& report);

/// The preset of a fold, for cbmv_eval --folds 3.
std::string presetText(const HeldOutFold& fold);

/// PRESET_without_fold_N.yaml beside PRESET.yaml, N from 1.
std::string foldPresetPath(const std::string& path, std::size_t fold);

/// Writes `path`, and foldPresetPath for each held-out fold. Replaces each file atomically. Throws
/// Error with the file that cannot be written.
void writePresets(const TuningReport& report, const std::string& path);

}  // namespace cbmv
