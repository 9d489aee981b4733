#pragma once

#include <cstdio>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/program_files.h"
#include "tools/range_checks.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {

/// Matcher settings from the command line.
struct StereoArguments {
  std::string preset;
  std::optional<int> disparities, min_disparity, max_memory_mb, threads;
};

/// Adds an option for a parameter, with the parameter's description and default, and the range of
/// integers.
template <typename Value>
CLI::Option* addParameterOption(CLI::App& app, const std::string& option, const std::string& name,
                                Value& value) {
  const Parameter parameter = findParameter(name);
  return app.add_option(option, value,
                        describe(parameter) + "; default " + valueText(parameter.default_value));
}

/// Checks an integer against the parameter's range.
inline CLI::Validator rangeOf(const std::string& name) {
  const Parameter parameter = findParameter(name);
  return wholeNumber(static_cast<int>(parameter.lowest), static_cast<int>(parameter.highest));
}

inline void addStereoOptions(CLI::App& app, StereoArguments& arguments) {
  app.add_option("--preset", arguments.preset,
                 kPresetHelp + std::string("; the options override it"));
  CLI::Option* disparities =
      addParameterOption(app, "--disparities", "disparity_range", arguments.disparities)
          ->transform(disparityCount());
  disparities->description(disparities->get_description() + "; auto: the same as 0");
  addParameterOption(app, "--min-disparity", "min_disparity", arguments.min_disparity)
      ->check(rangeOf("min_disparity"));
  addParameterOption(app, "--max-memory-mb", "max_memory_mb", arguments.max_memory_mb)
      ->check(rangeOf("max_memory_mb"));
  app.add_option("--threads", arguments.threads,
                 "Number of threads; 0, the default: all hardware threads")
      ->check(wholeNumber(0, 1024));
}

/// Combines preset and options. Inconsistent values are corrected and reported on stderr.
inline StereoOptions readStereoOptions(const StereoArguments& arguments, const char* tool) {
  StereoOptions options;
  if (!arguments.preset.empty()) {
    readPreset(presetFile(arguments.preset), options);
  }
  options.range.count = arguments.disparities.value_or(options.range.count);
  options.range.min = arguments.min_disparity.value_or(options.range.min);
  options.max_memory_mb = arguments.max_memory_mb.value_or(options.max_memory_mb);
  options.threads = arguments.threads.value_or(options.threads);
  for (const std::string& correction : correctOptions(options)) {
    std::fprintf(stderr, "%s: %s\n", tool, correction.c_str());
  }
  return options;
}

}  // namespace cbmv
