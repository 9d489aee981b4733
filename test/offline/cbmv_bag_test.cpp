// The program cbmv_bag: kills, exit status and what it says.

#include <chrono>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "recording.h"
#include "support/run_tool.h"

#include "cbmv_stereo/forest/forest_file.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;
using test::expectRefusal;
using test::Outcome;

class CbmvBagTest : public testing::Test {
 protected:
  CbmvBagTest() { writeForest(makeForestFixture(), folder_.file("fixture.forest")); }

  std::vector<std::string> arguments(const std::string& output) const {
    return {folder_.file("in.bag"),
            "--output",
            folder_.file(output),
            "--forest",
            folder_.file("fixture.forest"),
            "--disparities",
            "16"};
  }
  Outcome run(const std::string& output, const std::string& more = "",
              const std::string& environment = "") const {
    std::string line;
    for (const std::string& argument : arguments(output)) {
      line += argument + " ";
    }
    return test::run("cbmv_bag", line + more, environment);
  }
  std::size_t parts(const std::string& output) const {
    std::size_t found = 0;
    for (const auto& file : fs::directory_iterator(fs::path(folder_.file(output)).parent_path())) {
      found += file.path().filename().string().find(output + ".part.0") == 0;
    }
    return found;
  }
  /// Starts the program with --resume; kills it `delay` after it has written `more` parts.
  void runAndKill(const std::string& output, std::size_t more,
                  std::chrono::microseconds delay) const {
    const std::size_t wanted = parts(output) + more;
    std::vector<std::string> words = arguments(output);
    words.insert(words.begin(), CBMV_TOOLS_DIR "/cbmv_bag");
    words.insert(words.end(), {"--frames-per-part", "2", "--resume"});
    std::vector<char*> argv;
    for (std::string& word : words) {
      argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      execv(argv[0], argv.data());
      _exit(127);
    }
    int status = 0;
    while (parts(output) < wanted && waitpid(child, &status, WNOHANG) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::this_thread::sleep_for(delay);
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status)) << "ended before it was killed";
  }

  TemporaryFolder folder_;
};

TEST_F(CbmvBagTest, KillsLoseNothing) {
  writeRecording(folder_.file("in.bag"), 40);
  ASSERT_EQ(run("whole.bag").status, 0);
  for (int kills = 0; kills < 6; ++kills) {
    runAndKill("killed.bag", kills % 3, std::chrono::microseconds(2700 * kills));
    EXPECT_FALSE(fs::exists(folder_.file("killed.bag")));
  }
  EXPECT_GE(parts("killed.bag"), 4U);
  EXPECT_EQ(run("killed.bag", "--resume").status, 0);
  EXPECT_EQ(parts("killed.bag"), 0U);
  const Content whole = messagesOf(folder_.file("whole.bag"));
  EXPECT_EQ(whole.size(), 40U);
  EXPECT_TRUE(whole == messagesOf(folder_.file("killed.bag")));
}

TEST_F(CbmvBagTest, RefusesWithOneSentence) {
  expectRefusal(run("out.bag"), {"cbmv_bag:", "in.bag", "No such file"});
  writeRecording(folder_.file("in.bag"), 1);
  expectRefusal(run("out.bag", "--compression zip"), {"'zip'", "lz4"});
  expectRefusal(run("out.bag", "--write flow"), {"'flow'"});
  EXPECT_FALSE(fs::exists(folder_.file("out.bag")));
}

TEST_F(CbmvBagTest, RefusesDifferentFrameIdsIfAsked) {
  writeRecording(folder_.file("in.bag"), 1, [](rosbag::Bag& bag) {
    PairMessages messages = recordedFrame(1);
    messages.right_image->header.frame_id = "right_camera";
    writeFrame(bag, messages);
  });
  EXPECT_EQ(run("taken.bag").status, 0);
  EXPECT_EQ(run("refused.bag", "--refuse-different-frame-ids").status, 3);
  EXPECT_EQ(messagesOf(folder_.file("taken.bag")).size(),
            2 * messagesOf(folder_.file("refused.bag")).size());
}

TEST_F(CbmvBagTest, StatusSaysThatTheInputIsDamaged) {
  writeRecording(folder_.file("in.bag"), 6);
  fs::resize_file(folder_.file("in.bag"), fs::file_size(folder_.file("in.bag")) / 2);
  EXPECT_EQ(run("out.bag").status, 3);
  EXPECT_FALSE(messagesOf(folder_.file("out.bag")).empty());
}

/// A file that may not grow fails as on a full disk, but without notice.
TEST_F(CbmvBagTest, NamesTheFileThatCannotGrow) {
  writeRecording(folder_.file("in.bag"), 6);
  const Outcome outcome = run("out.bag", "--frames-per-part 1000", "ulimit -f 60;");
  expectRefusal(outcome, {"cannot write", "out.bag.part", "File too large"});
  EXPECT_FALSE(fs::exists(folder_.file("out.bag")));
  EXPECT_EQ(run("out.bag", "--resume").status, 0);
  EXPECT_EQ(messagesOf(folder_.file("out.bag")).size(), 6U);
}

}  // namespace
}  // namespace cbmv
