#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// Bins of ConfidenceProfile, of equal width over [0, 1]. A hundredth is a multiple of the width,
/// so that the usual thresholds fall between bins.
inline constexpr std::size_t kConfidenceBins = 200;

/// Which confidences go with which errors, as sums that can be added over scenes. Numbers are of
/// pixels, or of parts of them after addProfile.
struct ConfidenceProfile {
  struct Bin {
    double pixels = 0.0;
    double confidence = 0.0;  ///< sum of their confidences
    double wrong = 0.0;       ///< |d − truth| above what counts as correct
    double bad_1 = 0.0;       ///< |d − truth| > 1 px
    double bad_3 = 0.0;       ///< |d − truth| > 3 px
  };
  std::vector<Bin> bins;  ///< kConfidenceBins by rising confidence; empty: not known
  double pixels = 0.0;    ///< counted pixels, those without a disparity too; these are in no bin
  double squared_error = 0.0;  ///< sum of (confidence − correct)², correct being 0 or 1
};

/// Counts the pixels as evaluateDisparity does. `confidence` is CV_32FC1; NaN counts as 0. A pixel
/// without a disparity counts as wrong and as known to be, with a confidence of 0. Without bins
/// when a confidence lies outside of [0, 1], which is then no probability. Throws Error when sizes
/// or types differ.
ConfidenceProfile profileConfidence(const cv::Mat& disparity, const cv::Mat& confidence,
                                    const cv::Mat& truth, const cv::Mat& mask, float invalid,
                                    float correct_px);

/// Adds the profile of a scene so that it has this weight, however many pixels it has. The sum of
/// profiles of which one has no bins has none.
void addProfile(const ConfidenceProfile& scene, double weight, ConfidenceProfile& sum);

/// Expected calibration error, 0 … 1: over ten bins of equal width, the mean of |mean confidence −
/// share of correct pixels|, weighted with the bins' pixels (Guo et al. 2017). NaN: not known.
double calibrationError(const ConfidenceProfile& profile);

/// Mean of (confidence − correct)², 0 … 1. NaN: not known.
double brierScore(const ConfidenceProfile& profile);

inline constexpr std::size_t kCalibrationBins = 10;

/// A bin of the reliability diagram.
struct CalibrationBin {
  double pixels = 0.0;      ///< percent of the counted pixels
  double confidence = 0.0;  ///< mean; NaN without pixels
  double correct = 0.0;     ///< share of correct pixels, 0 … 1; NaN without pixels
};

/// By rising confidence; all without pixels when the profile is not known.
std::array<CalibrationBin, kCalibrationBins> reliability(const ConfidenceProfile& profile);

/// What remains when only the pixels of a confidence of at least `min_confidence` are kept.
struct OperatingPoint {
  double min_confidence = 0.0;
  double density = 0.0;  ///< percent of the counted pixels that are kept
  double bad_1 = 0.0;    ///< percent of the kept pixels; NaN when there are none
  double bad_3 = 0.0;
};

/// A threshold inside of a bin keeps its part of all that is in the bin. All but `min_confidence`
/// is NaN when the profile is not known.
OperatingPoint operatingPoint(const ConfidenceProfile& profile, double min_confidence);

/// The threshold that keeps this percent (above 0) of the counted pixels. Where fewer have a
/// disparity, those without are kept too, as bad ones. All but `density` is NaN when the profile is
/// not known.
OperatingPoint atDensity(const ConfidenceProfile& profile, double percent);

}  // namespace cbmv
