#include "evaluation/evaluation_page.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

struct Outcome {
  bool succeeded = false;
  std::string errors;  ///< standard error of the program
};

[[noreturn]] void failToRun(const std::string& program, int error) {
  const bool is_there = std::filesystem::exists(program);
  throw Error("Cannot run " + program + ": " +
              (error == ENOENT && is_there
                   ? "Python is missing. Install the packages python3 and python3-matplotlib"
               : error == ENOENT ? "no such file, expected beside the tools. Install it there"
                                 : std::strerror(error)) +
              ".");
}

std::string readAll(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t count = 1; count != 0;) {
    count = read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno != EINTR) {
      break;
    }
    text.append(buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  }
  return text;
}

/// Runs the program without a shell. The first word is its path.
Outcome runProgram(std::vector<std::string> words) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    failToRun(words[0], errno);
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addclose(&actions, ends[1]);
  pid_t child = 0;
  const int error = posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  Outcome outcome;
  outcome.errors = error == 0 ? readAll(ends[0]) : "";
  close(ends[0]);
  if (error != 0) {
    failToRun(words[0], error);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  outcome.succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return outcome;
}

/// The last line of a Python traceback is the error message.
std::string lastLine(std::string text) {
  text.erase(text.find_last_not_of(" \n") + 1);
  return text.empty() ? "the program that makes it was stopped" : text.substr(text.rfind('\n') + 1);
}

}  // namespace

void writeEvaluationPage(const std::string& program, const std::string& json,
                         const std::string& maps, const std::string& page) {
  const Outcome outcome = runProgram({program, json, "--maps", maps, "--output", page});
  if (!outcome.succeeded) {
    throw Error("The page cannot be written, everything else is written: " +
                lastLine(outcome.errors));
  }
}

}  // namespace cbmv
