#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "offline/frame_plan.h"
#include "offline/prepared_frame.h"
#include "offline/raw_message.h"

namespace cbmv {

/// What the pipeline is made of; all have to outlive the run.
struct PipelineParts {
  const FramePlan& plan;
  FrameLoader& loader;
  FrameProcessor& processor;
  bool allow_different_frame_ids = true;
  /// Makes what is written of a frame; called by several threads at once.
  std::function<std::vector<RawMessage>(const PlannedFrame&, const PreparedFrame&,
                                        const ProcessedFrame&)>
      make;
  /// The same of a frame whose messages cannot be used.
  std::function<std::vector<RawMessage>(const PlannedFrame&, const std::string& reason)>
      make_failed;
  /// Called with the frames in their order, by one thread at a time.
  std::function<void(const std::vector<RawMessage>& messages, const ros::Time& time)> write;
  std::function<bool()> should_stop;  ///< may be empty
};

struct PipelineReport {
  std::size_t frames = 0;  ///< that were written
  std::map<std::string, std::size_t> failures;
  std::map<std::string, std::size_t> warnings;  ///< of input and calibration, with their frames
  double matching_seconds = 0;
};

/// Takes the frames of the plan from `first` on through loading and preparing (several at once),
/// matching (one at a time, on `threads` threads), making of messages (several at once) and writing
/// (in order).
PipelineReport runPipeline(const PipelineParts& parts, std::size_t first, int threads);

}  // namespace cbmv
