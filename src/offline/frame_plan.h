#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "offline/bag_set.h"
#include "offline/stereo_topics.h"

namespace cbmv {

/// Selects the part of a bag that is processed.
struct PlanOptions {
  double max_stamp_difference_s = 0;  ///< between the images of a pair
  double start_s = 0;                 ///< after the first message of the bag
  double duration_s = 0;              ///< 0: to the end
  int every = 1;                      ///< uses every n-th pair; 1: all pairs
  double offset_interval_s = 0;       ///< interval between estimates of the vertical offset
};

/// The messages of one frame.
struct PlannedFrame {
  BagMessage left;
  BagMessage right;
  std::optional<BagMessage> left_info;   ///< empty: a calibration file is used
  std::optional<BagMessage> right_info;  ///< empty: a calibration file is used
  std::optional<BagMessage> color;       ///< with the stamp of the left image
  std::size_t offset_frame = 0;          ///< index in FramePlan::offset_frames
};

/// Frames to process and images that cannot be processed.
struct FramePlan {
  CameraTopics topics;
  std::vector<PlannedFrame> frames;  ///< sorted by stamp
  std::size_t first =
      0;  ///< index of the first frame to process; other shards process those before it
  /// Pairs for estimating the vertical offset, processed or not. The stamps are divided into
  /// intervals of offset_interval_s; the first pair of the bag in each interval is used. So an
  /// offset does not depend on where processing starts.
  std::vector<PlannedFrame> offset_frames;
  ros::Time begin;  ///< start of the processed part
  ros::Time end;    ///< last moment of the processed part
  std::size_t left_images = 0;
  std::size_t right_images = 0;
  std::size_t pairs = 0;  ///< before `every` is applied
  std::size_t left_alone = 0;
  std::size_t right_alone = 0;
  std::size_t repeated_stamps = 0;  ///< images without a partner whose stamp occurs more than once
  std::size_t equal_stamps = 0;     ///< pairs with the same stamp as the previous pair
  std::size_t infos_of_other_stamps = 0;  ///< frames without a camera_info of equal stamp
  double smallest_gap_s = 0;              ///< smallest difference of left_alone to any right image

  std::size_t framesToProcess() const { return frames.size() - first; }
  /// Whether the message was recorded in the processed part.
  bool isInPart(const BagMessage& message) const {
    return message.entry->time >= begin && message.entry->time <= end;
  }
};

/// Problems to report before the frames are processed. Each text says what is wrong and what to do.
struct PlanProblems {
  /// Reason why there is no frame; empty if there are frames.
  std::string nothing_to_process;
  /// Images without a partner, stamps that do not increase.
  std::vector<std::string> others;
};
PlanProblems findProblems(const FramePlan& plan);

/// Pairs the images in the bags by their stamps. An image gets the camera_info with its stamp, else
/// the last one before it by stamp, else the first one. Throws Error if the bags have no
/// calibration.
FramePlan planFrames(const BagSet& bags, const CameraTopics& topics, const PlanOptions& options);

}  // namespace cbmv
