#include "io/output_check.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support/error_text.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

class OutputCheck : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }
  static std::string fileError(const std::string& file) {
    return errorText([&] { requireWritableFile(file); });
  }
  static std::string folderError(const std::string& folder) {
    return errorText([&] { requireWritableFolder(folder); });
  }
  long entries() const {
    return std::distance(fs::recursive_directory_iterator(folder_.file("")), {});
  }

  TemporaryFolder folder_;
};

TEST_F(OutputCheck, TakesWhatCanBeWrittenAndLeavesItAlone) {
  const std::string old = folder_.write("old.json", "old");
  fs::create_symlink(old, path("link.json"));
  for (const std::string& file : {path("new.json"), old, path("link.json"), std::string("new.json"),
                                  std::string("/dev/null"), std::string("/dev/stdout")}) {
    EXPECT_EQ(fileError(file), "no error") << file;
  }
  for (const char* folder : {"", "new", "new/", "new/deep/folder"}) {
    EXPECT_EQ(folderError(path(folder)), "no error") << folder;
  }
  EXPECT_EQ(folderError("new"), "no error");
  EXPECT_EQ(entries(), 2);
  EXPECT_EQ(contentOf(old), "old");
}

TEST_F(OutputCheck, NamesTheFileThatCannotBeWritten) {
  folder_.write("file", "");
  fs::create_directory(path("folder"));
  EXPECT_TRUE(
      mentions(fileError(path("none/a.json")), {path("none/a.json"), "there is no folder"}));
  EXPECT_TRUE(
      mentions(fileError(path("file/a.json")), {path("file/a.json"), "there is no folder"}));
  EXPECT_TRUE(mentions(fileError(path("folder")), {path("folder"), "it is a folder"}));
  EXPECT_TRUE(mentions(fileError(path("new/")), {path("new/"), "it is a folder"}));
  EXPECT_TRUE(mentions(fileError(""), {"empty path"}));
  EXPECT_TRUE(mentions(fileError("/proc/a.json"), {"/proc/a.json", "no file can be created"}));
}

TEST_F(OutputCheck, NamesTheFolderThatCannotBeWritten) {
  folder_.write("file", "");
  for (const char* name : {"file", "file/", "file/deep/er"}) {
    EXPECT_TRUE(mentions(folderError(path(name)), {path(name), path("file") + " is not a folder"}));
  }
  EXPECT_TRUE(mentions(folderError(""), {"empty path"}));
  EXPECT_TRUE(mentions(folderError("/proc/new"), {"/proc/new", "no file can be created"}));
}

TEST_F(OutputCheck, KnowsPermissions) {
  if (geteuid() == 0) {
    GTEST_SKIP() << "root may write everywhere";
  }
  const std::string file = folder_.write("file", "");
  chmod(file.c_str(), S_IRUSR);
  EXPECT_TRUE(mentions(fileError(file), {file, "is not writable"}));
  fs::create_directory(path("folder"));
  chmod(path("folder").c_str(), S_IRUSR | S_IXUSR);
  EXPECT_TRUE(
      mentions(fileError(path("folder/new")), {path("folder/new"), "no file can be created"}));
  EXPECT_TRUE(mentions(folderError(path("folder/new")), {"no file can be created"}));
  chmod(path("folder").c_str(), S_IRWXU);
}

}  // namespace
}  // namespace cbmv
