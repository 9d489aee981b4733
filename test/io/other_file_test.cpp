#include "io/other_file.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

class OtherFileTest : public testing::Test {
 protected:
  OtherFileTest() { std::ofstream(input_) << "a recording"; }
  bool isRejected(const std::string& input, const std::string& output) const {
    return mentions(errorText([&] { requireOtherFile(input, output); }),
                    {"would overwrite the input", input});
  }

  TemporaryFolder folder_;
  std::string input_ = folder_.file("in.bag");
};

TEST_F(OtherFileTest, OneFileHasManyPaths) {
  const std::string link = folder_.file("link.bag");
  const std::string hard_link = folder_.file("hard.bag");
  fs::create_symlink(input_, link);
  fs::create_hard_link(input_, hard_link);
  for (const std::string& output : {input_, link, hard_link, folder_.file("./in.bag")}) {
    EXPECT_TRUE(isSameFile(input_, output)) << output;
    EXPECT_TRUE(isRejected(input_, output)) << output;
  }
  EXPECT_FALSE(isSameFile(input_, folder_.file("out.bag")));
  EXPECT_FALSE(isRejected(input_, folder_.file("out.bag")));
}

/// Paths that do not exist yet are compared, too.
TEST_F(OtherFileTest, PathsThatAreRelative) {
  EXPECT_TRUE(isSameFile("missing.bag", "./missing.bag"));
  EXPECT_TRUE(isSameFile("missing.bag", fs::absolute("missing.bag").string()));
  const std::string output = fs::relative(folder_.file("out.bag")).string();
  const std::string part = folder_.file("out.bag.part.00000000-00000004");
  std::ofstream(part) << "a recording";
  EXPECT_TRUE(isRejected(part, output));
}

}  // namespace
}  // namespace cbmv
