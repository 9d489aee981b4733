#pragma once

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/export.h"

namespace cbmv {

/// The vertical offset that is left between the rows of a rectified pair (vertical_offset.h).
struct CBMV_API RectificationOptions {
  bool enabled = true;         ///< false: every estimate is the zero model
  double max_offset_px = 4.0;  ///< matches are searched at most this many rows away
  int max_features = 600;      ///< corners of the left image that are matched
  int min_matches = 40;        ///< fewer consistent matches: no estimate
  /// A correction whose root mean square over the image is smaller is not made: aliasing alone
  /// biases sub-pixel offsets by about half of this, and resampling costs sharpness.
  double min_correction_px = 0.1;
  double interval_s = 1.0;  ///< RectificationTracker: time from one estimate to the next
  double smoothing = 0.5;   ///< RectificationTracker: share of the old model, 0 to below 1

  bool operator==(const RectificationOptions& other) const;
  bool operator!=(const RectificationOptions& other) const { return !(*this == other); }
};

/// Coarse-to-fine search.
struct SearchOptions {
  /// How often the pair is halved: it is searched exhaustively at 1 / 2^levels of its size. 0: at
  /// full size.
  int levels = 3;
  int neighborhood_px = 1;  ///< coarse pixels around a pixel whose disparities are tried
  int margin_px = 1;        ///< and those so far from twice such a disparity
};

/// Cross-based cost aggregation, before and after semi-global matching. Defaults: the authors'
/// Middlebury settings.
struct AggregationOptions {
  int arm_length_px = 6;              ///< L1: an arm holds fewer pixels than this
  float intensity_threshold = 0.07F;  ///< tau1, in standard deviations of the image's intensity
  int iterations_before = 0;          ///< cbca_i1
  int iterations_after = 4;           ///< cbca_i2
};

/// Surfaces found at half the size, which semi-global matching then follows.
struct SurfaceOptions {
  bool enabled = true;
  float reach_px = 40.0F;  ///< standard deviation of the distances over which a plane is fitted
};

/// Semi-global matching. Costs are in [0, 1]: penalties are in the same unit.
struct SgmOptions {
  float p1 = 1.3F;               ///< pi1: penalty of a disparity step of one
  float p2 = 10.0F;              ///< pi2: penalty of a larger step
  float q1 = 2.2F;               ///< divides both penalties where one of the images has an edge
  float q2 = 3.0F;               ///< divides them once more where both images have one
  float alpha1 = 1.4F;           ///< divides P1 on the vertical paths
  float edge_threshold = 0.12F;  ///< tau_so, in standard deviations of the image's intensity
  int iterations = 2;            ///< sgm_i; 0 skips the stage
};

/// Everything after winner takes all. Defaults: the authors' Middlebury settings.
struct RefinementOptions {
  bool left_right_check = true;     ///< label occlusions and mismatches
  bool optimize_right_view = true;  ///< for the check; else its winners come from the left volume
  float max_left_right_difference_px = 1.0F;  ///< up to which both views agree
  bool fill_occlusions = true;                ///< else such pixels are invalid
  bool fill_mismatches = true;                ///< else such pixels are invalid
  bool subpixel = true;                       ///< parabola through the three lowest costs
  int median_size_px = 3;                     ///< odd; 1 switches the filter off
  float bilateral_sigma_px = 2.2F;            ///< blur_sigma; 0 switches the filter off
  float bilateral_threshold_px = 1.3F;        ///< blur_t, in pixels of disparity
  bool second_forest = true;       ///< calibrated confidence, where the forest holds a second one
  bool replace_improbable = true;  ///< by disparities of confident neighbors; needs second_forest
  int speckle_size_px = 0;   ///< pixels; regions of at most so many lose their disparity; 0: off
  int speckle_range_px = 4;  ///< of disparity; neighbors that differ by more are of two regions
};

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
