#pragma once

#include <cstddef>
#include <vector>

namespace cbmv {

/// Number of threads that may work on the parallel loops of the calling thread.
std::size_t threadCount();
/// Number of the calling thread among these, in [0, threadCount()); in a parallel loop only.
std::size_t threadIndex();

/// Memory for parallel loops, kept from loop to loop: one Buffer for each thread.
template <typename Buffer>
class PerThread {
 public:
  /// Before the loop: calls prepare(buffer) for the buffers of all threads, so that no thread has
  /// to allocate in the loop, however late it comes.
  template <typename Prepare>
  void prepare(const Prepare& prepare) {
    buffers_.resize(threadCount());
    for (Buffer& buffer : buffers_) {
      prepare(buffer);
    }
  }

  /// In the loop: the buffer of the calling thread.
  Buffer& local() { return buffers_[threadIndex()]; }

 private:
  std::vector<Buffer> buffers_;
};

}  // namespace cbmv
