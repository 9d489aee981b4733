#include "pipeline/machine_memory.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <new>
#include <string>

#include <unistd.h>

#include "pipeline/memory.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

double limitIn(const fs::path& file) {
  double bytes = 0;
  std::ifstream(file) >> bytes;  // 0 for "max" or a missing file
  return bytes > 0 ? bytes : kNoLimit;
}

/// The lowest limit of the group in `folder` and of its parents. In a container, `folder` may be a
/// path of the host that does not exist. Then `mount` has the limit of the container.
double lowestLimit(fs::path folder, const fs::path& mount, const std::string& file) {
  double bytes = limitIn(mount / file);
  for (; folder != mount && folder.has_relative_path(); folder = folder.parent_path()) {
    bytes = std::min(bytes, limitIn(folder / file));
  }
  return bytes;
}

std::string wholeMb(double mb) { return std::to_string(std::llround(mb)) + " MB"; }

/// Empty if the memory suffices.
std::string memoryErrorText(double required_mb, const std::string& what, const std::string& remedy,
                            double machine_mb) {
  if (required_mb <= machine_mb) {
    return {};
  }
  return what + " need " + wholeMb(required_mb) + ", but the machine has " + wholeMb(machine_mb) +
         ". " + remedy;
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

std::string machineMemoryError(const cv::Size& image_size, const StereoOptions& options,
                               double machine_mb) {
  return memoryErrorText(requiredMemoryMb(image_size, options),
                         "images of " + std::to_string(image_size.width) + "x" +
                             std::to_string(image_size.height) + " pixels with " +
                             std::to_string(options.range.count) + " disparities",
                         "Lower disparity_range or use smaller images", machine_mb);
}

void requireMemory(const cv::Size& image_size, const StereoOptions& options) {
  for (const std::string& message :
       {memoryError(image_size, options), machineMemoryError(image_size, options)}) {
    if (!message.empty()) {
      throw Error(message);
    }
  }
}

void requireMachineMemory(double required_mb, const std::string& what, const std::string& remedy,
                          double machine_mb) {
  const std::string message = memoryErrorText(required_mb, what, remedy, machine_mb);
  if (!message.empty()) {
    throw Error(message);
  }
}

std::string describeFailure(const std::exception& error) {
  const auto* const of_opencv = dynamic_cast<const cv::Exception*>(&error);
  const bool no_memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
                         (of_opencv != nullptr && of_opencv->code == cv::Error::StsNoMem);
  return no_memory ? "not enough memory: the machine has " + wholeMb(machineMemoryMb()) +
                         ", shared with other programs. Use smaller images, fewer disparities or "
                         "fewer threads"
                   : error.what();
}

}  // namespace cbmv
