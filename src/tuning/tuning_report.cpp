#include "tuning/tuning_report.h"

#include <cmath>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "io/binary_file.h"
#include "tuning/parameter_space.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

constexpr std::size_t kColumns = 98;  // without the leading "# "

std::string join(const std::vector<std::string>& texts) {
  std::string joined;
  for (const std::string& text : texts) {
    joined += (joined.empty() ? "" : ", ") + text;
  }
  return joined;
}

std::string wrap(const std::string& paragraph) {
  std::istringstream words(paragraph);
  std::string wrapped;
  std::size_t column = 0;
  for (std::string word; words >> word;) {
    const bool fits = column > 0 && column + 1 + word.size() <= kColumns;
    if (column > 0) {
      wrapped += fits ? ' ' : '\n';
    }
    column = (fits ? column + 1 : 0) + word.size();
    wrapped += word;
  }
  return wrapped + "\n";
}

std::string describe(const TunedDataSet& data_set) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << data_set.title << ", " << data_set.objective << ": "
       << data_set.before << " before, " << data_set.after << " after";
  if (!std::isnan(data_set.cross_validated)) {
    text << ", " << data_set.cross_validated
         << " when each fold has the parameters found on the others";
  }
  text << ". Scenes: " << join(data_set.scenes) << ".";
  return wrap(text.str());
}

std::string presetLines(const std::string& comment, const StereoOptions& options) {
  std::istringstream lines(comment + "Names, units and ranges: docs/parameters.md.\n");
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    text += "# " + line + "\n";
  }
  for (const Parameter& parameter : presetParameters()) {
    text += parameter.name + ": " + valueText(parameter.get(options)) + "\n";
  }
  return text;
}

}  // namespace

std::string describeReport(const TuningReport& report) {
  std::string text =
      wrap("cbmv_tune " CBMV_VERSION " found this from " + report.start + " in " +
           std::to_string(report.evaluations) + " evaluations of " + join(report.parameters) + ".");
  text += wrap("Mean errors over non-occluded pixels" +
               (report.rows > 0
                    ? " of the middle " + std::to_string(report.rows) + " rows of each scene"
                    : std::string()) +
               ", volumes by forests that had not seen the scene (" + join(report.forests) + "):");
  for (const TunedDataSet& data_set : report.data_sets) {
    text += describe(data_set);
  }
  return text;
}

std::string presetText(const TuningReport& report) {
  return presetLines(describeReport(report), report.options);
}

std::string presetText(const HeldOutFold& fold) {
  return presetLines(wrap("cbmv_tune " CBMV_VERSION " found this without the scenes of fold " +
                          std::to_string(fold.fold + 1) + " of Middlebury v3."),
                     fold.options);
}

std::string foldPresetPath(const std::string& path, std::size_t fold) {
  const std::filesystem::path preset(path);
  const std::string name = preset.stem().string() + "_without_fold_" + std::to_string(fold + 1) +
                           preset.extension().string();
  return (preset.parent_path() / name).string();
}

void writePresets(const TuningReport& report, const std::string& path) {
  replaceFile(path, presetText(report));
  for (const HeldOutFold& fold : report.held_out_folds) {
    replaceFile(foldPresetPath(path, fold.fold), presetText(fold));
  }
}

}  // namespace cbmv
