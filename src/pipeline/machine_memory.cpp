#include "cbmv_stereo/pipeline/machine_memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <unistd.h>

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

double limitIn(const fs::path& file) {
  double bytes = 0;
  std::ifstream(file) >> bytes;  // "max", or no such file: 0
  return bytes > 0 ? bytes : kNoLimit;
}

/// Of the group in the folder and of all above it. In a container the folder may be one of the
/// host's, which is not there; then `mount` has the container's limit.
double lowestLimit(fs::path folder, const fs::path& mount, const std::string& file) {
  double bytes = limitIn(mount / file);
  for (; folder != mount && folder.has_relative_path(); folder = folder.parent_path()) {
    bytes = std::min(bytes, limitIn(folder / file));
  }
  return bytes;
}

}  // namespace

double groupLimitBytes(std::istream& groups, const fs::path& mount) {
  double bytes = kNoLimit;
  std::string line;
  while (std::getline(groups, line)) {  // number:controllers:/path
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(":/", first + 1);
    if (first == std::string::npos || second == std::string::npos) {
      continue;
    }
    const std::string controllers = ',' + line.substr(first + 1, second - first - 1) + ',';
    const std::string group = line.substr(second + 2);
    if (controllers == ",,") {
      bytes = std::min(bytes, lowestLimit(mount / group, mount, "memory.max"));
    } else if (controllers.find(",memory,") != std::string::npos) {
      const fs::path memory = mount / "memory";
      bytes = std::min(bytes, lowestLimit(memory / group, memory, "memory.limit_in_bytes"));
    }
  }
  return bytes;
}

double machineMemoryMb() {
  const double machine_bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  std::ifstream groups("/proc/self/cgroup");
  return std::min(machine_bytes, groupLimitBytes(groups, "/sys/fs/cgroup")) / (1 << 20);
}

}  // namespace cbmv
