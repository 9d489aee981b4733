#include "ros/guarded.h"

#include <chrono>
#include <future>
#include <stdexcept>

#include <boost/make_shared.hpp>
#include <gtest/gtest.h>
#include <nodelet/detail/callback_queue_manager.h>
#include <ros/callback_queue_interface.h>

namespace cbmv {
namespace {

TEST(Guarded, CallsBackAndLetsNothingThrough) {
  int calls = 0;
  guarded("name", [&calls] { ++calls; });
  EXPECT_NO_THROW(guarded("name", [&calls] {
    ++calls;
    throw std::runtime_error("a cause");
  }));
  EXPECT_EQ(calls, 2);
}

TEST(StartNodelet, StopsWhatCannotStartAndThrowsOn) {
  int stops = 0;
  const auto stop = [&stops] { ++stops; };
  startNodelet(
      "name", [] {}, stop);
  EXPECT_EQ(stops, 0);
  EXPECT_THROW(startNodelet(
                   "name", [] { throw std::runtime_error("a cause"); }, stop),
               std::runtime_error);
  EXPECT_EQ(stops, 1);
}

/// Sets `called` when the queue calls it.
class Notice : public ros::CallbackInterface {
 public:
  CallResult call() override {
    called.set_value();
    return Success;
  }
  std::promise<void> called;
};

TEST(AcceptCallbacks, LetsAPausedQueueCall) {
  nodelet::detail::CallbackQueueManager manager(1);
  const auto queue = boost::make_shared<nodelet::detail::CallbackQueue>(&manager);
  manager.addQueue(queue, false);
  queue->disable();  // as nodelet 1.10.0 does before onInit()
  acceptCallbacks(*queue);
  const auto notice = boost::make_shared<Notice>();
  queue->addCallback(notice);
  EXPECT_EQ(notice->called.get_future().wait_for(std::chrono::seconds(30)),
            std::future_status::ready);
  manager.removeQueue(queue);
}

}  // namespace
}  // namespace cbmv
