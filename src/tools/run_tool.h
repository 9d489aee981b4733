#pragma once

#include <cstdio>
#include <exception>
#include <string>

#include <CLI/CLI.hpp>

#include "pipeline/machine_memory.h"

namespace cbmv {

/// Exit status for invalid input.
inline constexpr int kBadInput = 2;

/// Parses the command line and runs `body`. Returns the exit status: 0 on success, help or version;
/// 2 for an invalid command line, which CLI11 explains, or if the body throws. The exception is
/// printed as one line on stderr, starting with the tool's name.
template <typename Body>
int runTool(CLI::App& app, int argc, char** argv, const char* name, const Body& body) {
  app.set_version_flag("--version", std::string(name) + " " CBMV_VERSION,
                       "Print the version and exit");
  try {
    app.parse(argc, argv);
    body();
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, describeFailure(error).c_str());
    return kBadInput;
  }
}

/// Prints to stdout and flushes, also if stdout is not a terminal.
inline void printLine(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

}  // namespace cbmv
