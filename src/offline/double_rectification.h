#pragma once

#include <string>

#include "offline/frame_plan.h"

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Detects raw topics whose images are already rectified, or rectified by the wrong calibration.
/// Returns a message if the rows of the pair are clearly farther apart after rectification than
/// before. Returns an empty string otherwise, also if the offset cannot be measured.
std::string doubleRectificationWarning(const CameraTopics& topics, const PlannedFrame& frame,
                                       const StereoOptions& options);

/// Returns a message if the rows of the pair as matched are more than 1 px apart, which happens if
/// raw images are treated as rectified. Returns an empty string otherwise, also if the offset
/// cannot be measured.
std::string verticalOffsetWarning(const CameraTopics& topics, const PlannedFrame& frame,
                                  const StereoOptions& options);

}  // namespace cbmv
