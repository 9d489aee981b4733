#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

namespace cbmv::test {

struct Outcome {
  int status = 0;
  std::string output;  ///< standard error
};

/// Runs TOOL ARGUMENTS in a shell and returns its exit status and standard error. `environment`:
/// prefix NAME=VALUE.
inline Outcome run(const std::string& tool, const std::string& arguments,
                   const std::string& environment = "") {
  const std::string command =
      environment + " " + CBMV_TOOLS_DIR + "/" + tool + " " + arguments + " 2>&1 >/dev/null";
  FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 256> buffer{};
  while (fgets(buffer.data(), buffer.size(), pipe) != nullptr) {
    outcome.output += buffer.data();
  }
  outcome.status = WEXITSTATUS(pclose(pipe));
  return outcome;
}

/// Expects exit status 2 and `lines` lines on standard error that contain `parts`.
inline void expectRejection(const Outcome& outcome, const std::vector<std::string>& parts,
                            int lines = 1) {
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), lines)
      << outcome.output;
  for (const std::string& part : parts) {
    EXPECT_THAT(outcome.output, testing::HasSubstr(part));
  }
}

}  // namespace cbmv::test
