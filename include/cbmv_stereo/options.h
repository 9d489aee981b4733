#pragma once

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/export.h"

namespace cbmv {

/// The residual vertical offset between the rows of a rectified pair (vertical_offset.h).
struct CBMV_API RectificationOptions {
  bool enabled = true;         ///< false: every estimate is the zero model
  double max_offset_px = 4.0;  ///< largest vertical distance in the search for matches
  int max_features = 600;      ///< largest number of corners of the left image
  int min_matches = 40;        ///< no estimate with fewer consistent matches
  /// Smallest root mean square over the image of a correction that is applied. Aliasing alone
  /// biases subpixel offsets by about half of this value, and resampling costs sharpness.
  double min_correction_px = 0.1;
  double interval_s = 1.0;  ///< RectificationTracker: time between estimates
  double smoothing = 0.5;   ///< RectificationTracker: weight of the old model, 0 ≤ smoothing < 1

  bool operator==(const RectificationOptions& other) const;
  bool operator!=(const RectificationOptions& other) const { return !(*this == other); }
};

/// Coarse-to-fine search.
struct SearchOptions {
  /// How often the pair is halved. The exhaustive search runs at 1 / 2^levels of the image size.
  /// 0: at full size.
  int levels = 3;
  int neighborhood_px = 1;  ///< distance of the coarse pixels whose disparities are used
  int margin_px = 2;        ///< disparities are searched up to this far from twice a coarse one
};

/// Cross-based cost aggregation (CBCA), before and after SGM. Defaults: the authors' Middlebury
/// settings but for iterations_after (theirs: 4), which was chosen on Middlebury 2005 and 2006.
struct AggregationOptions {
  int arm_length_px = 6;              ///< L1: an arm has fewer pixels than this
  float intensity_threshold = 0.07F;  ///< tau1, in standard deviations of the intensities
  int iterations_before = 0;          ///< cbca_i1
  int iterations_after = 3;           ///< cbca_i2
};

/// Surface prior: SGM follows surfaces that are found at half the image size.
struct SurfaceOptions {
  bool enabled = true;
  float reach_px = 40.0F;  ///< standard deviation of the distance weights of a plane fit
};

/// Semi-global matching (SGM). Costs are in [0, 1]. Penalties have the same unit. Defaults: the
/// authors' Middlebury settings but for p2 (theirs: 10), which was chosen on Middlebury 2005 and
/// 2006.
struct SgmOptions {
  float p1 = 1.3F;      ///< pi1: penalty of a disparity change of 1 px
  float p2 = 7.0F;      ///< pi2: penalty of a larger disparity change
  float q1 = 2.2F;      ///< divides both penalties where one of the images has an edge
  float q2 = 3.0F;      ///< divides both penalties once more where both images have an edge
  float alpha1 = 1.4F;  ///< divides P1 on the vertical paths
  float edge_threshold = 0.12F;  ///< tau_so, in standard deviations of the intensities
  int iterations = 2;            ///< sgm_i; 0 disables SGM
};

/// All steps after winner-takes-all (WTA). Defaults of the median and the bilateral filter: the
/// authors' Middlebury settings.
struct RefinementOptions {
  bool left_right_check = true;  ///< label occluded and mismatched pixels
  /// SGM runs on the right view for the check. false: the right winners are from the left volume.
  bool optimize_right_view = true;
  float max_left_right_difference_px = 1.0F;  ///< the views agree up to this difference
  bool fill_occlusions = true;                ///< false: occluded pixels are invalid
  bool fill_mismatches = true;                ///< false: mismatched pixels are invalid
  bool subpixel = true;                       ///< fit a parabola through the three lowest costs
  int median_size_px = 3;                     ///< odd; 1 disables the filter
  float bilateral_sigma_px = 2.2F;            ///< blur_sigma; 0 disables the filter
  float bilateral_threshold_px = 1.3F;        ///< blur_t, px of disparity
  bool second_forest = true;  ///< calibrated confidence, if the forest file has a second forest
  bool replace_improbable = true;  ///< use disparities of confident neighbors; needs second_forest
  /// Recalibration of the second forest's confidence: its log-odds are multiplied by the scale,
  /// then the shift is added. It changes no disparity.
  float confidence_scale = 1.0F;
  float confidence_shift = 0.0F;
  float sigma_scale = 1.0F;  ///< multiplies StereoResult::disparity_sigma
  int speckle_size_px = 0;   ///< pixels; regions of at most this size become invalid; 0: off
  int speckle_range_px = 4;  ///< px of disparity; a larger difference separates regions
};

/// All options of the method. parameters.h lists each field with its name, unit, range and
/// description.
struct StereoOptions {
  DisparityRange range;  ///< may be automatic
  RectificationOptions rectification;
  SearchOptions search;
  AggregationOptions aggregation;
  SurfaceOptions surface;
  SgmOptions sgm;
  RefinementOptions refinement;
  int max_memory_mb = 0;  ///< pairs that need more are rejected (memory.h); 0: no limit
  int threads = 0;        ///< 0: all hardware threads
};

}  // namespace cbmv
