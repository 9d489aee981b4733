#pragma once

#include_next <tbb/task_arena.h>

#include "loop_order.h"

namespace tbb {

/// A task_arena whose work may run on another thread.
class ordered_task_arena : public task_arena {
 public:
  using task_arena::task_arena;

  template <typename Work>
  auto execute(const Work& work) {
    LoopOrder order;
    const AtEnd at_end{order};
    return task_arena::execute([&] { return order.run(work); });
  }

 private:
  struct AtEnd {
    LoopOrder& order;
    ~AtEnd() { order.end(); }
  };
};

}  // namespace tbb

#define task_arena ordered_task_arena
