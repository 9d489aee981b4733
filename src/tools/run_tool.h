#pragma once

#include <exception>
#include <iostream>

namespace cbmv {

/// Runs a tool's body: prints an exception as one line on stderr and returns exit status 2.
template <typename Body>
int runTool(const char* name, Body body) {
  try {
    body();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << std::endl;
    return 2;
  }
}

}  // namespace cbmv
