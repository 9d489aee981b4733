#pragma once

#include <filesystem>
#include <istream>

namespace cbmv {

/// Bytes that the control groups of a process (a container, a service, a job) allow it, infinity
/// where they allow all. `groups` is as /proc/self/cgroup, `mount` where the system shows the
/// limits; of version 2 or 1, of the group itself and of all that it is in.
double groupLimitBytes(std::istream& groups, const std::filesystem::path& mount);

/// Memory in MB (2^20 bytes) that this process can have at most: the machine's, or what its control
/// groups allow if that is less.
double machineMemoryMb();

}  // namespace cbmv
