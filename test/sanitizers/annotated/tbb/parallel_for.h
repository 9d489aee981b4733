#pragma once

#include_next <tbb/parallel_for.h>

#include "loop_order.h"

namespace tbb {

template <typename Index, typename Body>
void ordered_parallel_for(Index first, Index last, const Body& body) {
  LoopOrder order;
  parallel_for(first, last, [&](Index index) { order.run([&] { body(index); }); });
  order.end();
}

template <typename Index, typename Body>
void ordered_parallel_for(Index first, Index last, Index step, const Body& body) {
  LoopOrder order;
  parallel_for(first, last, step, [&](Index index) { order.run([&] { body(index); }); });
  order.end();
}

template <typename Range, typename Body>
void ordered_parallel_for(const Range& range, const Body& body) {
  LoopOrder order;
  parallel_for(range, [&](const Range& part) { order.run([&] { body(part); }); });
  order.end();
}

}  // namespace tbb

#define parallel_for ordered_parallel_for
