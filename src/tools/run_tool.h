#pragma once

#include <cstdio>
#include <exception>
#include <string>

#include <CLI/CLI.hpp>

#include "pipeline/machine_memory.h"

namespace cbmv {

/// Exit status of a tool that refuses.
inline constexpr int kBadInput = 2;

/// Parses the command line and runs a tool's body: what main returns. 0 where all is well or only
/// help or the version was asked for; 2 for a wrong command line, which CLI11 explains, and for an
/// exception of the body, which becomes one line on stderr that begins with the tool's name.
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

/// To stdout at once, also where it is no terminal.
inline void printLine(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

}  // namespace cbmv
