#include "ros/frame_worker.h"

#include <future>
#include <vector>

#include <boost/make_shared.hpp>
#include <gtest/gtest.h>

namespace cbmv {
namespace {

StereoMessages numberedFrame(std::uint32_t number) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->header.seq = number;
  return {image, nullptr, nullptr, nullptr};
}

TEST(FrameWorker, WorksOnTheNewestFrame) {
  std::promise<void> started;
  std::promise<void> may_go_on;
  std::promise<void> finished;
  std::vector<std::uint32_t> worked_on;
  {
    FrameWorker worker([&](const StereoMessages& frame) {
      worked_on.push_back(frame.left_image->header.seq);
      if (worked_on.size() == 1) {
        started.set_value();
        may_go_on.get_future().wait();
      } else {
        finished.set_value();
      }
    });
    EXPECT_FALSE(worker.submit(numberedFrame(1)));
    started.get_future().wait();
    EXPECT_FALSE(worker.submit(numberedFrame(2)));
    EXPECT_TRUE(worker.submit(numberedFrame(3)));
    EXPECT_TRUE(worker.submit(numberedFrame(4)));
    may_go_on.set_value();
    finished.get_future().wait();
  }
  EXPECT_EQ(worked_on, (std::vector<std::uint32_t>{1, 4}));
}

TEST(FrameWorker, EndsAfterTheFrameInWork) {
  std::promise<void> started;
  std::atomic<int> worked_on{0};
  {
    FrameWorker worker([&](const StereoMessages&) {
      started.set_value();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      ++worked_on;
    });
    worker.submit(numberedFrame(1));
    started.get_future().wait();
    worker.submit(numberedFrame(2));
  }
  EXPECT_EQ(worked_on, 1);  // the one that waited was dropped
}

TEST(FrameWorker, EndsWithoutAFrame) {
  FrameWorker worker([](const StereoMessages&) {});
}

}  // namespace
}  // namespace cbmv
