#pragma once

#include <memory>

#include <tbb/task_arena.h>

namespace cbmv {

/// Bounds the threads of oneTBB that work is done by: those of the task arena that it is called in
/// where that has as many, else those of an arena of its own.
class ThreadLimit {
 public:
  /// 0: as many as the machine has.
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
      work();  // as many threads are here already
    } else {
      arena_->execute(work);
    }
  }

 private:
  int threads_ = 0;
  std::unique_ptr<tbb::task_arena> arena_;
};

}  // namespace cbmv
