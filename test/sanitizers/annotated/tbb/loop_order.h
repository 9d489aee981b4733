#pragma once

#include <atomic>

// For ThreadSanitizer, which does not see the synchronization in Debian's oneTBB
// (cmake/sanitizers.cmake). Code before a parallel loop happens before each iteration, and each
// iteration happens before the code after the loop. Iterations are not ordered, so races between
// them are still found.

namespace tbb {

class LoopOrder {
 public:
  LoopOrder() { begun_.store(1, std::memory_order_release); }

  /// Runs one iteration of the loop.
  template <typename Step>
  auto run(const Step& step) {
    begun_.load(std::memory_order_acquire);
    const AtEnd at_end{ended_};
    return step();
  }

  /// Call after the loop.
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
