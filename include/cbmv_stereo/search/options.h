#pragma once

namespace cbmv {

/// Coarse-to-fine search.
struct SearchOptions {
  /// How often the pair is halved: it is searched exhaustively at 1 / 2^levels of its size. 0: at
  /// full size.
  int levels = 3;
  int neighborhood_px = 1;  ///< coarse pixels around a pixel whose disparities are tried
  int margin_px = 1;         ///< and those so far from twice such a disparity
};

}  // namespace cbmv
