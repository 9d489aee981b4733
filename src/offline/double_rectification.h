#pragma once

#include <string>

#include "offline/frame_plan.h"

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Rectifying images that are rectified already, or by a calibration that is not theirs, spoils
/// them without a word: one message if the rows of the pair are clearly farther apart after
/// rectification than before; else, and where that cannot be measured, empty. Of topics that are
/// raw.
std::string doubleRectificationWarning(const CameraTopics& topics, const PlannedFrame& frame,
                                       const StereoOptions& options);

/// One message if the rows of the pair, as it is matched, are more than 1 px apart, as those of raw
/// images that are taken as rectified; else, and where that cannot be measured, empty.
std::string misalignedRowsWarning(const CameraTopics& topics, const PlannedFrame& frame,
                                  const StereoOptions& options);

}  // namespace cbmv
