#pragma once

#include <exception>
#include <filesystem>
#include <istream>
#include <string>

#include <opencv2/core.hpp>

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Memory limit in bytes from the control groups of a process (a container, a service, a job), or
/// infinity without a limit. `groups` has the format of /proc/self/cgroup. `mount` is the folder
/// where the system shows the limits. Supports versions 1 and 2, and uses the lowest limit of the
/// group and its parents.
double groupLimitBytes(std::istream& groups, const std::filesystem::path& mount);

/// Memory in MB (2^20 bytes) available to this process: the memory of the machine, or the limit of
/// its control groups if that is lower.
double machineMemoryMb();

/// Returns one message, with both numbers in MB and what to do, if a StereoMatcher needs more
/// memory for images of this size (requiredMemoryMb) than the machine has. Empty otherwise.
std::string machineMemoryError(const cv::Size& image_size, const StereoOptions& options,
                               double machine_mb = machineMemoryMb());

/// Throws Error with machineMemoryError, or with memoryError if options.max_memory_mb is lower.
/// Call it before allocating.
void requireMemory(const cv::Size& image_size, const StereoOptions& options);

/// Throws Error if the requirement exceeds the memory of the machine. `what` needs `required_mb`;
/// `remedy` says what to do.
void requireMachineMemory(double required_mb, const std::string& what, const std::string& remedy,
                          double machine_mb = machineMemoryMb());

/// Describes an exception for users: its text, or a message for failed allocations
/// (std::bad_alloc, and OpenCV's exception for it).
std::string describeFailure(const std::exception& error);

}  // namespace cbmv
