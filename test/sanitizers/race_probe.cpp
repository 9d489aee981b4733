// A race in a parallel loop, which ThreadSanitizer must find despite all suppressions. The test
// passes if this program fails.

#include <atomic>

#include <tbb/parallel_for.h>

int main() {
  int unguarded = 0;
  std::atomic<int> arrived{0};
  tbb::parallel_for(0, 2, [&](int) {
    ++arrived;
    for (long spins = 0; arrived < 2 && spins < 1000000000L; ++spins) {
    }  // so that two threads run it
    ++unguarded;
  });
  return unguarded < 0 ? 2 : 0;
}
