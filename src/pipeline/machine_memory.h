#pragma once

#include <exception>
#include <filesystem>
#include <istream>
#include <string>

#include <opencv2/core.hpp>

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Bytes that the control groups of a process (a container, a service, a job) allow it, infinity
/// where they allow all. `groups` is as /proc/self/cgroup, `mount` where the system shows the
/// limits; of version 2 or 1, of the group itself and of all that it is in.
double groupLimitBytes(std::istream& groups, const std::filesystem::path& mount);

/// Memory in MB (2^20 bytes) that this process can have at most: the machine's, or what its control
/// groups allow if that is less.
double machineMemoryMb();

/// One sentence if a StereoMatcher needs more for images of that size (requiredMemoryMb) than the
/// machine has: with both numbers in MB and what to do. Empty if the memory suffices.
std::string machineMemoryError(const cv::Size& image_size, const StereoOptions& options,
                               double machine_mb = machineMemoryMb());

/// Throws Error with machineMemoryError, or with memoryError where options.max_memory_mb is
/// lower, so that nothing is allocated in vain.
void requireMemory(const cv::Size& image_size, const StereoOptions& options);

/// Throws Error if more than the machine has is required: `what` needs so many MB; `remedy` says
/// what to do.
void requireMachineMemory(double required_mb, const std::string& what, const std::string& remedy,
                          double machine_mb = machineMemoryMb());

/// What to tell a user of an exception: its text, but a sentence where memory could not be taken
/// (std::bad_alloc, and OpenCV's exception for it).
std::string describeFailure(const std::exception& error);

}  // namespace cbmv
