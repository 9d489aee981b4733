#pragma once

#include <memory>

#include <tbb/task_arena.h>

namespace cbmv {

/// Limits the number of oneTBB threads. Work runs in the task arena of the caller if it has exactly
/// this number of threads, otherwise in an arena of its own.
class ThreadLimit {
 public:
  /// 0: all hardware threads.
  explicit ThreadLimit(int threads = 0) { set(threads); }

  void set(int threads) {
    if (arena_ == nullptr || threads != threads_) {
      threads_ = threads;
      arena_ = std::make_unique<tbb::task_arena>(
          threads > 0 ? threads : static_cast<int>(tbb::task_arena::automatic));
    }
  }

  template <typename Work>
  void run(const Work& work) const {
    if (tbb::this_task_arena::max_concurrency() == arena_->max_concurrency()) {
      work();  // the arena of the caller has this number of threads
    } else {
      arena_->execute(work);
    }
  }

 private:
  int threads_ = 0;
  std::unique_ptr<tbb::task_arena> arena_;
};

}  // namespace cbmv
