#include "base/per_thread.h"

#include <tbb/task_arena.h>

namespace cbmv {

std::size_t threadCount() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

std::size_t threadIndex() {
  return static_cast<std::size_t>(tbb::this_task_arena::current_thread_index());
}

}  // namespace cbmv
