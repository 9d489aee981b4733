#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "optimization/edge_maps.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// Semi-global matching along four directions (Hirschmüller 2008 with the penalties of Žbontar &
/// LeCun 2016, section 4.2) over the hypotheses of a search space.
///
/// Along the path r (from the left, right, above, below), with the pixel p and q = p − r:
///   L_r(p, d) = C(p, d) − min_k L_r(q, k)
///             + min{ L_r(q, e), L_r(q, e−1) + P1, L_r(q, e+1) + P1, min_k L_r(q, k) + P2 }.
/// The disparities at q are those of q's tile; L_r(q, k) is infinite for all others. If q's tile
/// has none, and at the first pixel of a path, L_r = C. In general e = d. Where a known surface
/// rises by s = surface(p) − surface(q) = ±1 from q to p, e = d − s (Scharstein et al. 2017). So
/// following the surface costs nothing.
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
/// (sgmCostBound). Costs of columns beyond the image may have any value. Throws Error if p2 alone
/// exceeds the bound, if p1 is negative or above p2, or if q1, q2 or alpha1 is below 1.
///
/// Vectors by Highway, parallel by oneTBB. The result does not depend on the instruction set, the
/// number of threads or earlier runs. The object keeps the memory of the paths from run to run, so
/// it processes one volume at a time.
class WindowedSgm {
 public:
  WindowedSgm();
  ~WindowedSgm();
  WindowedSgm(const WindowedSgm&) = delete;
  WindowedSgm& operator=(const WindowedSgm&) = delete;

  /// Runs one iteration. `surface` is a surface map (surface_prior.h) of the reference image, or
  /// empty. Images and surface have the size of the space.
  void match(const SearchSpace& space, const WindowedAggregatedVolume& costs,
             const EdgeImages& images, const cv::Mat& surface, View view, const SgmOptions& options,
             WindowedAggregatedVolume& mean);

  /// Runs one iteration on matching costs.
  void match(const SearchSpace& space, const WindowedMatchingVolume& costs,
             const EdgeImages& images, const cv::Mat& surface, View view, const SgmOptions& options,
             WindowedAggregatedVolume& mean);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
