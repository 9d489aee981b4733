#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core.hpp>

#include "base/volume.h"
#include "optimization/edge_maps.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// Semi-global matching along four directions (Hirschmüller 2008 with the penalties of Žbontar &
/// LeCun 2016, section 4.2).
///
/// Along the path r (from the left, right, above, below), with the pixel p and q = p − r:
///   L_r(p, d) = C(p, d) − min_k L_r(q, k)
///             + min{ L_r(q, e), L_r(q, e−1) + P1, L_r(q, e+1) + P1, min_k L_r(q, k) + P2 }.
/// At the first pixel of a path, L_r = C. In general e = d. Where a known surface rises by
/// s = surface(p) − surface(q) = ±1 from q to p, e = d − s (Scharstein et al. 2017). So following
/// the surface costs nothing.
///
/// P1 and P2 are `options.p1` and `options.p2` times 255, divided depending on the hypothesis. The
/// reference image has an edge if |I(p) − I(q)| ≥ threshold. The other image has an edge if the
/// same is true at the columns that match p and q at disparity d; there is no edge if one of them
/// is outside.
/// - No edge: P1, P2.
/// - An edge in one image: both divided by q1.
/// - Edges in both images: both divided by q1·q2.
/// - On vertical paths, P1 is also divided by alpha1.
///
/// Penalties are rounded to the nearest integer: std::lround(255.0 * p / divisor). The divisors are
/// multiplied first, in double.
///
/// `mean` becomes (L_left + L_right + L_above + L_below + 2) / 4. `costs` and `mean` are different
/// volumes; `mean` is resized. Penalties and costs must satisfy max(costs) + 255·p2 ≤ 16383
/// (sgmCostBound). Throws Error if p2 alone exceeds this bound, if p1 is negative or above p2, or
/// if q1, q2 or alpha1 is below 1.
///
/// Vectors by Highway, parallel by oneTBB. The result does not depend on the instruction set, the
/// number of threads or earlier runs. The object keeps the memory of the paths from run to run, so
/// it processes one volume at a time.
class SemiGlobalMatcher {
 public:
  /// Memory of the vertical paths of images of `width` columns.
  static double bytesOfPaths(double width, double disparities) {
    return 2 * sizeof(std::int16_t) * width * (disparities + 32);
  }

  SemiGlobalMatcher();
  ~SemiGlobalMatcher();
  SemiGlobalMatcher(const SemiGlobalMatcher&) = delete;
  SemiGlobalMatcher& operator=(const SemiGlobalMatcher&) = delete;

  /// Runs one iteration. `surface` is a surface map (surface_prior.h) of the reference image, or
  /// empty.
  void match(const AggregatedVolume& costs, const EdgeImages& images, const cv::Mat& surface,
             View view, const DisparityRange& range, const SgmOptions& options,
             AggregatedVolume& mean);

  /// Runs one iteration on matching costs.
  void match(const MatchingVolume& costs, const EdgeImages& images, const cv::Mat& surface,
             View view, const DisparityRange& range, const SgmOptions& options,
             AggregatedVolume& mean);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
