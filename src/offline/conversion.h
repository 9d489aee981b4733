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

struct ConversionOptions {
  std::vector<std::string> inputs;
  std::string output;  ///< the bag, or the folder
  /// Of the files in the folder; none: a bag.
  std::optional<DisparityFormat> files;
  std::vector<std::string> outputs = {"disparity"};  ///< see offlineOutputNames
  std::string compression = "none";
  bool copy = false;  ///< the other topics of the input, too
  EarlierParts earlier = EarlierParts::kRefuse;
  std::size_t frames_per_part = 50;
  TopicChoice topics;
  PlanOptions plan;
  std::optional<Shard> shard;  ///< of the plan; the output is for mergeShards then
  MatchingOptions matching;
};

/// What became of a recording.
struct ConversionSummary {
  FramePlan plan;
  std::size_t resumed = 0;  ///< frames that an earlier run has made
  std::size_t processed = 0;
  std::map<std::string, std::size_t> failures;  ///< frames of this run that failed, by the reason
  std::size_t failed = 0;                       ///< the same with those of earlier runs
  std::vector<std::string> damages;             ///< of the input
  bool interrupted = false;                     ///< the output is not complete
  bool was_complete = false;                    ///< nothing was left to resume
  bool was_written = false;                     ///< the output is there
  std::vector<std::string> problems;            ///< that left frames undone
  std::vector<std::string> warnings;            ///< that make results doubtful
  double seconds = 0;                           ///< from the first frame of this run to the last
  double matching_seconds = 0;                  ///< that the matcher was busy
  double cpu_seconds = 0;                       ///< of processor in `seconds`, of all threads
  int threads = 0;

  /// Whether all that could be expected of the recording is in the output.
  bool isComplete() const {
    return !interrupted && failed == 0 && damages.empty() && problems.empty();
  }
};

/// What a conversion tells its caller while it runs; may be called by several threads, one at a
/// time.
struct ConversionEvents {
  /// Before the first frame, with what is known until then: plan and warnings.
  std::function<void(const ConversionSummary& summary)> begin;
  std::function<void(std::size_t done, std::size_t total)> progress;
  std::function<bool()> should_stop;  ///< asked before each frame
};

/// Processes bags. Reading and preparing, matching, and writing overlap; the memory is that of a
/// few frames. The output holds the same whatever the number of threads, and however often the
/// conversion was stopped and resumed. Where there is no frame to process, or all fail, no bag is
/// written. Throws Error if the input or the options cannot be used, if the output is one of the
/// inputs, or if it cannot be written.
ConversionSummary convertBags(const ConversionOptions& options,
                              const std::shared_ptr<const Forest>& forest,
                              const ConversionEvents& events);

/// One or more lines for people.
std::string describeSummary(const ConversionSummary& summary);

/// The same as a JSON object.
std::string summaryJson(const ConversionSummary& summary);

}  // namespace cbmv
