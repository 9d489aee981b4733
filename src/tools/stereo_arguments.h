#pragma once

#include <cstdio>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/program_files.h"
#include "tools/range_checks.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {

/// What a user asks of the matcher on the command line.
struct StereoArguments {
  std::string preset;
  std::optional<int> disparities, min_disparity, max_memory_mb, threads;
};

inline void addStereoOptions(CLI::App& app, StereoArguments& arguments) {
  app.add_option("--preset", arguments.preset,
                 kPresetHelp + std::string("; the options win over it"));
  app.add_option("--disparities", arguments.disparities,
                 "Number of disparities, px; auto: found in each pair; default 64")
      ->transform(disparityCount());
  app.add_option("--min-disparity", arguments.min_disparity, "Lowest disparity, px; default 0")
      ->check(wholeNumber(-2048, 2048));
  app.add_option("--max-memory-mb", arguments.max_memory_mb,
                 "Refuse images for which the matcher needs more; 0, the default: no bound")
      ->check(wholeNumber(0, 100000));
  app.add_option("--threads", arguments.threads, "0, the default: as many as the machine has")
      ->check(wholeNumber(0, 1024));
}

/// Preset and options, mended where they are inconsistent, which is said on stderr.
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
