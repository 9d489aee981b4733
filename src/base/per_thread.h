#pragma once

#include <cstddef>
#include <vector>

namespace cbmv {

/// Number of threads that may run the parallel loops of the calling thread.
std::size_t threadCount();
/// Index of the calling thread in [0, threadCount()). Only valid in a parallel loop.
std::size_t threadIndex();

/// One Buffer per thread for parallel loops. Buffers are kept from loop to loop.
template <typename Buffer>
class PerThread {
 public:
  /// Call before the loop: calls prepare(buffer) for the buffers of all threads, so that no thread
  /// allocates in the loop.
  template <typename Prepare>
  void prepare(const Prepare& prepare) {
    buffers_.resize(threadCount());
    for (Buffer& buffer : buffers_) {
      prepare(buffer);
    }
  }

  /// Call in the loop: the buffer of the calling thread.
  Buffer& local() { return buffers_[threadIndex()]; }

 private:
  std::vector<Buffer> buffers_;
};

}  // namespace cbmv
