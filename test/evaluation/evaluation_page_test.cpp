#include "evaluation/evaluation_page.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

/// A shell script in a folder whose name a shell would split.
class EvaluationPage : public testing::Test {
 protected:
  EvaluationPage() { std::filesystem::create_directory(folder_.file("a; b 'c")); }

  std::string path(const std::string& name) const { return folder_.file("a; b 'c/" + name); }

  /// The error when the script is run for "r.json", "maps" and "page.html".
  std::string error(const std::string& program) const {
    std::filesystem::permissions(folder_.write("a; b 'c/program", program),
                                 std::filesystem::perms::owner_all);
    return errorText([&] {
      writeEvaluationPage(path("program"), path("r.json"), path("maps"), path("page.html"));
    });
  }

  const TemporaryFolder folder_;
};

TEST_F(EvaluationPage, GivesTheProgramItsArguments) {
  EXPECT_EQ(error("#!/bin/sh\nprintf '%s\\n' \"$@\" > \"$5\"\necho a warning >&2\n"), "no error");
  std::ifstream in(path("page.html"));
  for (const std::string& expected : {path("r.json"), std::string("--maps"), path("maps"),
                                      std::string("--output"), path("page.html")}) {
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, expected);
  }
}

TEST_F(EvaluationPage, TellsWhatTheProgramTells) {
  EXPECT_TRUE(mentions(error("#!/bin/sh\necho first >&2\necho it lacks bread >&2\nexit 2\n"),
                       {"page cannot be written", ": it lacks bread"}));
  EXPECT_TRUE(mentions(error("#!/bin/sh\nkill -9 $$\n"), {"page cannot be written", "stopped"}));
}

TEST_F(EvaluationPage, SaysWhatIsMissing) {
  EXPECT_TRUE(mentions(error("#!/no/python3\n"), {path("program"), "python3-matplotlib"}));
  EXPECT_TRUE(mentions(errorText([&] { writeEvaluationPage(path("none"), "r", "m", "p"); }),
                       {path("none"), "no such file"}));
  std::filesystem::permissions(path("program"), std::filesystem::perms::owner_read);
  EXPECT_TRUE(mentions(errorText([&] { writeEvaluationPage(path("program"), "r", "m", "p"); }),
                       {path("program"), "Permission"}));
}

}  // namespace
}  // namespace cbmv
