// --max-samples limits the memory of training, independent of the number of scenes.

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "support/rendered_data_set.h"
#include "support/temporary_folder.h"

namespace cbmv::test {
namespace {

/// Peak memory of the programs run so far, MiB.
long peakOfPrograms() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return usage.ru_maxrss / 1024;
}

/// Links 4 rendered scenes under `scenes` names and trains on them.
long peakOfTraining(const TemporaryFolder& folder, int scenes, const std::string& options) {
  const std::string data = folder.file("data" + std::to_string(scenes));
  std::filesystem::create_directory(data);
  for (int s = 0; s < scenes; ++s) {
    std::filesystem::create_directory_symlink(folder.file("scene" + std::to_string(s % 4)),
                                              data + "/S" + std::to_string(s));
  }
  const std::string command = std::string(CBMV_TOOLS_DIR) +
                              "/cbmv_train --dataset middlebury_v3:" + data + " --output " +
                              folder.file("new.forest") + options + " >/dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return peakOfPrograms();
}

/// Compared with four scenes, forty scenes need 8 MB more for pixels, 26 MB more for the maps of
/// the second forest, and without a limit 30 times the samples (150 MB).
TEST(TrainingMemory, DoesNotGrowWithTheScenes) {
  const TemporaryFolder folder;
  for (int s = 0; s < 4; ++s) {
    writeScene(folder.file("scene" + std::to_string(s)), renderScene(320, 120, s));
  }
  const std::string options = " --trees 2 --depth 2 --max-samples 30000";
  const long few = peakOfTraining(folder, 4, options);
  const long many = peakOfTraining(folder, 40, options);
  EXPECT_LE(many, few + 45);
}

}  // namespace
}  // namespace cbmv::test
