// Run by faults_lifecycle.test: nodelets that are unloaded, and processes that are ended, during a
// frame.

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ros/fault_fixture.h"
#include "ros/rostest_main.h"

namespace cbmv {
namespace {

constexpr int kReloads = 100;
constexpr double kLongestShutdownS = 30;  // one frame, on a loaded machine

/// Cameras and a subscriber of disparities in a namespace.
struct LiveStereo {
  explicit LiveStereo(const std::string& name_space) : nh(name_space), cameras(nh) {
    disparity.subscribe(nh, "disparity");
  }
  PairMessages pair(ros::Time stamp = ros::Time::now()) const {
    return makeMessages(images, {}, stamp);
  }
  /// Publishes pairs until a disparity arrives.
  bool comes(double timeout_s = 30) {
    const std::size_t before = disparity.count();
    return waitFor(
        [&] {
          cameras.publish(pair());
          wait(0.02);
          return disparity.count() > before;
        },
        timeout_s);
  }

  ros::NodeHandle nh;
  Cameras cameras;
  Collector<stereo_msgs::DisparityImage> disparity;
  StereoPair images = renderPair({61, 43}, 4, 9);
};

template <typename Service>
bool callManager(const std::string& manager, const std::string& service, Service& call) {
  const std::string name = manager + "/" + service;
  return ros::service::waitForService(name, 20000) && ros::service::call(name, call);
}

bool load(const std::string& manager, const std::string& nodelet) {
  nodelet::NodeletLoad call;
  call.request.name = nodelet;
  call.request.type = "cbmv_stereo/stereo";
  return callManager(manager, "load_nodelet", call) && call.response.success;
}

bool unload(const std::string& manager, const std::string& nodelet) {
  nodelet::NodeletUnload call;
  call.request.name = nodelet;
  return callManager(manager, "unload_nodelet", call) && call.response.success;
}

TEST(Lifecycle, UnloadedAndLoadedAHundredTimesWhileComputing) {
  const std::string nodelet = "/reloaded/nodelet";
  ros::NodeHandle parameters(nodelet);
  parameters.setParam("forest", CBMV_TEST_FOREST);
  parameters.setParam("disparity_range", 16);
  LiveStereo stream("/reloaded");
  cv::RNG random(5);
  for (int round = 0; round < kReloads; ++round) {
    SCOPED_TRACE(round);
    ASSERT_TRUE(load("/manager", nodelet));
    const Feeder feeder(0.003, [&] { stream.cameras.publish(stream.pair()); });
    const std::size_t before = stream.disparity.count();
    ASSERT_TRUE(waitFor([&] { return stream.disparity.count() > before; }, 30));
    wait(random.uniform(0.0, 0.02));
    ASSERT_TRUE(unload("/manager", nodelet));
  }
  ASSERT_TRUE(load("/manager", nodelet));
  EXPECT_TRUE(stream.comes());
  EXPECT_TRUE(unload("/manager", nodelet));
}

/// A program that is ended while it processes a frame.
class Program {
 public:
  explicit Program(const std::vector<std::string>& command) {
    std::vector<char*> arguments(command.size() + 1, nullptr);
    std::transform(command.begin(), command.end(), arguments.begin(),
                   [](const std::string& word) { return const_cast<char*>(word.c_str()); });
    if (posix_spawn(&pid_, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) {
      throw std::runtime_error("cannot start " + command[0]);
    }
  }
  ~Program() {
    if (!has_ended_) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  void interrupt() const { kill(pid_, SIGINT); }
  bool hasEnded() {
    has_ended_ = has_ended_ || waitpid(pid_, &status_, WNOHANG) == pid_;
    return has_ended_;
  }
  std::string howItEnded() const {
    return WIFEXITED(status_) ? "exit status " + std::to_string(WEXITSTATUS(status_))
                              : "signal " + std::to_string(WTERMSIG(status_));
  }

 private:
  pid_t pid_ = 0;
  int status_ = 0;
  bool has_ended_ = false;
};

/// Makes frames slow.
void setSlowParameters(const std::string& node) {
  ros::NodeHandle parameters(node);
  parameters.setParam("forest", CBMV_TEST_FOREST);
  parameters.setParam("disparity_range", 64);
  parameters.setParam("search_levels", 0);
  parameters.setParam("cbca_iterations_before", 16);
  parameters.setParam("cbca_iterations_after", 16);
}

void expectEndsInTheMiddleOfAFrame(Program& program, const std::string& name_space) {
  LiveStereo stream(name_space);
  stream.images = renderPair({240, 180}, 10, 40);
  ASSERT_TRUE(stream.comes());
  wait(1);  // until the pairs published by comes() are done
  const std::size_t before = stream.disparity.count();
  stream.cameras.publish(stream.pair());
  wait(0.05);
  program.interrupt();
  EXPECT_TRUE(waitFor([&] { return program.hasEnded(); }, kLongestShutdownS));
  EXPECT_EQ(program.howItEnded(), "exit status 0");
  EXPECT_LE(stream.disparity.count(), before + 1);
}

TEST(Lifecycle, NodeEndsInTheMiddleOfAFrame) {
  for (int round = 0; round < 5; ++round) {
    const std::string name_space = "/ended_node_" + std::to_string(round);
    setSlowParameters(name_space + "/node");
    Program node({CBMV_STEREO_NODE, "__name:=node", "__ns:=" + name_space});
    expectEndsInTheMiddleOfAFrame(node, name_space);
  }
}

TEST(Lifecycle, ManagerEndsInTheMiddleOfAFrame) {
  for (int round = 0; round < 5; ++round) {
    const std::string name_space = "/ended_manager_" + std::to_string(round);
    setSlowParameters(name_space + "/nodelet");
    Program manager({CBMV_NODELET_PROGRAM, "manager", "__name:=manager", "__ns:=" + name_space});
    ASSERT_TRUE(load(name_space + "/manager", name_space + "/nodelet"));
    expectEndsInTheMiddleOfAFrame(manager, name_space);
  }
}

/// Matching the large pair needs more than 1 GiB.
TEST(Lifecycle, FramesThatFindNoAddressSpaceAreDropped) {
  setSlowParameters("/starved/node");
  ros::NodeHandle("/starved/node").setParam("disparity_range", 512);
  Program node({"/bin/sh", "-c",
                "ulimit -v 1200000; exec " CBMV_STEREO_NODE " __name:=node __ns:=/starved"});
  DiagnosticsReader diagnostics("starved/node");
  LiveStereo stream("/starved");
  const StereoPair small = stream.images;
  for (int round = 0; round < 3; ++round) {
    stream.images = small;
    EXPECT_TRUE(stream.comes());
    stream.images = renderPair({1242, 375}, 10, 40);
    EXPECT_TRUE(diagnostics.waitFor("Output", diagnostic_msgs::DiagnosticStatus::WARN,
                                    "dropped in the last 10 s: ", [&] {
                                      stream.cameras.publish(stream.pair());
                                      wait(0.2);
                                    }));
    EXPECT_FALSE(node.hasEnded());
  }
  stream.images = small;
  EXPECT_TRUE(stream.comes());
  node.interrupt();
  EXPECT_TRUE(waitFor([&] { return node.hasEnded(); }, kLongestShutdownS));
  EXPECT_EQ(node.howItEnded(), "exit status 0");
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
