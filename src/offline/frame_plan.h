#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "offline/bag_set.h"
#include "offline/stereo_topics.h"

namespace cbmv {

/// Which part of a recording is processed.
struct PlanOptions {
  double max_stamp_difference_s = 0;  ///< between the images of a pair
  double start_s = 0;                 ///< after the first message of the recording
  double duration_s = 0;              ///< 0: to the end
  int every = 1;                      ///< pairs: 1 takes all, 2 every second, …
  double offset_interval_s = 0;       ///< from one estimate of the vertical offset to the next
};

/// The messages that one frame is made from.
struct PlannedFrame {
  BagMessage left;
  BagMessage right;
  std::optional<BagMessage> left_info;   ///< none: the calibration was given
  std::optional<BagMessage> right_info;  ///< none: the calibration was given
  std::optional<BagMessage> color;  ///< with the stamp of the left image
  std::size_t offset_frame = 0;     ///< row of FramePlan::offset_frames
};

/// What will be processed, and what cannot be.
struct FramePlan {
  CameraTopics topics;
  std::vector<PlannedFrame> frames;  ///< by stamp
  std::size_t first = 0;             ///< the frames before it are others' work
  /// The pairs that vertical offsets are estimated from, processed or not: of all pairs whose
  /// stamps have the same whole number of offset_interval_s, the first one in the recording. So an
  /// offset does not depend on where processing begins.
  std::vector<PlannedFrame> offset_frames;
  ros::Time begin;  ///< of the part that is processed
  ros::Time end;    ///< of the part that is processed; the last moment in it
  std::size_t left_images = 0;
  std::size_t right_images = 0;
  std::size_t pairs = 0;  ///< before `every`
  std::size_t left_alone = 0;
  std::size_t right_alone = 0;
  std::size_t repeated_stamps = 0;  ///< images without a partner whose stamp others have
  std::size_t equal_stamps = 0;     ///< pairs with the stamp of the pair before
  std::size_t infos_of_other_stamps = 0;  ///< frames without a camera_info of their stamp
  double smallest_gap_s = 0;              ///< least difference of left_alone to any right image

  std::size_t framesToProcess() const { return frames.size() - first; }
  /// Whether the message was recorded in the part of the recording that is processed.
  bool isInPart(const BagMessage& message) const {
    return message.entry->time >= begin && message.entry->time <= end;
  }
};

/// What people should know of a plan before its frames are processed. Each text says what is wrong
/// and what to do.
struct PlanProblems {
  /// Not empty: there is no frame, and why.
  std::string nothing_to_process;
  /// Images without a partner, stamps that do not increase.
  std::vector<std::string> others;
};
PlanProblems findProblems(const FramePlan& plan);

/// Pairs the images in the bags by their stamps. An image takes the camera_info of its stamp; else
/// the last one before it, by stamp, else the first one. Throws Error if no calibration was recorded.
FramePlan planFrames(const BagSet& bags, const CameraTopics& topics, const PlanOptions& options);

}  // namespace cbmv
