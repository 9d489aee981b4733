#include "rectification/tracker.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include "evaluation/rendered_scene.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

const DisparityRange kRange{0, 32};

RenderedScene sceneWithOffset(double offset, int width = 251) {
  RenderOptions options;
  options.vertical_offset = offset;
  return renderScene(width, 187, 1, options);
}

/// Passes one pair at a time until `is_done(model)`; gives up after a minute.
template <typename IsDone>
VerticalOffset updateUntil(RectificationTracker& tracker, const RenderedScene& scene, double now_s,
                           IsDone is_done) {
  VerticalOffset model;
  for (int i = 0; i < 20000; ++i) {
    model = tracker.update(scene.left, scene.right, kRange, now_s);
    if (is_done(model)) {
      return model;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ADD_FAILURE() << "the model did not change as expected";
  return model;
}

bool hasEstimate(const VerticalOffset& model) { return model.matches > 0; }

TEST(RectificationTracker, DeliversTheEstimateAfterAWhile) {
  const RenderedScene scene = sceneWithOffset(0.8);
  RectificationTracker tracker({});
  EXPECT_EQ(tracker.update(scene.left, scene.right, kRange, 0.0).matches, 0);
  const VerticalOffset model = updateUntil(tracker, scene, 0.0, hasEstimate);
  const VerticalOffset expected = estimateVerticalOffset(scene.left, scene.right, kRange, {});
  EXPECT_EQ(model.offset_px, expected.offset_px);
  EXPECT_EQ(model.slope_x, expected.slope_x);
  EXPECT_EQ(model.twist, expected.twist);
  EXPECT_EQ(model.curvature_x, expected.curvature_x);
  EXPECT_EQ(model.curvature_y, expected.curvature_y);
  EXPECT_EQ(model.matches, expected.matches);
}

TEST(RectificationTracker, WaitsForTheIntervalAndSmooths) {
  const RenderedScene first = sceneWithOffset(0.4);
  const RenderedScene second = sceneWithOffset(1.2);
  RectificationOptions options;
  options.interval_s = 2.0;
  options.smoothing = 0.75;
  RectificationTracker tracker(options);
  const VerticalOffset before = updateUntil(tracker, first, 10.0, hasEstimate);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(tracker.update(second.left, second.right, kRange, 11.9).offset_px, before.offset_px);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const VerticalOffset after = updateUntil(tracker, second, 12.0, [&](const VerticalOffset& m) {
    return m.offset_px != before.offset_px;
  });
  EXPECT_NEAR(before.offset_px, 0.4, 0.05);
  EXPECT_NEAR(after.offset_px, 0.75 * 0.4 + 0.25 * 1.2, 0.05);
}

TEST(RectificationTracker, MeasurementsAreNotSmoothed) {
  const RenderedScene first = sceneWithOffset(0.4);
  const RenderedScene second = sceneWithOffset(1.2);
  RectificationTracker tracker({});
  EXPECT_EQ(tracker.measurement().model.matches, 0);
  const VerticalOffset before = updateUntil(tracker, first, 10.0, hasEstimate);
  EXPECT_EQ(tracker.measurement().model.offset_px, before.offset_px);
  EXPECT_EQ(tracker.measurement().time_s, 10.0);
  updateUntil(tracker, second, 12.0,
              [&](const VerticalOffset& m) { return m.offset_px != before.offset_px; });
  const auto measurement = tracker.measurement();
  EXPECT_NEAR(measurement.model.offset_px, 1.2, 0.05);
  EXPECT_EQ(measurement.time_s, 12.0);
  EXPECT_GT(measurement.rms_before_px, 5 * measurement.rms_after_px);
  tracker.reset();
  EXPECT_EQ(tracker.measurement().model.matches, 0);
}

TEST(RectificationTracker, PairsWithoutMatchesLeaveTheModel) {
  const RenderedScene scene = sceneWithOffset(0.8);
  const cv::Mat gray(scene.left.size(), CV_8UC1, cv::Scalar(90));
  RectificationOptions options;
  options.interval_s = 0.0;
  RectificationTracker tracker(options);
  const VerticalOffset before = updateUntil(tracker, scene, 0.0, hasEstimate);
  VerticalOffset after;
  for (int i = 0; i < 50; ++i) {
    after = tracker.update(gray, gray, kRange, i);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_NEAR(after.offset_px, before.offset_px, 0.02);
  EXPECT_GT(after.matches, 0);
}

TEST(RectificationTracker, AnAlignedStreamComesBackToExactlyZero) {
  RectificationOptions options;
  options.interval_s = 0.0;
  RectificationTracker tracker(options);
  updateUntil(tracker, sceneWithOffset(0.8), 0.0, hasEstimate);
  updateUntil(tracker, sceneWithOffset(0.0), 1.0,
              [](const VerticalOffset& m) { return m.matches > 0 && m.isZero(); });
}

TEST(RectificationTracker, ResetsOnRequestOnOtherSizesAndWhenTheClockJumpsBack) {
  const RenderedScene scene = sceneWithOffset(0.8);
  const RenderedScene wide = sceneWithOffset(-0.6, 301);
  RectificationOptions options;
  options.smoothing = 0.0;
  RectificationTracker tracker(options);
  updateUntil(tracker, scene, 100.0, hasEstimate);
  tracker.reset();
  EXPECT_EQ(tracker.update(scene.left, scene.right, kRange, 100.0).matches, 0);
  updateUntil(tracker, scene, 100.0, hasEstimate);
  EXPECT_EQ(tracker.update(wide.left, wide.right, kRange, 100.0).matches, 0);
  EXPECT_NEAR(updateUntil(tracker, wide, 100.0, hasEstimate).offset_px, -0.6, 0.05);
  const RenderedScene other = sceneWithOffset(0.6, 301);
  updateUntil(tracker, other, 3.0, [](const VerticalOffset& m) { return m.offset_px > 0.5; });
}

TEST(RectificationTracker, AnEstimateFromBeforeAResetIsDropped) {
  const RenderedScene scene = sceneWithOffset(0.8);
  const cv::Mat gray(scene.left.size(), CV_8UC1, cv::Scalar(90));
  for (const bool reset : {false, true}) {
    RectificationTracker tracker({});
    tracker.update(scene.left, scene.right, kRange, 0.0);
    if (reset) {
      tracker.reset();
    }
    tracker.waitForEstimate();
    EXPECT_EQ(tracker.update(gray, gray, kRange, 0.0).matches == 0, reset);
  }
}

TEST(RectificationTracker, DisabledItNeverCorrects) {
  const RenderedScene scene = sceneWithOffset(0.8);
  RectificationOptions options;
  options.enabled = false;
  RectificationTracker tracker(options);
  tracker.update(scene.left, scene.right, kRange, 0.0);
  tracker.waitForEstimate();
  EXPECT_EQ(tracker.update(scene.left, scene.right, kRange, 10.0).matches, 0);
}

TEST(RectificationTracker, RejectsOtherImages) {
  const cv::Mat gray = cv::Mat::zeros(40, 40, CV_8UC1);
  RectificationTracker tracker({});
  EXPECT_THROW(tracker.update(gray, gray.rowRange(0, 30), kRange, 0.0), Error);
  EXPECT_THROW(tracker.update(gray, cv::Mat::zeros(40, 40, CV_8UC3), kRange, 0.0), Error);
}

TEST(RectificationTracker, ServesSeveralThreads) {
  const RenderedScene scene = sceneWithOffset(0.8);
  RectificationOptions options;
  options.interval_s = 0.0;
  RectificationTracker tracker(options);
  std::atomic<int> wrong{0};
  std::array<std::thread, 4> threads;
  for (std::size_t t = 0; t < threads.size(); ++t) {
    threads[t] = std::thread([&, t] {
      for (int i = 0; i < 100; ++i) {
        const VerticalOffset model = tracker.update(scene.left, scene.right, kRange, i);
        wrong += model.matches > 0 && std::abs(model.offset_px - 0.8) > 0.05 ? 1 : 0;
        if (t == 0 && i % 25 == 24) {
          tracker.reset();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(wrong, 0);
  // The tracker still works after the last reset.
  tracker.reset();
  tracker.waitForEstimate();
  tracker.update(scene.left, scene.right, kRange, 0.0);
  tracker.waitForEstimate();
  EXPECT_NEAR(tracker.update(scene.left, scene.right, kRange, 0.0).offset_px, 0.8, 0.05);
}

/// Uses mallinfo2 if available. mallinfo counts in int and is deprecated then.
std::size_t allocatedBytes() {
#if __GLIBC_PREREQ(2, 33)
  return mallinfo2().uordblks;
#else
  return static_cast<unsigned>(mallinfo().uordblks);
#endif
}

/// The minimum over some time, in which the worker releases the last pair.
std::size_t bytesInUse() {
  std::size_t least = allocatedBytes();
  for (int i = 0; i < 250; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    least = std::min(least, allocatedBytes());
  }
  return least;
}

/// OpenCV keeps memory per thread that called it.
TEST(RectificationTracker, KeepsNoMemoryOfEarlierEstimates) {
  const RenderedScene scene = sceneWithOffset(0.8);
  RectificationOptions options;
  options.interval_s = 0.5;
  RectificationTracker tracker(options);
  double now_s = 0.0;
  const auto estimate = [&](int times) {
    for (int i = 0; i < times; ++i) {
      now_s += 1.0;
      updateUntil(tracker, scene, now_s,
                  [&](const VerticalOffset&) { return tracker.measurement().time_s == now_s; });
    }
  };
  estimate(20);
  const std::size_t before = bytesInUse();
  estimate(100);
  EXPECT_LT(bytesInUse(), before + 20000);
}

/// Does not change the hard limit, which cannot be raised again without privileges.
void setAddressSpace(rlim_t most) {
  rlimit limits{};
  getrlimit(RLIMIT_AS, &limits);
  limits.rlim_cur = std::min(most, limits.rlim_max);
  if (setrlimit(RLIMIT_AS, &limits) != 0) {
    std::_Exit(2);
  }
}

/// Limits the address space of this process to its current size plus `more_mb`.
void limitAddressSpace(double more_mb) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const auto more = static_cast<rlim_t>(more_mb * (1 << 20));
  setAddressSpace(pages * static_cast<rlim_t>(sysconf(_SC_PAGE_SIZE)) + more);
}

/// Without memory for the stack of a thread, the stream continues and estimates come later.
TEST(RectificationTrackerDeathTest, NeedsNoThreadToGoOn) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";  // no stacks of finished threads
  const auto run = [] {
    const RenderedScene scene = sceneWithOffset(0.8);
    RectificationTracker tracker({});
    limitAddressSpace(2);
    const bool none = tracker.update(scene.left, scene.right, kRange, 0.0).matches == 0;
    setAddressSpace(RLIM_INFINITY);
    const bool found = hasEstimate(updateUntil(tracker, scene, 1.0, hasEstimate));
    std::_Exit(none && found ? 0 : 1);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace cbmv
