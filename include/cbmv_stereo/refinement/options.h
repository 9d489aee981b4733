#pragma once

namespace cbmv {

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

}  // namespace cbmv
