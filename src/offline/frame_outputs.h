#pragma once

#include <string>
#include <vector>

#include "offline/offline_matcher.h"
#include "offline/raw_message.h"

namespace cbmv {

/// Names of the outputs that can be asked for: the topics of the live node, and cloud for points2.
std::vector<std::string> offlineOutputNames();

/// Makes the messages of a frame, by the functions that the live node uses.
class FrameOutputs {
 public:
  /// `wanted` are names from offlineOutputNames; throws Error that lists them for others.
  FrameOutputs(const std::vector<std::string>& wanted, const CameraTopics& topics);

  /// The topics that are written.
  std::vector<std::string> topics() const;
  bool needsColor() const;

  /// In the order of offlineOutputNames, with the header of the left image. May be called by
  /// several threads at once.
  std::vector<RawMessage> make(const PreparedFrame& prepared,
                               const ProcessedFrame& processed) const;

 private:
  std::vector<std::size_t> wanted_;  ///< rows of the table of outputs
  std::string output_namespace_;
  std::string color_topic_;
};

}  // namespace cbmv
