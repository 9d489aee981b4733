// Run by faults.test, with a node that pairs equal stamps and with one that pairs close stamps:
// valid messages at the wrong time or with wrong stamps.

#include <csignal>
#include <cstdlib>
#include <limits>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ros/fault_fixture.h"
#include "ros/rostest_main.h"

namespace cbmv {
namespace {

constexpr const char* kSleeper = "--sleeping-subscriber";
const ros::Time kLastTime(std::numeric_limits<std::uint32_t>::max(), 999999999);

class TimeFaults : public FaultTest {
 protected:
  static Cameras& cameras() { return shared->client.cameras; }

  static void expectStampWarning(const std::string& words) {
    expectDiagnostic("Input", Level::WARN, words);
  }
};

TEST_F(TimeFaults, OneCameraIsSilentAndComesBack) {
  subscribeAnew();
  const Feeder left_only(0.05, [] { cameras().publishLeft(goodPair()); });
  expectDiagnostic("Input", Level::ERROR, "no pair of images for");
  expectDiagnostic("Input", Level::ERROR, "/right/image_rect no message (it has a publisher)");
  expectRightAgain();
  expectDiagnostic("Input", Level::OK, "pairs of images at", [] { cameras().publish(goodPair()); });
}

/// Waiting messages of the left camera must not block pairs with older stamps, whether an output
/// always has a subscriber or not.
TEST_F(TimeFaults, AnOldRecordingAfterOneCameraWasSilent) {
  for (const bool viewer_leaves : {true, false}) {
    for (int i = 0; i < 20; ++i) {
      cameras().publishLeft(goodPair());
      wait(0.005);
    }
    if (viewer_leaves) {
      subscribeAnew();
    }
    for (int i = 0; i < 5; ++i) {
      expectRightAgain(ros::Time(2000 + 0.1 * i));
    }
    expectRightAgain();
  }
}

/// The left camera's clock is an hour ahead for a while. Messages that then wait for partners must
/// not block others.
TEST_F(TimeFaults, StampsOfOneCameraLeapAheadForAWhile) {
  for (int i = 0; i < 8; ++i) {
    PairMessages messages = goodPair();
    messages.left_image->header.stamp += ros::Duration(3600 + i);
    messages.left_info->header.stamp = messages.left_image->header.stamp;
    cameras().publish(messages);
  }
  wait(0.1);
  expectRightAgain();
  expectStampWarning("/left/image_rect (36");
}

TEST_F(TimeFaults, RecordingsThatLoop) {
  for (int loop = 0; loop < 4; ++loop) {
    for (int i = 0; i < 10; ++i) {
      expectRightAgain(ros::Time(1000 + 0.1 * i));
    }
    for (int i = 10; i < 17; ++i) {  // interrupted: no message of the right camera
      cameras().publishLeft(goodPair(ros::Time(1000 + 0.1 * i)));
    }
    wait(0.1);  // until they wait for partners
  }
  expectStampWarning("stamps went back on ");
  expectRightAgain();
}

TEST_F(TimeFaults, SmallStepsBackCostNoPair) {
  const ros::Time start = ros::Time::now();
  for (const double offset_s : {0.3, 0.2, 0.4, 0.1}) {
    expectRightAgain(start + ros::Duration(offset_s));
  }
}

TEST_F(TimeFaults, StampsOfAnotherTime) {
  const auto failed = [] {
    return shared->diagnostics.newestValue("Output", "frames dropped after an error");
  };
  ASSERT_TRUE(waitFor([&] { return !failed().empty(); }));
  const std::string failed_before = failed();
  for (const ros::Time& stamp :
       {ros::Time::now() + ros::Duration(86400), ros::Time(0), kLastTime, ros::Time(0, 1)}) {
    expectRightAgain(stamp);
    expectRightAgain();
  }
  expectRightAgain(ros::Time::now() + ros::Duration(86400));
  expectDiagnostic("Output", Level::WARN, "");  // ages of centuries, positive or negative
  EXPECT_EQ(failed(), failed_before);
  expectStampWarning("stamps went back on ");
}

/// Stamps are random on each topic, so sets stay incomplete.
TEST_F(TimeFaults, RandomStampsDoNoHarm) {
  cv::RNG random(3);
  const auto any_stamp = [&random] {
    switch (random.uniform(0, 5)) {
      case 0:
        return ros::Time(0);
      case 1:
        return kLastTime;
      case 2:
        return ros::Time::now();
      case 3:
        return ros::Time::now() + ros::Duration(random.uniform(1.0, 100.0));
      default:
        return ros::Time(random.next(), random.next() % 1000000000U);
    }
  };
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 100; ++i) {
      PairMessages messages = goodPair();
      messages.left_image->header.stamp = any_stamp();
      messages.left_info->header.stamp = any_stamp();
      messages.right_image->header.stamp = any_stamp();
      messages.right_info->header.stamp = any_stamp();
      cameras().publish(messages);
      wait(0.001);
    }
    wait(0.2);
    expectRightAgain();
  }
  expectStampWarning("stamps went back on ");
}

/// Waits for the report on topics that do not synchronize, which contains the distance of the
/// stamps.
TEST_F(TimeFaults, StampsFartherApartThanADurationHolds) {
  subscribeAnew();
  {
    const Feeder feeder(0.1, [] {
      PairMessages messages = goodPair(ros::Time(0));
      messages.right_image->header.stamp = messages.right_info->header.stamp = kLastTime;
      cameras().publish(messages);
    });
    expectDiagnostic("Input", Level::ERROR, "(stamps 136.1 years from the first topic's)");
  }
  expectRightAgain();
}

TEST_F(TimeFaults, StampsThatComeTwice) {
  const PairMessages messages = goodPair();
  for (int i = 0; i < 5; ++i) {
    const auto disparity = disparityOf(messages);
    ASSERT_TRUE(disparity);
    expectSame(*disparity);
  }
  expectStampWarning("stamps were repeated on ");
  cameras().publishLeft(messages);
  cameras().publishLeft(messages);
  expectRightAgain();
}

TEST_F(TimeFaults, Bursts) {
  const auto replaced = [] {
    const std::string count =
        shared->diagnostics.newestValue("Output", "frames dropped while busy");
    return count.empty() ? -1 : std::stol(count);
  };
  ASSERT_TRUE(waitFor([&] { return replaced() >= 0; }));
  const long before = replaced();
  for (int burst = 0; burst < 5; ++burst) {
    for (int i = 0; i < 100; ++i) {
      cameras().publish(goodPair());
    }
    expectRightAgain();
  }
  EXPECT_TRUE(waitFor([&] { return replaced() > before; }));
}

class Sleeper {
 public:
  Sleeper() {
    const std::string name = "__name:=sleeper_" + std::to_string(getpid());
    const std::string name_space = "__ns:=" + ros::this_node::getNamespace();
    const char* arguments[] = {"sleeper", kSleeper, name.c_str(), name_space.c_str(), nullptr};
    if (posix_spawn(&pid_, "/proc/self/exe", nullptr, nullptr, const_cast<char**>(arguments),
                    environ) != 0) {
      throw std::runtime_error("no process for the subscriber");
    }
  }
  ~Sleeper() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  bool sleeps() {
    int status = 0;
    sleeps_ =
        sleeps_ || (waitpid(pid_, &status, WUNTRACED | WNOHANG) == pid_ && WIFSTOPPED(status));
    return sleeps_;
  }

 private:
  pid_t pid_ = 0;
  bool sleeps_ = false;
};

/// A subscriber that no longer reads blocks only itself, and its end has no effect.
TEST_F(TimeFaults, SubscriberThatSleeps) {
  {
    Sleeper sleeper;
    ASSERT_TRUE(waitFor([&] { return sleeper.sleeps(); }, 30));
    for (int i = 0; i < 300; ++i) {  // more than the buffers of its connection can hold
      ASSERT_TRUE(disparityOf(goodPair(), 5));
    }
    expectRightAgain();
  }
  expectRightAgain();
}

/// Subscribes to every large output, and stops reading when the connections are established.
int sleepAsSubscriber() {
  ros::NodeHandle nh;
  Collector<stereo_msgs::DisparityImage> disparity;
  Collector<sensor_msgs::PointCloud2> points;
  disparity.subscribe(nh, "disparity");
  points.subscribe(nh, "points2");
  if (!waitFor([&] { return disparity.isConnected() && points.isConnected(); })) {
    return 1;
  }
  return raise(SIGSTOP);
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == cbmv::kSleeper) {
    ros::init(argc, argv, "sleeper");
    return cbmv::sleepAsSubscriber();
  }
  return cbmv::runRostest(argc, argv);
}
