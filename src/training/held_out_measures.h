#pragma once

#include <string>
#include <vector>

#include "forest/forest.h"
#include "training/confidence_samples.h"
#include "training/sampling.h"

namespace cbmv {

/// Probability that each of the held-out samples is correct, in their order, by a forest of either
/// kind, with no rounding to costs.
std::vector<double> heldOutProbabilities(const Forest& forest, const Samples& samples);

/// The same by a confidence forest.
std::vector<double> heldOutProbabilities(const ConfidenceForest& forest,
                                         const ConfidenceSamples& samples);

/// Sets the log-loss, the reliability and the calibration error of the provenance from the held-out
/// samples: ten bins of probability, each a tenth wide, without those that are empty. The expected
/// calibration error is the mean over the samples of the distance between their bin's mean
/// probability and the part of it that is correct (Naeini et al. 2015). Throws Error when no sample
/// is held out.
void measureHeldOut(const Samples& samples, Forest& forest);

/// The same of the record of a confidence forest.
void measureHeldOut(const ConfidenceSamples& samples, ConfidenceForest& forest);

/// All of the provenance of a file in lines for people, features sorted by their importance; those
/// of the confidence forest and the selection forest behind, if there are such.
std::string describeProvenance(const Forest& forest);

}  // namespace cbmv
