#include "tuning/parameter_space.h"

#include <random>

#include <gtest/gtest.h>

#include "support/error_text.h"

namespace cbmv {
namespace {

TEST(ParameterSpace, GoesFromBoundToBound) {
  const ParameterSpace space({"P2", "bilateral_sigma", "median_size"});
  ASSERT_EQ(space.dimensions(), 3U);
  const StereoOptions lowest = space.optionsAt({0, 0, 0}, {});
  const StereoOptions highest = space.optionsAt({1, 1, 1}, {});
  EXPECT_FLOAT_EQ(highest.sgm.p2, 30.0F);
  EXPECT_EQ(lowest.refinement.bilateral_sigma_px, 0.0F);
  EXPECT_EQ(highest.refinement.bilateral_sigma_px, 10.0F);
  EXPECT_EQ(lowest.refinement.median_size_px, 1);
  EXPECT_EQ(highest.refinement.median_size_px, 5);
  const StereoOptions middle = space.optionsAt({0.5, 0.5, 0.5}, {});
  EXPECT_FLOAT_EQ(middle.sgm.p2, 3.87F) << "geometric mean of 0.5 and 30, three digits";
  EXPECT_EQ(middle.refinement.bilateral_sigma_px, 5.0F);
  EXPECT_EQ(middle.refinement.median_size_px, 3);
  EXPECT_EQ(space.optionsAt({-1, 2, 0}, {}).refinement.bilateral_sigma_px, 10.0F);
}

/// All parameters at once, at random points: integers are whole, windows odd, options consistent,
/// and parameters that are not searched do not change.
TEST(ParameterSpace, HoldsOnlyOptionsThatWork) {
  const ParameterSpace space(defaultSearchParameters());
  StereoOptions others;
  others.sgm.iterations = 3;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(0, 1);
  for (int i = 0; i < 200; ++i) {
    std::vector<double> point(space.dimensions());
    for (double& each : point) {
      each = coordinate(random);
    }
    StereoOptions options = space.optionsAt(point, others);
    EXPECT_TRUE(correctOptions(options).empty());
    EXPECT_EQ(options.sgm.iterations, 3);
    EXPECT_EQ(describeOptions(space.optionsAt(space.coordinates(options), others)),
              describeOptions(options));
  }
}

TEST(ParameterSpace, StartsInsideOfTheBounds) {
  const ParameterSpace space({"P1", "bilateral_sigma"});
  StereoOptions options;
  options.sgm.p1 = 0;
  options.refinement.bilateral_sigma_px = 10;
  EXPECT_EQ(space.coordinates(options), (std::vector<double>{0, 1}));
}

TEST(ParameterSpace, FirstStepsReachTheNextWholeNumber) {
  const ParameterSpace space({"median_size", "cbca_iterations_before", "P1"});
  const std::vector<double> steps = space.firstSteps();
  const std::vector<double> from = space.coordinates({});
  for (std::size_t i = 0; i < steps.size(); ++i) {
    std::vector<double> to = from;
    to[i] += steps[i];
    EXPECT_NE(describeOptions(space.optionsAt(to, {})), describeOptions({})) << i;
  }
}

TEST(ParameterSpace, RejectsWhatCannotBeSearched) {
  const auto error = [](const std::vector<std::string>& names) {
    return errorText([&] { ParameterSpace space(names); });
  };
  EXPECT_TRUE(mentions(error({"P3"}), {"P3"}));
  EXPECT_TRUE(mentions(error({"subpixel"}), {"subpixel", "numbers"}));
  EXPECT_TRUE(mentions(error({"min_disparity"}), {"min_disparity"}));
  EXPECT_TRUE(mentions(error({"P1", "P2", "P1"}), {"P1", "twice"}));
  EXPECT_TRUE(mentions(error({}), {"no parameter"}));
}

TEST(PresetParameters, AreThoseBehindTheVolume) {
  const std::vector<Parameter> parameters = presetParameters();
  ASSERT_EQ(parameters.size() + 9, stereoParameters().size());
  EXPECT_EQ(parameters.front().name, "cbca_arm_length");
  EXPECT_EQ(parameters.back().name, "speckle_range");
}

}  // namespace
}  // namespace cbmv
