#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "ros/input_messages.h"

namespace cbmv {

/// One thread that works on the newest frame. A frame that comes while another one waits replaces
/// it, so submitting never blocks and the age of results does not grow.
class FrameWorker {
 public:
  /// `work` is called in the worker's thread and must not throw.
  explicit FrameWorker(std::function<void(const StereoMessages&)> work);
  /// Waits for the frame that is being worked on; a waiting frame is dropped.
  ~FrameWorker();
  FrameWorker(const FrameWorker&) = delete;
  FrameWorker& operator=(const FrameWorker&) = delete;

  /// Returns true if a frame that was waiting has been replaced.
  bool submit(StereoMessages frame);

 private:
  void run();
  std::optional<StereoMessages> waitForFrame();

  std::function<void(const StereoMessages&)> work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<StereoMessages> waiting_;
  bool stopping_ = false;
  std::thread thread_;  ///< the last member: starts when the others are there
};

}  // namespace cbmv
