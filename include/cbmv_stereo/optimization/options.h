#pragma once

namespace cbmv {

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

/// Largest value of a cost after `iterations` runs on costs of at most 255, in units of 1/255: each
/// run adds at most P2. Must stay ≤ 16383, so that four paths fit 16 bits.
int sgmCostBound(const SgmOptions& options);

}  // namespace cbmv
