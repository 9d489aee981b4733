#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// Number of bins of ConfidenceProfile, equally wide over [0, 1]. 0.01 is a multiple of the bin
/// width, so the usual thresholds lie on bin limits.
inline constexpr std::size_t kConfidenceBins = 200;

/// Disparity errors as a function of confidence, as sums that can be added over scenes. Counts are
/// pixels, or fractions of pixels after addProfile.
struct ConfidenceProfile {
  struct Bin {
    double pixels = 0.0;
    double confidence = 0.0;  ///< sum of the confidences in the bin
    double wrong = 0.0;       ///< pixels with |d − truth| above correct_px
    double bad_1 = 0.0;       ///< pixels with |d − truth| > 1 px
    double bad_3 = 0.0;       ///< pixels with |d − truth| > 3 px

    void add(const Bin& bin, double share);  ///< of `bin`
  };
  std::vector<Bin> bins;       ///< kConfidenceBins by increasing confidence; empty: unknown
  double pixels = 0.0;         ///< all counted pixels; those without a disparity are in no bin
  double squared_error = 0.0;  ///< sum of (confidence − correct)², correct = 0 or 1
};

/// Number of the bin of a confidence in [0, 1].
std::size_t confidenceBin(double confidence);

/// Counts the same pixels as evaluateDisparity. `confidence` is CV_32FC1; NaN counts as 0. A pixel
/// without a disparity counts as wrong with confidence 0. The result has no bins if a confidence is
/// outside [0, 1], because it is then not a probability. Throws Error when sizes or types differ.
ConfidenceProfile profileConfidence(const cv::Mat& disparity, const cv::Mat& confidence,
                                    const cv::Mat& truth, const cv::Mat& mask, float invalid,
                                    float correct_px);

/// Adds the profile of a scene, scaled to the given weight independent of its number of pixels. The
/// sum has no bins if one of the profiles has none.
void addProfile(const ConfidenceProfile& scene, double weight, ConfidenceProfile& sum);

/// Expected calibration error, 0 … 1: the mean over ten equally wide bins of |mean confidence −
/// fraction of correct pixels|, weighted by the pixels per bin (Guo et al. 2017). NaN: unknown.
double calibrationError(const ConfidenceProfile& profile);

/// Mean of (confidence − correct)², 0 … 1. NaN: unknown.
double brierScore(const ConfidenceProfile& profile);

inline constexpr std::size_t kCalibrationBins = 10;

/// One bin of the reliability diagram.
struct CalibrationBin {
  double pixels = 0.0;      ///< percent of the counted pixels
  double confidence = 0.0;  ///< mean; NaN without pixels
  double correct = 0.0;     ///< fraction of correct pixels, 0 … 1; NaN without pixels
};

/// By increasing confidence. All bins are without pixels if the profile is unknown.
std::array<CalibrationBin, kCalibrationBins> reliability(const ConfidenceProfile& profile);

/// Density and errors when only pixels with a confidence of at least `min_confidence` are kept.
struct OperatingPoint {
  double min_confidence = 0.0;
  double density = 0.0;  ///< kept pixels, percent of the counted pixels
  double bad_1 = 0.0;    ///< percent of the kept pixels; NaN when there are none
  double bad_3 = 0.0;
};

/// A threshold inside a bin keeps the corresponding fraction of the bin. If the profile is unknown,
/// all values except `min_confidence` are NaN.
OperatingPoint operatingPoint(const ConfidenceProfile& profile, double min_confidence);

/// Operating point at the threshold that keeps `percent` (above 0) of the counted pixels. If fewer
/// pixels have a disparity, pixels without one are kept too and count as bad. If the profile is
/// unknown, all values except `density` are NaN.
OperatingPoint atDensity(const ConfidenceProfile& profile, double percent);

}  // namespace cbmv
