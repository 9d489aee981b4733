#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace cbmv {

/// One thread that works on the newest frame. A frame that comes while another one waits replaces
/// it, so submitting never blocks and the age of results does not grow.
template <typename Frame>
class FrameWorker {
 public:
  /// `work` is called in the worker's thread and must not throw.
  explicit FrameWorker(std::function<void(const Frame&)> work)
      : work_(std::move(work)), thread_([this] { run(); }) {}

  /// Waits for the frame that is being worked on; a waiting frame is dropped.
  ~FrameWorker() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  FrameWorker(const FrameWorker&) = delete;
  FrameWorker& operator=(const FrameWorker&) = delete;

  /// Returns true if a frame that was waiting has been replaced.
  bool submit(Frame frame) {
    bool replaced = false;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      replaced = waiting_.has_value();
      waiting_ = std::move(frame);
    }
    changed_.notify_one();
    return replaced;
  }

 private:
  void run() {
    while (const auto frame = waitForFrame()) {
      work_(*frame);
    }
  }

  std::optional<Frame> waitForFrame() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return stopping_ || waiting_.has_value(); });
    if (stopping_) {
      return std::nullopt;
    }
    return std::exchange(waiting_, std::nullopt);
  }

  std::function<void(const Frame&)> work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Frame> waiting_;
  bool stopping_ = false;
  std::thread thread_;  ///< the last member: starts when the others are there
};

}  // namespace cbmv
