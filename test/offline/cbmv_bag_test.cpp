// The program cbmv_bag: kills, exit status and output.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <sstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "forest/forest_file.h"
#include "recording.h"
#include "support/error_text.h"
#include "support/file_content.h"
#include "support/run_tool.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;
using test::expectRejection;
using test::Outcome;

/// The lines of an output that begin with the program's name.
std::string linesOf(const std::string& program, const std::string& output) {
  std::istringstream lines(output);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(program + ": ", 0) == 0) {
      kept += line + "\n";
    }
  }
  return kept;
}

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
            "16",
            "--preset",
            std::string(CBMV_SOURCE_DIR) + "/config/realtime.yaml"};
  }
  Outcome run(const std::string& output, const std::string& more = "",
              const std::string& environment = "") const {
    std::string line;
    for (const std::string& argument : arguments(output)) {
      line += argument + " ";
    }
    return test::run("cbmv_bag", line + more, environment);
  }
  /// The parts of an output, or the files of a folder.
  std::size_t filesThatBegin(const std::string& name) const {
    const fs::path path = folder_.file(name);
    std::error_code no_folder;
    std::size_t found = 0;
    for (const auto& file : fs::directory_iterator(path.parent_path(), no_folder)) {
      found += file.path().filename().string().find(path.filename().string()) == 0;
    }
    return found;
  }
  std::size_t parts(const std::string& output) const { return filesThatBegin(output + ".part.0"); }

  /// Starts the program with --resume.
  pid_t start(const std::string& output, const std::vector<std::string>& more) const {
    std::vector<std::string> words = arguments(output);
    words.insert(words.begin(), CBMV_TOOLS_DIR "/cbmv_bag");
    words.insert(words.end(), {"--frames-per-part", "2", "--resume"});
    words.insert(words.end(), more.begin(), more.end());
    std::vector<char*> argv(words.size() + 1, nullptr);
    std::transform(words.begin(), words.end(), argv.begin(),
                   [](std::string& word) { return word.data(); });
    const pid_t child = fork();
    if (child == 0) {
      static_cast<void>(std::freopen("/dev/null", "w", stdout));
      execv(argv[0], argv.data());
      _exit(127);
    }
    return child;
  }

  TemporaryFolder folder_;
};

/// Returns whether the program was still running.
bool killHard(pid_t child) {
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

/// Kills the program at random times and compares the result of a resumed run.
class KilledCbmvBagTest : public CbmvBagTest {
 protected:
  KilledCbmvBagTest() {
    writeRecording(folder_.file("in.bag"), 40, nullptr, rosbag::compression::Uncompressed,
                   {192, 128});
    std::printf("seed %u\n", seed_);
    std::fflush(stdout);
  }
  /// Kills the program `times` times, then lets it finish.
  void killAndResume(const std::string& output, const std::string& complete_file, int times,
                     const std::vector<std::string>& more) {
    std::uniform_real_distribution<double> delay_s(0, longest_s_);
    int kills = 0;
    int left_parts =
        0;  // number of kills that left parts; at least one, or nothing would be resumed
    while (kills < times || (left_parts == 0 && kills < 20 * times)) {
      const pid_t child = start(output, more);
      std::this_thread::sleep_for(std::chrono::duration<double>(delay_s(random_)));
      kills += static_cast<int>(killHard(child));
      left_parts += static_cast<int>(parts(complete_file) > 0);
      if (fs::exists(folder_.file(complete_file))) {
        fs::remove_all(folder_.file(output));  // it had finished: start again
      }
    }
    EXPECT_GT(left_parts, 0) << "all were killed before they had done anything";
    int status = 0;
    waitpid(start(output, more), &status, 0);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(parts(complete_file), 0U);
  }
  /// Runs without interruption. The kills are distributed over its duration.
  void runWhole(const std::string& output, const std::string& more) {
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(run(output, "--frames-per-part 2 " + more).status, 0);
    longest_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  const unsigned seed_ = std::random_device()();
  std::mt19937 random_{seed_};
  double longest_s_ = 0;
};

TEST_F(KilledCbmvBagTest, LosesNoMessage) {
  runWhole("whole.bag", "");
  killAndResume("killed.bag", "killed.bag", 10, {});
  const Content whole = messagesOf(folder_.file("whole.bag"));
  const Content killed = messagesOf(folder_.file("killed.bag"));
  ASSERT_EQ(whole.size(), 40U);
  ASSERT_EQ(killed.size(), 40U);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_TRUE(killed[i] == whole[i]) << "message " << i;
  }
}

TEST_F(KilledCbmvBagTest, LosesNoFile) {
  const std::vector<std::string> more = {"--format", "files", "--write", "disparity,depth_raw"};
  runWhole("whole", "--format files --write disparity,depth_raw");
  killAndResume("killed", "killed/index.csv", 4, more);
  for (const char* name : {"index.csv", "disparity", "depth_raw"}) {
    const std::string compare =
        "diff -r " + folder_.file("whole") + "/" + name + " " + folder_.file("killed") + "/" + name;
    EXPECT_EQ(std::system(compare.c_str()), 0) << name;
  }
  EXPECT_EQ(filesThatBegin("killed/disparity/0"), 40U);
}

/// Compression takes most of the time of the merge, so that kills hit it. An incomplete output must
/// not be accepted as complete.
TEST_F(KilledCbmvBagTest, LosesNothingInTheMerge) {
  runWhole("whole.bag", "");
  const std::vector<std::string> more = {"--compression", "bz2"};
  const std::string unfinished = folder_.file("killed.bag.part.writing");
  for (int kills = 0; kills < 3; ++kills) {
    const pid_t child = start("killed.bag", more);
    while (!fs::exists(unfinished) && waitpid(child, nullptr, WNOHANG) == 0) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(15 * kills));
    EXPECT_TRUE(killHard(child)) << "ended before it was killed";
    EXPECT_FALSE(fs::exists(folder_.file("killed.bag")));
    EXPECT_EQ(parts("killed.bag"), 20U);
  }
  EXPECT_TRUE(fs::exists(unfinished)) << "not killed in the merge";
  EXPECT_EQ(run("killed.bag", "--resume --compression bz2").status, 0);
  EXPECT_TRUE(messagesOf(folder_.file("killed.bag")) == messagesOf(folder_.file("whole.bag")));
  EXPECT_EQ(filesThatBegin("killed.bag"), 1U) << "parts are left";
}

/// The number for a key of the summary.
double numberIn(const std::string& json, const std::string& key) {
  const std::size_t place = json.find("\"" + key + "\": ");
  return place == std::string::npos ? 0 : std::stod(json.substr(place + key.size() + 4));
}

TEST_F(CbmvBagTest, MemoryDoesNotGrowWithTheRecording) {
  std::vector<double> peak_mb;
  for (const int frames : {40, 400}) {
    writeRecording(folder_.file("in.bag"), frames, nullptr, rosbag::compression::Uncompressed,
                   {320, 240});
    ASSERT_EQ(run("out.bag", "--overwrite --threads 2 --frames-per-part 5 --json " +
                                 folder_.file("summary.json"))
                  .status,
              0);
    const std::string summary = contentOf(folder_.file("summary.json"));
    EXPECT_EQ(numberIn(summary, "frames_processed"), frames);
    peak_mb.push_back(numberIn(summary, "peak_memory_mb"));
  }
  EXPECT_GT(peak_mb[0], 10);
  EXPECT_LT(peak_mb[1], 1.05 * peak_mb[0]);
}

/// Frames that need too much memory fail. The message is in the summary and in the index.
TEST_F(CbmvBagTest, RejectsWhatNeedsTooMuchMemory) {
  writeRecording(folder_.file("in.bag"), 2);
  EXPECT_EQ(run("out/", "--max-memory-mb 1 --json " + folder_.file("summary.json")).status, 3);
  for (const char* file : {"summary.json", "out/index.csv"}) {
    EXPECT_TRUE(mentions(contentOf(folder_.file(file)), {"max_memory_mb allows 1"})) << file;
  }
  EXPECT_EQ(run("out/", "--max-memory-mb 100 --overwrite").status, 0);
}

TEST_F(CbmvBagTest, RejectsWithOneLine) {
  expectRejection(run("out.bag"), {"cbmv_bag:", "in.bag", "No such file"});
  writeRecording(folder_.file("in.bag"), 1);
  expectRejection(run("out.bag", "--compression zip"), {"'zip'", "lz4"});
  expectRejection(run("out.bag", "--write flow"), {"'flow'"});
  EXPECT_FALSE(fs::exists(folder_.file("out.bag")));
  EXPECT_EQ(run("out.bag", "--format video").status, 2);
  expectRejection(run("in.bag/", ""), {"in.bag", "folder"});
}

TEST_F(CbmvBagTest, RejectsDifferentFrameIdsIfAsked) {
  writeRecording(folder_.file("in.bag"), 1, [](rosbag::Bag& bag) {
    PairMessages messages = recordedFrame(1);
    messages.right_image->header.frame_id = "right_camera";
    writeFrame(bag, messages);
  });
  EXPECT_EQ(run("taken.bag").status, 0);
  EXPECT_EQ(run("rejected.bag", "--reject-different-frame-ids").status, 3);
  EXPECT_EQ(messagesOf(folder_.file("taken.bag")).size(),
            2 * messagesOf(folder_.file("rejected.bag")).size());
}

TEST_F(CbmvBagTest, TakesAnAnswerWhetherImagesAreRectified) {
  writeRecording(folder_.file("in.bag"), 1);
  for (const char* answer : {"yes", "no", "auto"}) {
    EXPECT_EQ(run("out.bag", std::string("--overwrite --rectified ") + answer).status, 0) << answer;
  }
  EXPECT_EQ(run("out.bag", "--overwrite --rectified maybe").status, 2);
  EXPECT_EQ(run("out.bag", "--overwrite --right-calibration right.yaml").status, 2);
}

TEST_F(CbmvBagTest, StatusSaysThatTheInputIsDamaged) {
  writeRecording(folder_.file("in.bag"), 6);
  fs::resize_file(folder_.file("in.bag"), fs::file_size(folder_.file("in.bag")) / 2);
  EXPECT_EQ(run("out.bag").status, 3);
  EXPECT_FALSE(messagesOf(folder_.file("out.bag")).empty());
}

/// A file size limit acts like a full disk, but the system gives no notice.
TEST_F(CbmvBagTest, NamesTheFileThatCannotGrow) {
  writeRecording(folder_.file("in.bag"), 6);
  Outcome outcome = run("out.bag", "--frames-per-part 1000", "ulimit -f 60;");
  outcome.output = linesOf("cbmv_bag", outcome.output);  // on Debian 13, class_loader adds others
  expectRejection(outcome, {"cannot write", "out.bag.part", "File too large"});
  EXPECT_FALSE(fs::exists(folder_.file("out.bag")));
  EXPECT_EQ(run("out.bag", "--resume").status, 0);
  EXPECT_EQ(messagesOf(folder_.file("out.bag")).size(), 6U);
}

/// The same with files: frames written before are kept.
TEST_F(CbmvBagTest, NamesTheFileOfAFolderThatCannotGrow) {
  writeRecording(folder_.file("in.bag"), 4);
  const Outcome outcome = run("out/", "--write disparity,cloud", "ulimit -f 60;");
  expectRejection(outcome, {"Cannot write", "points2/", "free space"});
  EXPECT_FALSE(fs::exists(folder_.file("out/index.csv")));
  EXPECT_EQ(filesThatBegin("out/points2/."), 0U) << "an unfinished file is left";
  EXPECT_EQ(run("out/", "--write disparity,cloud --resume").status, 0);
  EXPECT_EQ(filesThatBegin("out/points2/0"), 4U);
}

/// Exit status and stderr.
TEST_F(CbmvBagTest, ExitStatusTellsThatNothingWasDone) {
  writeRecording(folder_.file("in.bag"), 2);
  const Outcome late = run("out.bag", "--start 1000 --json " + folder_.file("summary.json"));
  EXPECT_EQ(late.status, 3);
  EXPECT_THAT(late.output, testing::HasSubstr("no pair to process"));
  EXPECT_THAT(contentOf(folder_.file("summary.json")), testing::HasSubstr("\"complete\": false"));
  EXPECT_FALSE(fs::exists(folder_.file("out.bag")));
  EXPECT_EQ(parts("out.bag"), 0U);
}

TEST_F(CbmvBagTest, KeepsTheRecordingThatIsNamedAsOutput) {
  writeRecording(folder_.file("in.bag"), 1);
  const std::string content = contentOf(folder_.file("in.bag"));
  expectRejection(run("in.bag", "--overwrite"), {"would overwrite the input", "in.bag"});
  expectRejection(run("out.bag", "--json " + folder_.file("in.bag")),
                  {"would overwrite the input", "in.bag"});
  expectRejection(test::run("cbmv_bag", "merge " + folder_.file("in.bag") +
                                            " --overwrite --output " + folder_.file("./in.bag")),
                  {"would overwrite the input", "in.bag"});
  expectRejection(test::run("cbmv_bag", "check " + folder_.file("in.bag") + " --forest " +
                                            folder_.file("fixture.forest") + " --json " +
                                            folder_.file("in.bag")),
                  {"would overwrite the input", "in.bag"});
  EXPECT_EQ(contentOf(folder_.file("in.bag")), content);
}

TEST_F(CbmvBagTest, KeepsTheForestThatIsNamedAsOutput) {
  writeRecording(folder_.file("in.bag"), 1);
  const std::string forest = folder_.file("fixture.forest");
  const std::string content = contentOf(forest);
  expectRejection(run("fixture.forest", "--overwrite"), {"would overwrite the input", forest});
  expectRejection(run("out.bag", "--json " + forest), {"would overwrite the input", forest});
  EXPECT_EQ(contentOf(forest), content);
}

TEST_F(CbmvBagTest, SummaryIsNotWrittenOverTheOutput) {
  writeRecording(folder_.file("in.bag"), 1);
  expectRejection(run("out.bag", "--json " + folder_.file("./out.bag")), {"--json and --output"});
  EXPECT_FALSE(fs::exists(folder_.file("out.bag")));
  EXPECT_EQ(run("out/", "").status, 0);
  expectRejection(run("out/", "--overwrite --json " + folder_.file("out/index.csv")),
                  {"--json and --output"});
}

/// The merge writes a temporary file beside its output and removes it.
TEST_F(CbmvBagTest, MergeKeepsTheShardThatIsNamedAsItsOwnFile) {
  writeRecording(folder_.file("in.bag"), 2);
  const std::string first = folder_.file("all.bag.merge");
  ASSERT_EQ(run("all.bag.merge", "--shard 1/2").status, 0);
  ASSERT_EQ(run("2.bag", "--shard 2/2").status, 0);
  const std::string content = contentOf(first);
  expectRejection(test::run("cbmv_bag", "merge " + first + " " + folder_.file("2.bag") +
                                            " --output " + folder_.file("all.bag")),
                  {"would overwrite the input", "all.bag.merge"});
  EXPECT_EQ(contentOf(first), content);
}

TEST_F(CbmvBagTest, FindsOutputsThatCannotBeWrittenBeforeTheWork) {
  writeRecording(folder_.file("in.bag"), 1);
  expectRejection(run("missing/out.bag"), {"missing"});
  expectRejection(run("out.bag", "--json " + folder_.file("missing/summary.json")),
                  {"missing/summary.json"});
  EXPECT_FALSE(fs::exists(folder_.file("out.bag")));
}

}  // namespace
}  // namespace cbmv
