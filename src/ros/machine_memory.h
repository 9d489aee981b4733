#pragma once

#include <algorithm>
#include <fstream>

#include <unistd.h>

namespace cbmv {

/// Memory in MB (2^20 bytes) that this process can have at most: the machine's, or what the control
/// group (a container, say) allows if that is less.
inline double machineMemoryMb() {
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  double group = machine;
  std::ifstream("/sys/fs/cgroup/memory.max") >> group;  // "max", which is no number: 0
  return std::min(machine, group > 0 ? group : machine) / (1 << 20);
}

}  // namespace cbmv
