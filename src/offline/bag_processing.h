#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "offline/frame_outputs.h"
#include "offline/frame_plan.h"
#include "offline/prepared_frame.h"
#include "offline/segments.h"
#include "offline/shard.h"

namespace cbmv {

struct BagProcessingOptions {
  std::vector<std::string> inputs;
  std::string output;  ///< bag or folder
  /// Format of the files in the folder; not set: write a bag.
  std::optional<DisparityFormat> files;
  std::vector<std::string> outputs = {"disparity"};  ///< see offlineOutputNames
  std::string compression = "none";
  bool copy = false;  ///< copy the other topics of the input
  EarlierParts earlier = EarlierParts::kReject;
  std::size_t frames_per_part = 50;
  TopicChoice topics;
  PlanOptions plan;
  std::optional<Shard> shard;  ///< shard of the plan to process; mergeShards combines the outputs
  MatchingOptions matching;
};

/// Result of processing bags.
struct BagProcessingSummary {
  FramePlan plan;
  std::size_t resumed = 0;  ///< frames done by an earlier run
  std::size_t processed = 0;
  std::map<std::string, std::size_t> failures;  ///< failed frames of this run by reason
  std::size_t failed = 0;                       ///< failed frames of this and earlier runs
  std::vector<std::string> damages;             ///< damages of the input
  bool interrupted = false;                     ///< the output is incomplete
  bool was_complete = false;                    ///< nothing was left to resume
  bool was_written = false;                     ///< the output exists
  std::vector<std::string> problems;            ///< reasons why frames were not processed
  std::vector<std::string> warnings;            ///< reasons why results may be wrong
  double seconds = 0;           ///< wall time from the first frame of this run to the last
  double matching_seconds = 0;  ///< wall time of matching
  double cpu_seconds = 0;       ///< CPU time in `seconds`, all threads
  int threads = 0;

  /// Whether the output contains everything that can be expected from the input.
  bool isComplete() const {
    return !interrupted && failed == 0 && damages.empty() && problems.empty();
  }
};

/// Callbacks during processing. Different threads may call them, but never two at a time.
struct BagProcessingEvents {
  /// Called before the first frame with plan and warnings.
  std::function<void(const BagProcessingSummary& summary)> begin;
  std::function<void(std::size_t done, std::size_t total)> progress;
  std::function<bool()> should_stop;  ///< called before each frame
};

/// Processes bags. Reading and preparing, matching, and writing overlap. Only a few frames are in
/// memory. The output does not depend on the number of threads or on how often processing was
/// stopped and resumed. No bag is written if there is no frame to process or all frames fail.
/// Throws Error if the input or the options are invalid, if the output is one of the inputs, or if
/// it cannot be written.
BagProcessingSummary processBags(const BagProcessingOptions& options,
                                 const std::shared_ptr<const Forest>& forest,
                                 const BagProcessingEvents& events);

/// One or more lines for the user.
std::string describeSummary(const BagProcessingSummary& summary);

/// The same as a JSON object.
std::string summaryJson(const BagProcessingSummary& summary);

}  // namespace cbmv
