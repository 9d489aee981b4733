// Run by faults_sim_time.test: a node on simulated time that stops, jumps back and jumps far ahead.

#include <mutex>

#include <rosgraph_msgs/Clock.h>

#include "ros/fault_fixture.h"
#include "ros/rostest_main.h"

namespace cbmv {
namespace {

/// Publishes the time repeatedly.
class Clock {
 public:
  Clock() : publisher_(nh_.advertise<rosgraph_msgs::Clock>("/clock", 10)) {}

  /// Returns when this process has received the time, too.
  void set(const ros::Time& time) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      time_ = time;
    }
    ASSERT_TRUE(waitFor([&] { return ros::Time::now() == time; }));
    wait(0.1);
  }

 private:
  void publish() {
    rosgraph_msgs::Clock message;
    const std::lock_guard<std::mutex> lock(mutex_);
    message.clock = time_;
    publisher_.publish(message);
  }

  ros::NodeHandle nh_;
  ros::Publisher publisher_;
  std::mutex mutex_;
  ros::Time time_{1000};
  Feeder feeder_{0.02, [this] { publish(); }};
};

class SimulatedTime : public FaultTest {
 protected:
  static void SetUpTestSuite() {
    clock = std::make_unique<Clock>();
    clock->set(ros::Time(1000));
    FaultTest::SetUpTestSuite();
  }
  static void TearDownTestSuite() {
    FaultTest::TearDownTestSuite();
    clock.reset();
  }
  static inline std::unique_ptr<Clock> clock;
};

TEST_F(SimulatedTime, MayStandStill) {
  for (int i = 0; i < 3; ++i) {
    expectRightAgain();
    expectDiagnostic("Input", Level::WARN, "stamps were repeated on ");
  }
}

TEST_F(SimulatedTime, MayJumpBackAndFarAhead) {
  for (const double time_s : {2000.0, 10.0, 4e9, 500.0, 0.5}) {
    SCOPED_TRACE(time_s);
    clock->set(ros::Time(time_s));
    expectRightAgain();
    expectDiagnostic("Method", Level::OK, "ms per frame");  // diagnostics continue
  }
  expectDiagnostic("Input", Level::WARN, "stamps went back on ");
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
