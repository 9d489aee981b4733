#pragma once

#include <array>

#include "confidence/features.h"

namespace cbmv {

/// Names of the features in files, in the order of featureIndex.
constexpr std::array<const char*, kFeatureCount> kFeatureNames = {
    "census_cost",
    "census_log_ratio_low",
    "census_log_ratio_high",
    "census_log_likelihood_low",
    "census_log_likelihood_high",
    "ncc_cost",
    "ncc_log_ratio_low",
    "ncc_log_ratio_high",
    "ncc_log_likelihood_low",
    "ncc_log_likelihood_high",
    "zero_mean_sad_cost",
    "zero_mean_sad_log_ratio_low",
    "zero_mean_sad_log_ratio_high",
    "zero_mean_sad_log_likelihood_low",
    "zero_mean_sad_log_likelihood_high",
    "sobel_sad_cost",
    "sobel_sad_log_ratio_low",
    "sobel_sad_log_ratio_high",
    "sobel_sad_log_likelihood_low",
    "sobel_sad_log_likelihood_high",
};

}  // namespace cbmv
