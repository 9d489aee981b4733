#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "optimization/edge_maps.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// Semi-global matching along four directions (Hirschmüller 2008 with the penalties of
/// Žbontar & LeCun 2016, section 4.2) over the hypotheses of a search space. Holds the memory of
/// the paths, which is kept from run to run, so one object serves one volume at a time.
///
/// Along the path r (from the left, right, above, below), with p the pixel and q = p − r,
///   L_r(p, d) = C(p, d) − min_k L_r(q, k)
///             + min{ L_r(q, e), L_r(q, e−1) + P1, L_r(q, e+1) + P1, min_k L_r(q, k) + P2 },
/// where the disparities at q are those of q's tile: L_r(q, k) is infinite for all others. Where
/// q's tile has none, and at the first pixel of a path, L_r = C. e = d, but where a surface is
/// known that rises by s = surface(p) − surface(q) = ±1 from q to p, e = d − s (Scharstein et al.
/// 2017): following the surface costs nothing. P1 and P2 are `options.p1`, `options.p2` times 255,
/// depending on the hypothesis: an edge in the reference image is |I(p) − I(q)| ≥ threshold, in the
/// other image the same at the matching columns of p and q for disparity d (no edge where one of
/// them lies outside). No edge: P1, P2; an edge in one image: both divided by q1; in both images:
/// by q1·q2. On vertical paths P1 is divided by alpha1 on top. Penalties are rounded to the nearest
/// integer: std::lround(255.0 * p / divisor), with the divisors multiplied with each other first,
/// in double.
///
/// `mean` becomes (L_left + L_right + L_above + L_below + 2) / 4. `costs` and `mean` are different
/// volumes; `mean` is resized. Penalties and costs must satisfy max(costs) + 255·p2 ≤ 16383
/// (sgmCostBound); costs of columns beyond the image may be anything. Throws Error if p2 alone
/// exceeds the bound, if p1 is negative or above p2, or if q1, q2 or alpha1 is below 1. Vectors by
/// Highway, parallel by oneTBB; the result depends neither on the instruction set nor on the number
/// of threads nor on earlier runs.
class WindowedSgm {
 public:
  WindowedSgm();
  ~WindowedSgm();
  WindowedSgm(const WindowedSgm&) = delete;
  WindowedSgm& operator=(const WindowedSgm&) = delete;

  /// One run. `surface` is a surface map (surface_prior.h) of the reference image, or empty. Images
  /// and surface have the size of the space.
  void match(const SearchSpace& space, const WindowedOptimizedVolume& costs,
             const EdgeImages& images, const cv::Mat& surface, View view, const SgmOptions& options,
             WindowedOptimizedVolume& mean);

  /// The same on matching costs as they come.
  void match(const SearchSpace& space, const WindowedMatchingVolume& costs,
             const EdgeImages& images, const cv::Mat& surface, View view, const SgmOptions& options,
             WindowedOptimizedVolume& mean);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
