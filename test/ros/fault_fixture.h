#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "ros/diagnostics_reader.h"
#include "ros/stereo_client.h"

namespace cbmv {

/// Publishes continuously in its own thread until destroyed.
class Feeder {
 public:
  Feeder(double period_s, std::function<void()> publish)
      : thread_([this, period_s, publish = std::move(publish)] {
          while (!stopping_ && ros::ok()) {
            publish();
            ros::WallDuration(period_s).sleep();
          }
        }) {}
  ~Feeder() {
    stopping_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// A node that gets faulty input and must process the next good pair correctly. Images are small.
class FaultTest : public ::testing::Test {
 public:
  using Level = diagnostic_msgs::DiagnosticStatus;

  static StereoOptions testOptions() {
    StereoOptions options;
    options.range = {0, 16};
    options.rectification.enabled = false;  // estimates depend on arrival times
    return options;
  }

 protected:
  /// Creates one client for all tests, and the reference output of the pair.
  static void SetUpTestSuite() {
    shared = std::make_unique<Shared>();
    shared->client.setOptions(testOptions());  // wait until the node is up
    subscribe();
    const auto undisturbed = disparityOfAGoodPair();
    ASSERT_TRUE(undisturbed);
    shared->undisturbed = *undisturbed;
  }
  static void TearDownTestSuite() { shared.reset(); }

  static void subscribe() {
    shared->client.disparity.subscribe(shared->nh, "disparity");
    shared->client.points.subscribe(shared->nh, "points2");
    ASSERT_TRUE(waitFor([] {
      return shared->client.cameras.pairIsWanted() && shared->client.disparity.isConnected() &&
             shared->client.points.isConnected();
    }));
  }

  /// Makes the node wait for input again, so that earlier reports do not count.
  static void subscribeAnew() {
    shared->client.unsubscribeAll();
    ASSERT_TRUE(waitFor([] { return !shared->client.cameras.anyIsWanted(); }));
    subscribe();
  }

  static PairMessages goodPair(ros::Time stamp = ros::Time::now()) {
    return makeMessages(shared->pair, {}, stamp);
  }

  /// Null if no disparity arrives.
  static stereo_msgs::DisparityImageConstPtr disparityOf(const PairMessages& messages,
                                                         double timeout_s = 20) {
    const ros::Time stamp = messages.left_image->header.stamp;
    Collector<stereo_msgs::DisparityImage>& received = shared->client.disparity;
    received.forget(stamp);
    shared->client.cameras.publish(messages);
    waitFor([&] { return received.has(stamp); }, timeout_s);
    return received.has(stamp) ? boost::make_shared<stereo_msgs::DisparityImage>(received.at(stamp))
                               : nullptr;
  }
  static stereo_msgs::DisparityImageConstPtr disparityOfAGoodPair() {
    return disparityOf(goodPair());
  }

  static void expectSame(const stereo_msgs::DisparityImage& found) {
    const stereo_msgs::DisparityImage& wanted = shared->undisturbed;
    EXPECT_EQ(found.f, wanted.f);
    EXPECT_EQ(found.T, wanted.T);
    EXPECT_EQ(found.min_disparity, wanted.min_disparity);
    EXPECT_EQ(found.max_disparity, wanted.max_disparity);
    EXPECT_EQ(found.image.width, wanted.image.width);
    EXPECT_EQ(found.image.height, wanted.image.height);
    EXPECT_TRUE(found.image.data == wanted.image.data) << "the disparities differ";
  }

  /// Checks that the next good pair is published correctly.
  static void expectRightAgain(ros::Time stamp = ros::Time::now()) {
    const auto disparity = disparityOf(goodPair(stamp));
    ASSERT_TRUE(disparity) << "nothing came of a good pair; diagnostics say: "
                           << shared->diagnostics.newestMessage("Calibration") << "; "
                           << shared->diagnostics.newestMessage("Output");
    expectSame(*disparity);
  }

  static void expectDiagnostic(
      const std::string& name, int level, const std::string& words,
      const std::function<void()>& meanwhile = [] {}) {
    shared->diagnostics.clear();
    EXPECT_TRUE(shared->diagnostics.waitFor(name, level, words, meanwhile))
        << name << " does not say '" << words
        << "' but: " << shared->diagnostics.newestMessage(name);
  }

  /// Checks that the pair changed by `spoil` is rejected and that the diagnostics contain `words`.
  static void expectRejected(const std::function<void(PairMessages&)>& spoil,
                             const std::string& words) {
    SCOPED_TRACE(words);
    PairMessages messages = goodPair();
    spoil(messages);
    const ros::Time stamp = messages.left_image->header.stamp;
    shared->client.cameras.publish(messages);
    expectDiagnostic("Calibration", Level::ERROR, words);
    EXPECT_FALSE(shared->client.disparity.has(stamp));
    expectRightAgain();
  }

  struct Shared {
    ros::NodeHandle nh;
    StereoClient client;
    DiagnosticsReader diagnostics{nh.resolveName("cbmv_stereo").substr(1)};
    StereoPair pair = renderPair({61, 43}, 4, 9);
    stereo_msgs::DisparityImage undisturbed;
  };
  static inline std::unique_ptr<Shared> shared;
};

}  // namespace cbmv
