#include <cstdio>
#include <fstream>

#include <nlohmann/json.hpp>

#include "offline/bag_processing.h"

namespace cbmv {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

std::string count(std::size_t value, const std::string& what) {
  return value == 0 ? std::string() : "  " + std::to_string(value) + " " + what + "\n";
}

std::size_t framesDone(const BagProcessingSummary& summary) {
  return summary.resumed + summary.processed - summary.failed;
}

double perFrame(double seconds, std::size_t frames) {
  return frames > 0 ? seconds / static_cast<double>(frames) : 0;
}

double framesPerSecond(const BagProcessingSummary& summary) {
  return summary.seconds > 0 ? static_cast<double>(summary.processed) / summary.seconds : 0;
}

/// Peak memory of this process, including files that it reads, MB of 2^20 bytes.
double peakMemoryMb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) {
      return std::stod(line.substr(6)) / 1024;
    }
  }
  return 0;
}

}  // namespace

std::string describeSummary(const BagProcessingSummary& summary) {
  const FramePlan& plan = summary.plan;
  std::string text = std::to_string(framesDone(summary)) + " of " +
                     std::to_string(plan.framesToProcess()) + " frames done";
  if (summary.failed > 0) {
    text += ", " + std::to_string(summary.failed) + " failed";
  }
  if (summary.resumed > 0) {
    text += ", " + std::to_string(summary.resumed) + " processed earlier";
  }
  if (summary.processed > 0) {
    text += "; " + number(framesPerSecond(summary)) + " frames/s, " +
            number(1000 * perFrame(summary.matching_seconds, summary.processed)) +
            " ms wall time per frame, " + std::to_string(summary.threads) + " threads";
  }
  text += "\n";
  text += "  " + plan.topics.rectification + "\n";
  text += count(plan.left_alone, "left images have no partner on " + plan.topics.right.name);
  text += count(plan.right_alone, "right images have no partner on " + plan.topics.left.name);
  text += count(plan.repeated_stamps, "images have a repeated stamp and no partner");
  text += count(plan.infos_of_other_stamps,
                "frames have no camera_info with their stamp and use the last one before");
  for (const auto& [reason, frames] : summary.failures) {
    text += "    " + std::to_string(frames) + " times: " + reason + "\n";
  }
  for (const std::string& damage : summary.damages) {
    text += "  " + damage + "\n";
  }
  for (const std::string& problem : summary.problems) {
    text += "  " + problem + "\n";
  }
  for (const std::string& warning : summary.warnings) {
    text += "  warning: " + warning + "\n";
  }
  return text;
}

std::string summaryJson(const BagProcessingSummary& summary) {
  const FramePlan& plan = summary.plan;
  const nlohmann::json json = {
      {"left_topic", plan.topics.left.name},
      {"right_topic", plan.topics.right.name},
      {"rectified_by_us", plan.topics.left.raw},
      {"rectification", plan.topics.rectification},
      {"frames", plan.framesToProcess()},
      {"frames_processed", summary.processed},
      {"frames_resumed", summary.resumed},
      {"frames_failed", summary.failed},
      {"failures", summary.failures},
      {"left_images", plan.left_images},
      {"right_images", plan.right_images},
      {"left_images_without_partner", plan.left_alone},
      {"right_images_without_partner", plan.right_alone},
      {"repeated_stamps", plan.repeated_stamps},
      {"camera_infos_of_other_stamps", plan.infos_of_other_stamps},
      {"pairs_of_equal_stamps", plan.equal_stamps},
      {"damaged_bags", summary.damages},
      {"problems", summary.problems},
      {"warnings", summary.warnings},
      {"complete", summary.isComplete()},
      {"seconds", summary.seconds},
      {"frames_per_second", framesPerSecond(summary)},
      {"matching_ms", 1000 * perFrame(summary.matching_seconds, summary.processed)},
      {"cpu_ms", 1000 * perFrame(summary.cpu_seconds, summary.processed)},
      {"peak_memory_mb", peakMemoryMb()},
      {"threads", summary.threads}};
  return json.dump(2) + "\n";
}

}  // namespace cbmv
