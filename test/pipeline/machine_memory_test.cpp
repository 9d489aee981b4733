#include "pipeline/machine_memory.h"

#include <filesystem>
#include <limits>
#include <new>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "pipeline/memory.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

class GroupLimit : public testing::Test {
 protected:
  void allow(const std::string& folder, const std::string& file, const std::string& limit) {
    std::filesystem::create_directories(folder_.file(folder));
    folder_.write(folder + "/" + file, limit);
  }
  double limitOf(const std::string& groups) {
    std::istringstream text(groups);
    return groupLimitBytes(text, folder_.file("."));
  }

  TemporaryFolder folder_;
};

TEST_F(GroupLimit, IsTheLowestOfTheGroupAndThoseAboveIt) {
  allow("robot.slice/node", "memory.max", "3000\n");
  allow("robot.slice", "memory.max", "2000\n");
  EXPECT_EQ(limitOf("0::/robot.slice/node\n"), 2000);
  EXPECT_EQ(limitOf("0::/robot.slice\n"), 2000);
  allow("robot.slice/node", "memory.max", "1000\n");
  EXPECT_EQ(limitOf("0::/robot.slice/node\n"), 1000);
  EXPECT_EQ(limitOf("0::/other\n"), kNoLimit);
}

TEST_F(GroupLimit, OfTheFirstVersion) {
  allow("memory/docker/a", "memory.limit_in_bytes", "1000\n");
  EXPECT_EQ(limitOf("5:cpu:/docker/b\n4:memory:/docker/a\n0::/\n"), 1000);
  EXPECT_EQ(limitOf("4:hugetlb,memory:/docker/a\n"), 1000);
  EXPECT_EQ(limitOf("4:cpu:/docker/a\n"), kNoLimit);
}

/// A container sees its own group as the root, but may have the host's name of it.
TEST_F(GroupLimit, IsAtTheRootInContainers) {
  allow(".", "memory.max", "1000\n");
  allow("memory", "memory.limit_in_bytes", "500\n");
  EXPECT_EQ(limitOf("0::/\n"), 1000);
  EXPECT_EQ(limitOf("0::/system.slice/docker.scope\n"), 1000);
  EXPECT_EQ(limitOf("4:memory:/docker/1234\n"), 500);
}

TEST_F(GroupLimit, NeedNotBe) {
  allow(".", "memory.max", "max\n");
  EXPECT_EQ(limitOf("0::/\n"), kNoLimit);
  for (const char* no_groups : {"", "no groups\n", "0:memory\n", "::\n"}) {
    EXPECT_EQ(limitOf(no_groups), kNoLimit) << no_groups;
  }
}

TEST(MachineMemoryMb, IsSome) {
  EXPECT_GT(machineMemoryMb(), 64);
  EXPECT_LT(machineMemoryMb(), 1 << 26);
}

TEST(MachineMemoryError, TellsNeedAndPresence) {
  StereoOptions options;
  options.search.levels = 0;
  options.range.count = 256;
  const cv::Size size(2000, 1000);
  EXPECT_EQ(machineMemoryError(size, options, requiredMemoryMb(size, options)), "");
  EXPECT_TRUE(mentions(machineMemoryError(size, options, 1234.4),
                       {"2000x1000", "256 disparities need",
                        std::to_string(std::llround(requiredMemoryMb(size, options))) + " MB",
                        "machine has 1234 MB", "disparity_range"}));
}

TEST(RequireMemory, TakesTheLowerOfBothBounds) {
  StereoOptions options;
  EXPECT_EQ(errorText([&] { requireMemory({640, 480}, options); }), "no error");
  options.max_memory_mb = 2;
  EXPECT_TRUE(mentions(errorText([&] {
                         requireMemory({640, 480}, options);
                       }),
                       {"max_memory_mb allows 2"}));
  options.max_memory_mb = 0;
  options.range.count = 4096;
  EXPECT_TRUE(mentions(errorText([&] {
                         requireMemory({65535, 65535}, options);
                       }),
                       {"4096 disparities need", "but the machine has"}));
}

TEST(RequireMachineMemory, NamesWhatNeedsIt) {
  EXPECT_EQ(errorText([] { requireMachineMemory(10, "samples", "Take fewer", 10); }), "no error");
  EXPECT_EQ(errorText([] { requireMachineMemory(11, "samples", "Take fewer", 10); }),
            "samples need 11 MB, but the machine has 10 MB. Take fewer");
}

TEST(DescribeFailure, ExplainsMissingMemory) {
  EXPECT_EQ(describeFailure(std::runtime_error("as it is")), "as it is");
  EXPECT_TRUE(mentions(describeFailure(std::bad_alloc()), {"not enough memory", "MB"}));
  EXPECT_TRUE(mentions(describeFailure(cv::Exception(cv::Error::StsNoMem, "e", "f", "g", 1)),
                       {"not enough memory"}));
}

}  // namespace
}  // namespace cbmv
