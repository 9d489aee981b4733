#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace cbmv {

/// Shows how far a phase of some work is: on a terminal as one line that is redrawn, with a bar,
/// the steps done of all, steps a second and the time left; else as the plain lines that come with
/// some steps.
class ProgressBar {
 public:
  /// Seconds from any beginning on.
  using Clock = std::function<double()>;

  /// `file` outlives the bar. The clock is the steady one unless a test brings its own.
  ProgressBar(std::FILE* file, bool terminal, Clock clock = nullptr);
  /// Ends the line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `done` steps of `total` are done. Another phase than before begins a line. `line` may be
  /// empty.
  void show(const std::string& phase, int done, int total, const std::string& line);

 private:
  void begin(const std::string& phase, int done);
  void endLine();
  std::string draw(int done, int total) const;

  std::FILE* file_;
  bool terminal_;
  Clock clock_;
  std::string phase_;
  double begin_s_ = 0;  ///< of the phase
  int begin_done_ = 0;
  bool open_ = false;  ///< the line waits for its end
};

/// Whether a person looks at the file.
bool isTerminal(std::FILE* file);

}  // namespace cbmv
