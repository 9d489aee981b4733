#pragma once

#include <algorithm>
#include <cmath>

namespace cbmv {

/// Log-odds of a confidence. 0 and 1, whose log-odds are infinite, count as half of 1/255 inside.
inline double logOddsOf(double confidence) {
  constexpr double kOutermost = 0.5 / 255.0;
  const double inside = std::clamp(confidence, kOutermost, 1.0 - kOutermost);
  return std::log(inside / (1.0 - inside));
}

/// The confidence with log-odds scale · log_odds + shift (Platt 1999), as by the parameters
/// confidence_scale and confidence_shift.
inline double scaledConfidence(double log_odds, double scale, double shift) {
  return 1.0 / (1.0 + std::exp(-(scale * log_odds + shift)));
}

}  // namespace cbmv
