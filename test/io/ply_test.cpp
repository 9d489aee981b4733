#include "io/ply.h"

#include <string>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

TEST(Ply, WritesHeaderAndPackedPoints) {
  const TemporaryFolder folder;
  writePly(folder.file("a.ply"), {{1.0F, -2.0F, 0.5F, 1, 2, 255}, {0.0F, 3.0F, 0.0F, 0, 128, 7}});
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\n"
      "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nend_header\n";
  const std::string points(
      "\x00\x00\x80\x3f\x00\x00\x00\xc0\x00\x00\x00\x3f\x01\x02\xff"
      "\x00\x00\x00\x00\x00\x00\x40\x40\x00\x00\x00\x00\x00\x80\x07",
      30);
  EXPECT_EQ(contentOf(folder.file("a.ply")), header + points);
}

TEST(Ply, AnEmptyCloudIsAFileToo) {
  const TemporaryFolder folder;
  writePly(folder.file("a.ply"), {});
  EXPECT_TRUE(mentions(contentOf(folder.file("a.ply")), {"element vertex 0\n"}));
}

TEST(Ply, NamesTheFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.file("absent/a.ply");
  EXPECT_TRUE(mentions(errorText([&] { writePly(path, {}); }), {path}));
}

}  // namespace
}  // namespace cbmv
