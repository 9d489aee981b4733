#include "cbmv_stereo/presets.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

class NamedFilesTest : public testing::Test {
 protected:
  NamedFilesTest() {
    for (const char* name : {"fast.yaml", "good.yaml", "other.rviz", "small.forest"}) {
      files_.write(name, "");
    }
  }

  TemporaryFolder files_;
  std::string folder_ = files_.file("");
};

TEST_F(NamedFilesTest, AreGivenByNameOrPath) {
  for (const char* path : {"/some/where.yml", "here.yaml", "./fast"}) {
    EXPECT_EQ(presetPath(path, folder_), path);
  }
  EXPECT_EQ(presetPath("fast", folder_), folder_ + "fast.yaml");
  EXPECT_EQ(forestPath("here.forest", folder_), "here.forest");
  EXPECT_EQ(forestPath("small", folder_), folder_ + "small.forest");
}

TEST_F(NamedFilesTest, MayLieHereWithAnyEnding) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_);
  files_.write("mine.yml", "");
  files_.write("fast", "");
  EXPECT_EQ(presetPath("mine.yml", folder_), "mine.yml");
  EXPECT_EQ(presetPath("fast", folder_), folder_ + "fast.yaml");  // names have priority
  std::filesystem::current_path(before);
}

TEST_F(NamedFilesTest, AreListedWhereThereIsNone) {
  EXPECT_EQ(errorText([&] { presetPath("slow", folder_); }),
            "unknown preset 'slow', expected a name (fast, good) or the path of a YAML file");
  EXPECT_EQ(errorText([&] { forestPath("fast", folder_); }),
            "unknown forest 'fast', expected a name (small) or the path of a forest file");
  EXPECT_TRUE(mentions(errorText([&] { presetPath("fast", files_.file("none")); }),
                       {"none in " + files_.file("none")}));
}

}  // namespace
}  // namespace cbmv
