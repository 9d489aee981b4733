#pragma once

#include <algorithm>
#include <fstream>
#include <istream>

#include <unistd.h>

namespace cbmv {

/// Memory in MB (2^20 bytes) that a process can have at most on a machine with so many bytes:
/// these, or what its control group (a container, say) allows if that is less. `group_limit` is
/// what the system says of the group: a number of bytes, or "max", or nothing.
inline double memoryMb(double machine_bytes, std::istream& group_limit) {
  double group_bytes = machine_bytes;
  group_limit >> group_bytes;  // what is no number becomes 0
  return std::min(machine_bytes, group_bytes > 0 ? group_bytes : machine_bytes) / (1 << 20);
}

/// Of this process.
inline double machineMemoryMb() {
  std::ifstream group_limit("/sys/fs/cgroup/memory.max");
  return memoryMb(
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE)),
      group_limit);
}

}  // namespace cbmv
