// Loaded before Highway's library under valgrind, which does not know the instruction that reads
// the clock when that library starts. Nothing of ours reads it.
namespace hwy::platform {

// NOLINTNEXTLINE(readability-identifier-naming): Highway's name
double TimerResolution() { return 1e-9; }

}  // namespace hwy::platform
