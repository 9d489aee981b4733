// Publishes pairs to a running node at multiples of its highest rate, and measures the output.
// scripts/soak starts the node and this program, and evaluates the results.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <ros/ros.h>
#include <stereo_msgs/DisparityImage.h>
#include <sys/types.h>

#include "ros/cameras.h"

#include <cbmv_stereo/Status.h>

namespace cbmv {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;
using nlohmann::json;

constexpr double kTimeoutS = 120;  // per frame
constexpr int kDifferentPairs = 4;

struct Arguments {
  int width = 640;
  int height = 480;
  int disparities = 64;
  std::vector<double> factors = {1, 2, 5};
  double phase_s = 20;   ///< duration per factor
  double warm_up_s = 5;  ///< one frame at a time; gives the frame time of the node
  pid_t pid = 0;
  std::string output;
};

/// Process data from the kernel.
struct ProcessState {
  double resident_mb = 0;
  double peak_resident_mb = 0;
  double peak_virtual_mb = 0;
  double threads = 0;

  static ProcessState read(pid_t pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/status");
    if (!file) {
      throw std::runtime_error("the node has died");
    }
    ProcessState state;
    for (std::string line; std::getline(file, line);) {
      const auto value = [&line] { return std::stod(line.substr(line.find(':') + 1)); };
      if (line.rfind("VmRSS:", 0) == 0) {
        state.resident_mb = value() / 1024;
      } else if (line.rfind("VmHWM:", 0) == 0) {
        state.peak_resident_mb = value() / 1024;
      } else if (line.rfind("VmPeak:", 0) == 0) {
        state.peak_virtual_mb = value() / 1024;
      } else if (line.rfind("Threads:", 0) == 0) {
        state.threads = value();
      }
    }
    return state;
  }
};

/// Result of one frame.
struct Result {
  ros::Time stamp;
  double age_ms = 0;      ///< from the stamp to the arrival of the disparity
  double compute_ms = 0;  ///< from Status; 0 if the Status message was lost
};

/// Quantile `q` of the values; 0 if there are none.
double quantile(std::vector<double> values, double q) {
  if (values.empty()) {
    return 0;
  }
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(q * (values.size() - 1.0)))];
}

double median(const std::vector<double>& values) { return quantile(values, 0.5); }

std::vector<double> valuesOf(const std::vector<Result>& results, double Result::*member) {
  std::vector<double> values(results.size());
  std::transform(results.begin(), results.end(), values.begin(), std::mem_fn(member));
  return values;
}

/// Receives disparities and the Status messages for them.
class ResultReader {
 public:
  explicit ResultReader(ros::NodeHandle nh) {
    using Disparity = stereo_msgs::DisparityImage;
    disparities_ = nh.subscribe<Disparity>(
        "disparity", 100, [this](const boost::shared_ptr<const Disparity>& message) {
          const double age_ms = (ros::Time::now() - message->header.stamp).toSec() * 1000;
          const std::lock_guard<std::mutex> lock(mutex_);
          received_.push_back({message->header.stamp, age_ms, 0});
        });
    statuses_ = nh.subscribe<cbmv_stereo::Status>(
        "status", 100, [this](const cbmv_stereo::StatusConstPtr& status) {
          const std::lock_guard<std::mutex> lock(mutex_);
          newest_status_ = *status;
          compute_ms_[status->header.stamp] = status->total_ms;
        });
  }

  bool isConnected() const {
    return disparities_.getNumPublishers() > 0 && statuses_.getNumPublishers() > 0;
  }
  bool has(ros::Time stamp) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return !received_.empty() && received_.back().stamp == stamp && compute_ms_.count(stamp) > 0;
  }
  cbmv_stereo::Status newestStatus() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return newest_status_;
  }

  /// All results since the last call, in order of arrival.
  std::vector<Result> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (Result& result : received_) {
      result.compute_ms = compute_ms_[result.stamp];
    }
    compute_ms_.clear();
    return std::exchange(received_, {});
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Result> received_;
  std::map<ros::Time, double> compute_ms_;
  cbmv_stereo::Status newest_status_;
  ros::Subscriber disparities_;
  ros::Subscriber statuses_;
};

/// Two cameras that alternate between a few pairs.
class Source {
 public:
  explicit Source(const Arguments& arguments) {
    const cv::Size size(arguments.width, arguments.height);
    for (int i = 0; i < kDifferentPairs; ++i) {
      const StereoPair pair =
          renderPair(size, arguments.disparities / 4, arguments.disparities / 2, i + 1);
      messages_.push_back(makeMessages(pair, {}, ros::Time()));
    }
  }

  bool isWanted() const { return cameras_.pairIsWanted(); }

  /// Returns the stamp.
  ros::Time publish() {
    PairMessages& messages = messages_[published_++ % messages_.size()];
    const ros::Time stamp = ros::Time::now();
    messages.left_image->header.stamp = messages.left_info->header.stamp = stamp;
    messages.right_image->header.stamp = messages.right_info->header.stamp = stamp;
    cameras_.publish(messages);
    return stamp;
  }
  std::uint64_t published() const { return published_; }

 private:
  Cameras cameras_;
  std::vector<PairMessages> messages_;
  std::uint64_t published_ = 0;
};

void waitFor(const std::function<bool()>& done, pid_t pid, const char* what) {
  const auto end = Clock::now() + Seconds(kTimeoutS);
  while (!done()) {
    if (!ros::ok() || Clock::now() > end) {
      throw std::runtime_error(std::string("waited in vain for ") + what);
    }
    ProcessState::read(pid);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

class Soak {
 public:
  explicit Soak(const Arguments& arguments)
      : arguments_(arguments), source_(arguments), reader_(ros::NodeHandle()) {}

  json run() {
    waitFor([&] { return source_.isWanted() && reader_.isConnected(); }, arguments_.pid,
            "the node");
    measureFrameTime();
    json phases = json::array();
    for (const double factor : arguments_.factors) {
      phases.push_back(runPhase(factor));
    }
    const ProcessState state = ProcessState::read(arguments_.pid);
    return {{"frame_ms", frame_ms_},
            {"overhead_ms", overhead_ms_},
            {"peak_resident_mb", state.peak_resident_mb},
            {"peak_virtual_mb", state.peak_virtual_mb},
            {"phases", phases}};
  }

 private:
  /// Sends one frame at a time to measure the frame time of the node.
  void measureFrameTime() {
    const auto end = Clock::now() + Seconds(arguments_.warm_up_s);
    do {
      const ros::Time stamp = source_.publish();
      waitFor([&] { return reader_.has(stamp); }, arguments_.pid, "a frame");
    } while (Clock::now() < end);
    std::vector<Result> results = reader_.take();
    results.erase(results.begin(), results.begin() + static_cast<long>(results.size() / 4));
    frame_ms_ = median(valuesOf(results, &Result::age_ms));
    overhead_ms_ = frame_ms_ - median(valuesOf(results, &Result::compute_ms));
  }

  json runPhase(double factor) {
    const double rate_hz = factor * 1000 / frame_ms_;
    // Runs at this rate first, because queues and buffers that it fills do not count as growth.
    publishFor(std::max(1.0, std::min(arguments_.warm_up_s, 0.2 * arguments_.phase_s)), rate_hz);
    reader_.take();
    const cbmv_stereo::Status before = reader_.newestStatus();
    const std::uint64_t published_before = source_.published();
    const auto start = Clock::now();
    samples_.clear();
    publishFor(arguments_.phase_s, rate_hz);
    const double elapsed_s = Seconds(Clock::now() - start).count();
    const std::uint64_t published = source_.published() - published_before;
    const ros::Time last = source_.publish();  // not counted; arrives after all others
    waitFor([&] { return reader_.has(last); }, arguments_.pid, "the last frame");
    std::vector<Result> results = reader_.take();
    results.pop_back();
    json phase = {{"factor", factor},
                  {"seconds", elapsed_s},
                  {"wanted_hz", rate_hz},
                  {"published_hz", published / elapsed_s},
                  {"output_hz", results.size() / elapsed_s},
                  {"frames", results.size()},
                  {"drops", drops(before, published)},
                  {"memory", memory()}};
    phase.update(ages(results));
    phase.update(order(results));
    return phase;
  }

  void publishFor(double time_s, double rate_hz) {
    const auto start = Clock::now();
    const auto end = start + Seconds(time_s);
    auto next_sample = start;
    for (auto due = Seconds(0); start + due < end; due += Seconds(1 / rate_hz)) {
      std::this_thread::sleep_until(start + due);
      source_.publish();
      if (Clock::now() >= next_sample) {
        samples_.push_back(ProcessState::read(arguments_.pid));
        next_sample = Clock::now() + std::chrono::milliseconds(200);
      }
    }
  }

  json drops(const cbmv_stereo::Status& before, std::uint64_t published) const {
    const cbmv_stereo::Status now = reader_.newestStatus();
    const std::uint64_t busy = now.dropped_busy - before.dropped_busy;
    const std::uint64_t bad = now.dropped_bad_input - before.dropped_bad_input;
    const std::uint64_t failed = now.dropped_failed - before.dropped_failed;
    const std::uint64_t seen = now.frames_processed - before.frames_processed + busy + bad + failed;
    // The first may be from before the phase, the last one from after it.
    const auto lost = static_cast<std::int64_t>(published + 1) - static_cast<std::int64_t>(seen);
    return {{"replaced_by_newer", busy},
            {"bad_input", bad},
            {"failed", failed},
            {"before_the_node", lost}};
  }

  /// Medians over parts of the time, including the first and the last tenth.
  json memory() const {
    const std::size_t tenth = std::max<std::size_t>(1, samples_.size() / 10);
    const std::size_t first_of_last = samples_.size() - tenth;
    const auto resident = [this](std::size_t begin, std::size_t count) {
      return medianOf(&ProcessState::resident_mb, begin, count);
    };
    const double start_mb = resident(0, tenth);
    const double end_mb = resident(first_of_last, tenth);
    json parts = json::array();
    const std::size_t part = std::max<std::size_t>(1, samples_.size() / 40);
    for (std::size_t begin = 0; begin + part <= samples_.size(); begin += part) {
      parts.push_back(resident(begin, part));
    }
    return {{"start_mb", start_mb},
            {"end_mb", end_mb},
            {"growth_percent", 100 * (end_mb / start_mb - 1)},
            {"by_time_mb", parts},
            {"threads_start", medianOf(&ProcessState::threads, 0, tenth)},
            {"threads_end", medianOf(&ProcessState::threads, first_of_last, tenth)}};
  }

  double medianOf(double ProcessState::*member, std::size_t begin, std::size_t count) const {
    std::vector<double> values;
    for (std::size_t i = begin; i < begin + count; ++i) {
      values.push_back(samples_[i].*member);
    }
    return median(values);
  }

  /// A frame waits at most for one frame in progress. Ages are given as multiples of the longer
  /// frame time of the two, so that other load on the machine has little effect.
  json ages(const std::vector<Result>& results) const {
    std::vector<double> frames;
    double time_before_ms = 0;
    for (const Result& result : results) {
      const double time_ms = result.compute_ms > 0 ? result.compute_ms + overhead_ms_ : frame_ms_;
      frames.push_back(result.age_ms / std::max(time_ms, time_before_ms));
      time_before_ms = time_ms;
    }
    const auto summary = [](const std::vector<double>& values) {
      return json{
          {"p50", median(values)}, {"p99", quantile(values, 0.99)}, {"max", quantile(values, 1)}};
    };
    return {{"compute_ms", median(valuesOf(results, &Result::compute_ms))},
            {"age_ms", summary(valuesOf(results, &Result::age_ms))},
            {"age_frames", summary(frames)}};
  }

  static json order(const std::vector<Result>& results) {
    int out_of_order = 0;
    int repeated = 0;
    for (std::size_t i = 1; i < results.size(); ++i) {
      out_of_order += results[i].stamp < results[i - 1].stamp;
      repeated += results[i].stamp == results[i - 1].stamp;
    }
    return {{"out_of_order", out_of_order}, {"published_twice", repeated}};
  }

  const Arguments arguments_;
  Source source_;
  ResultReader reader_;
  double frame_ms_ = 0;
  double overhead_ms_ = 0;  ///< per frame, without the method
  std::vector<ProcessState> samples_;
};

int run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Loads a node with pairs and measures what comes out.");
  app.add_option("--width", arguments.width)->required();
  app.add_option("--height", arguments.height)->required();
  app.add_option("--disparities", arguments.disparities)->required();
  app.add_option("--factors", arguments.factors)->required();
  app.add_option("--phase-s", arguments.phase_s)->required();
  app.add_option("--warm-up-s", arguments.warm_up_s)->required();
  app.add_option("--pid", arguments.pid, "of the node")->required();
  app.add_option("--output", arguments.output, "JSON")->required();
  CLI11_PARSE(app, argc, argv);
  ros::AsyncSpinner spinner(2);
  spinner.start();
  const json report = Soak(arguments).run();
  std::ofstream(arguments.output) << report.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) {
  ros::init(argc, argv, "soak_driver");
  const ros::NodeHandle keeps_ros_alive;
  try {
    return cbmv::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "soak_driver: " << error.what() << "\n";
    return 1;
  }
}
