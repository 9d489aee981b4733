// Loaded before the Highway library under valgrind, which does not support the instruction for
// reading the clock that the library uses at its start. This package does not use the clock.
namespace hwy::platform {

// NOLINTNEXTLINE(readability-identifier-naming): Highway's name
double TimerResolution() { return 1e-9; }

}  // namespace hwy::platform
