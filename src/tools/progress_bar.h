#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace cbmv {

/// Shows the progress of a phase. On a terminal: one line that is redrawn, with a bar, the finished
/// and total steps, steps per second and remaining time. Otherwise: the plain lines that some steps
/// provide.
class ProgressBar {
 public:
  /// Time in seconds from an arbitrary origin.
  using Clock = std::function<double()>;

  /// `file` must outlive the bar. Uses the steady clock unless a test passes another one.
  ProgressBar(std::FILE* file, bool terminal, Clock clock = nullptr);
  /// Ends the line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `done` of `total` steps are finished. A new `phase` starts a new line. `line` may be empty.
  void show(const std::string& phase, int done, int total, const std::string& line);

 private:
  void begin(const std::string& phase, int done);
  void endLine();
  std::string draw(int done, int total) const;

  std::FILE* file_;
  bool terminal_;
  Clock clock_;
  std::string phase_;
  double begin_s_ = 0;  ///< start of the phase
  int begin_done_ = 0;
  bool open_ = false;  ///< the current line has no newline yet
};

/// Whether the file is a terminal.
bool isTerminal(std::FILE* file);

}  // namespace cbmv
