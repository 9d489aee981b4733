#include "base/frame_worker.h"

#include <atomic>
#include <chrono>
#include <future>
#include <vector>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

using Frame = int;

TEST(FrameWorker, WorksOnTheNewestFrame) {
  std::promise<void> started;
  std::promise<void> may_go_on;
  std::promise<void> finished;
  std::vector<Frame> worked_on;
  {
    FrameWorker<Frame> worker([&](const Frame& frame) {
      worked_on.push_back(frame);
      if (worked_on.size() == 1) {
        started.set_value();
        may_go_on.get_future().wait();
      } else {
        finished.set_value();
      }
    });
    EXPECT_FALSE(worker.submit(1));
    started.get_future().wait();
    EXPECT_FALSE(worker.submit(2));
    EXPECT_TRUE(worker.submit(3));
    EXPECT_TRUE(worker.submit(4));
    may_go_on.set_value();
    finished.get_future().wait();
  }
  EXPECT_EQ(worked_on, (std::vector<Frame>{1, 4}));
}

TEST(FrameWorker, EndsAfterTheFrameInWork) {
  std::promise<void> started;
  std::atomic<int> worked_on{0};
  {
    FrameWorker<Frame> worker([&](const Frame&) {
      started.set_value();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      ++worked_on;
    });
    worker.submit(1);
    started.get_future().wait();
    worker.submit(2);
  }
  EXPECT_EQ(worked_on, 1);  // the waiting one was dropped
}

TEST(FrameWorker, EndsWithoutAFrame) {
  FrameWorker<Frame> worker([](const Frame&) {});
}

}  // namespace
}  // namespace cbmv
