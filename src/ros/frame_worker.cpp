#include "ros/frame_worker.h"

#include <utility>

namespace cbmv {

FrameWorker::FrameWorker(std::function<void(const StereoMessages&)> work)
    : work_(std::move(work)), thread_([this] { run(); }) {}

FrameWorker::~FrameWorker() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

bool FrameWorker::submit(StereoMessages frame) {
  bool replaced = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    replaced = waiting_.has_value();
    waiting_ = std::move(frame);
  }
  changed_.notify_one();
  return replaced;
}

void FrameWorker::run() {
  while (const auto frame = waitForFrame()) {
    work_(*frame);
  }
}

std::optional<StereoMessages> FrameWorker::waitForFrame() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || waiting_.has_value(); });
  if (stopping_) {
    return std::nullopt;
  }
  return std::exchange(waiting_, std::nullopt);
}

}  // namespace cbmv
