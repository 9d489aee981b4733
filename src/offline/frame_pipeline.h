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

/// Parts of the pipeline; all must outlive the run.
struct PipelineParts {
  const FramePlan& plan;
  FrameLoader& loader;
  FrameProcessor& processor;
  bool allow_different_frame_ids = true;
  /// Builds the messages of a frame. Called by several threads at once.
  std::function<std::vector<RawMessage>(const PlannedFrame&, const PreparedFrame&,
                                        const ProcessedFrame&)>
      make;
  /// Builds the messages of a frame that cannot be used.
  std::function<std::vector<RawMessage>(const PlannedFrame&, const std::string& reason)>
      make_failed;
  /// Called in frame order, by one thread at a time.
  std::function<void(const std::vector<RawMessage>& messages, const ros::Time& time)> write;
  std::function<bool()> should_stop;  ///< may be empty
};

struct PipelineReport {
  std::size_t frames = 0;  ///< written frames
  std::map<std::string, std::size_t> failures;
  std::map<std::string, std::size_t>
      warnings;  ///< warnings about input and calibration, with their number of frames
  double matching_seconds = 0;
};

/// Runs the frames of the plan, starting at `first`, through these stages: loading and preparing
/// (parallel), matching (one frame at a time, on `threads` threads), building messages (parallel)
/// and writing (in order).
PipelineReport runPipeline(const PipelineParts& parts, std::size_t first, int threads);

}  // namespace cbmv
