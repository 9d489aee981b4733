#pragma once

#include <atomic>

// For ThreadSanitizer, which does not see into Debian's oneTBB (cmake/sanitizers.cmake): what comes
// before a parallel loop happens before each of its steps, and these before what comes behind the
// loop. Nothing is said of two steps, so that a race between them is still found.

namespace tbb {

class LoopOrder {
 public:
  LoopOrder() { begun_.store(1, std::memory_order_release); }

  /// Runs one step of the loop.
  template <typename Step>
  auto run(const Step& step) {
    begun_.load(std::memory_order_acquire);
    const AtEnd at_end{ended_};
    return step();
  }

  /// Behind the loop.
  void end() { ended_.load(std::memory_order_acquire); }

 private:
  struct AtEnd {
    std::atomic<int>& ended;
    ~AtEnd() { ended.fetch_add(1, std::memory_order_release); }
  };

  std::atomic<int> begun_{0};
  std::atomic<int> ended_{0};
};

}  // namespace tbb
