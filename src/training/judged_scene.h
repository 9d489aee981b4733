#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "forest/confidence_forest.h"
#include "selection/map_confidence.h"
#include "training/confidence_samples.h"

#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// What the first forest found for a scene, with the truth: the second forest learns from it.
struct JudgedScene {
  StereoResult result;  ///< by a forest that has no second one
  cv::Mat truth;        ///< CV_32FC1, px; not finite = unknown

  JudgedMaps maps() const;
};

/// A disparity is correct within so many pixels of the truth.
inline constexpr float kCorrectPx = 1.0F;

/// Draws up to `pixels` pixels that have a disparity and whose truth is known, all equally likely,
/// and appends the features of the confidence forest (confidenceFeatureNames) and whether the
/// disparity is correct. Rows of the HeldOutBand of `seed` are held out, those of its margins left
/// out.
void appendConfidenceSamples(const JudgedScene& scene, long pixels, std::uint64_t seed,
                             ConfidenceSamples& samples);

/// The same for the selection forest (selectionFeatureNames): each different proposal of a pixel is
/// a sample. `confidence` must not have been trained on the scene.
void appendSelectionSamples(const JudgedScene& scene, const ConfidenceForest& confidence,
                            long pixels, std::uint64_t seed, ConfidenceSamples& samples);

}  // namespace cbmv
