#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace cbmv {

/// Processes frames on one thread, always the newest. A new frame replaces a waiting one, so
/// submit() never blocks and results do not lag behind.
template <typename Frame>
class FrameWorker {
 public:
  /// `work` is called on the thread of the worker and must not throw.
  explicit FrameWorker(std::function<void(const Frame&)> work)
      : work_(std::move(work)), thread_([this] { run(); }) {}

  /// Waits until the current frame is processed. Drops a waiting frame.
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

  /// Returns true if the frame replaced a waiting one.
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
  std::thread thread_;  ///< last member: it uses the others from its start
};

}  // namespace cbmv
