#pragma once

#include <string>

#include "cbmv_stereo/optimization/options.h"
#include "cbmv_stereo/rectification/vertical_offset.h"
#include "cbmv_stereo/refinement/options.h"
#include "cbmv_stereo/search/options.h"
#include "cbmv_stereo/volume/disparity_range.h"

namespace cbmv {

/// Everything that can be set on the method. The defaults are the authors' Middlebury settings.
/// parameters.h lists each field with its name, unit, range and description.
struct StereoOptions {
  DisparityRange range;  ///< may be automatic
  RectificationOptions rectification;
  SearchOptions search;
  AggregationOptions aggregation;
  SurfaceOptions surface;
  SgmOptions sgm;
  RefinementOptions refinement;
  int max_memory_mb = 0;  ///< that a pair may need (memory.h); others are rejected; 0: no bound
  int threads = 0;        ///< 0: as many as the machine has
};

}  // namespace cbmv
