#include "tools/progress_bar.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include <unistd.h>

namespace cbmv {
namespace {

constexpr int kWidth = 30;  // width of the bar in characters

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Formats a time: "0:07", "12:30", "1:02:03".
std::string clockTime(double seconds) {
  const auto whole = std::lround(seconds);
  std::array<char, 32> text{};
  if (whole < 3600) {
    std::snprintf(text.data(), text.size(), "%ld:%02ld", whole / 60, whole % 60);
  } else {
    std::snprintf(text.data(), text.size(), "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60,
                  whole % 60);
  }
  return text.data();
}

}  // namespace

ProgressBar::ProgressBar(std::FILE* file, bool terminal, Clock clock)
    : file_(file), terminal_(terminal), clock_(clock ? std::move(clock) : steadySeconds) {}

ProgressBar::~ProgressBar() { endLine(); }

void ProgressBar::show(const std::string& phase, int done, int total, const std::string& line) {
  if (!terminal_) {
    if (!line.empty()) {
      std::fprintf(file_, "%s\n", line.c_str());
      std::fflush(file_);
    }
    return;
  }
  if (phase != phase_ || !open_) {
    begin(phase, done);
  }
  std::fprintf(file_, "\r%s\x1b[K",
               draw(done, total).c_str());  // the escape sequence clears the rest of the line
  open_ = true;
  if (done >= total) {
    endLine();
  }
  std::fflush(file_);
}

void ProgressBar::begin(const std::string& phase, int done) {
  endLine();
  phase_ = phase;
  begin_s_ = clock_();
  begin_done_ = done;
}

void ProgressBar::endLine() {
  if (open_) {
    std::fputc('\n', file_);
    open_ = false;
  }
}

std::string ProgressBar::draw(int done, int total) const {
  const int filled = total > 0 ? std::min(kWidth, kWidth * done / total) : kWidth;
  std::string text = phase_ + " [" + std::string(filled, '#') + std::string(kWidth - filled, ' ') +
                     "] " + std::to_string(done) + "/" + std::to_string(total);
  const double seconds = clock_() - begin_s_;
  if (done > begin_done_ && seconds > 0) {
    const double rate = (done - begin_done_) / seconds;
    std::array<char, 64> numbers{};
    std::snprintf(numbers.data(), numbers.size(), ", %.3g/s, %s left", rate,
                  clockTime((total - done) / rate).c_str());
    text += numbers.data();
  }
  return text;
}

bool isTerminal(std::FILE* file) { return isatty(fileno(file)) == 1; }

}  // namespace cbmv
