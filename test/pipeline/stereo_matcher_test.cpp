#include "cbmv_stereo/stereo_matcher.h"

#include <cmath>
#include <cstdlib>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_sets/middlebury_scene.h"
#include "evaluation/disparity_error.h"
#include "evaluation/rendered_scene.h"
#include "forest/forest_file.h"
#include "selection/map_selector.h"
#include "support/random_forest.h"
#include "support/random_images.h"
#include "support/second_forest.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/parameters.h"

namespace cbmv::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::shared_ptr<const Forest> shippedForest(const std::string& name) {
  return std::make_shared<Forest>(readForest(std::string(CBMV_SOURCE_DIR "/models/") + name));
}

std::shared_ptr<const Forest> randomForest() {
  return std::make_shared<Forest>(makeForest(8, 5, 3));
}

StereoOptions optionsFor(const DisparityRange& range) {
  StereoOptions options;
  options.range = range;
  return options;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         (a.empty() || cv::norm(a, b, cv::NORM_INF) == 0);
}

void expectSame(const StereoResult& a, const StereoResult& b) {
  EXPECT_TRUE(equal(a.disparity, b.disparity));
  EXPECT_TRUE(equal(a.right_disparity, b.right_disparity));
  EXPECT_TRUE(equal(a.labels, b.labels));
  EXPECT_TRUE(equal(a.confidence, b.confidence));
}

cv::Mat everywhere(const cv::Mat& like) { return cv::Mat(like.size(), CV_8UC1, cv::Scalar(255)); }

TEST(StereoMatcher, FindsARenderedScene) {
  const RenderedScene scene = renderScene(320, 240, 1);
  const StereoOptions options = optionsFor({0, 33});
  StereoMatcher matcher(shippedForest("middlebury.forest"), options);
  const StereoResult result = matcher.match(scene.left, scene.right);
  const float invalid = options.range.invalid();
  const DisparityError visible =
      evaluateDisparity(result.disparity, scene.truth, scene.visible, invalid);
  const DisparityError all =
      evaluateDisparity(result.disparity, scene.truth, everywhere(scene.truth), invalid);
  RecordProperty("bad_1", std::to_string(visible.bad_1));
  EXPECT_LT(visible.bad_1, 2.0);
  EXPECT_LT(visible.average_px, 0.3);
  EXPECT_LT(all.bad_1, 6.0);
  EXPECT_EQ(all.density, 100.0) << "every pixel gets a disparity, the left border too";
  // The confidence separates right from wrong: the least confident tenth contains most errors.
  const cv::Mat wrong = cv::abs(result.disparity - scene.truth) > 1;
  EXPECT_LT(cv::mean(result.confidence, wrong)[0], 0.7 * cv::mean(result.confidence, ~wrong)[0]);
}

TEST(StereoMatcher, RemovesAVerticalOffset) {
  RenderOptions render;
  render.vertical_offset = 1.2;
  render.vertical_slope_x = 0.002;
  const RenderedScene scene = renderScene(320, 240, 2, render);
  const auto bad_1 = [&](bool refine) {
    StereoOptions options = optionsFor({0, 33});
    options.rectification.enabled = refine;
    StereoMatcher matcher(shippedForest("middlebury.forest"), options);
    const StereoResult result = matcher.match(scene.left, scene.right);
    return evaluateDisparity(result.disparity, scene.truth, scene.visible, options.range.invalid())
        .bad_1;
  };
  EXPECT_LT(bad_1(true), 0.5 * bad_1(false));
  EXPECT_LT(bad_1(true), 3.0);
}

/// The same scene with a shifted right image, which shifts all disparities.
TEST(StereoMatcher, TakesNegativeDisparities) {
  const RenderedScene scene = renderScene(200, 90, 3);
  constexpr int kShift = 20;
  cv::Mat moved;
  cv::copyMakeBorder(scene.right.colRange(0, scene.right.cols - kShift), moved, 0, 0, kShift, 0,
                     cv::BORDER_REPLICATE);
  StereoOptions options = optionsFor({-kShift, 33});
  options.rectification.enabled = false;
  StereoMatcher matcher(shippedForest("middlebury.forest"), options);
  const cv::Mat disparity = matcher.match(scene.left, moved).disparity;
  cv::Mat mask = scene.visible.clone();
  mask.colRange(mask.cols - kShift, mask.cols).setTo(0);
  const DisparityError error =
      evaluateDisparity(disparity, scene.truth - kShift, mask, options.range.invalid());
  EXPECT_LT(error.bad_1, 4.0);
}

TEST(StereoMatcher, GivesWholeResultsForAwkwardShapes) {
  for (const Shape& shape : awkwardShapes()) {
    StereoMatcher matcher(randomForest(), optionsFor(shape.range));
    const StereoResult result = matcher.match(makeGray(shape.size(), Content::kPatches, 1),
                                              makeGray(shape.size(), Content::kPatches, 2));
    ASSERT_EQ(result.disparity.size(), shape.size());
    ASSERT_EQ(result.labels.size(), shape.size());
    ASSERT_EQ(result.confidence.size(), shape.size());
    for (int y = 0; y < shape.height; ++y) {
      for (int x = 0; x < shape.width; ++x) {
        const float d = result.disparity.at<float>(y, x);
        const float confidence = result.confidence.at<float>(y, x);
        ASSERT_TRUE(d == shape.range.invalid() ||
                    (d >= shape.range.min - 0.5F && d <= shape.range.max() + 0.5F))
            << d << " in " << shape;
        ASSERT_TRUE(confidence >= 0 && confidence <= 1) << confidence << " in " << shape;
      }
    }
  }
}

TEST(StereoMatcher, WithoutFillingOnlyMatchesHaveDisparities) {
  const RenderedScene scene = renderScene(160, 90, 4);
  StereoOptions options = optionsFor({0, 30});
  options.refinement.fill_occlusions = false;
  options.refinement.fill_mismatches = false;
  StereoMatcher matcher(shippedForest("middlebury.forest"), options);
  const StereoResult result = matcher.match(scene.left, scene.right);
  const cv::Mat invalid = result.disparity == options.range.invalid();
  EXPECT_TRUE(equal(invalid, result.labels != kMatch));
  EXPECT_GT(cv::countNonZero(invalid), 0);
}

TEST(StereoMatcher, DoesNotDependOnThreadsNorOnEarlierFrames) {
  const RenderedScene scene = renderScene(150, 80, 5);
  const RenderedScene other = renderScene(97, 61, 6);
  StereoOptions options = optionsFor({-2, 27});
  options.threads = 1;
  const StereoResult expected =
      StereoMatcher(randomForest(), options).match(scene.left, scene.right);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    StereoMatcher matcher(randomForest(), options);
    matcher.match(other.left, other.right);
    StereoOptions changed = options;
    changed.range = {3, 11};
    matcher.setOptions(changed);
    matcher.match(other.left, other.right);
    matcher.setOptions(options);
    expectSame(matcher.match(scene.left, scene.right), expected);
  }
}

/// Every setting of cost aggregation, SGM and refinement has an effect: changed alone, it changes
/// the disparities of a noisy scene.
TEST(StereoMatcher, EverySettingHasAnEffect) {
  RenderOptions noisy;
  noisy.noise_sigma = 14;
  const RenderedScene scene = renderScene(280, 256, 8, noisy);  // large enough for surfaces
  StereoOptions options = optionsFor({0, 32});
  options.aggregation.iterations_before = 1;
  options.aggregation.intensity_threshold = 0.4F;  // above the noise
  options.refinement.speckle_range_px = 0;         // slopes split regions
  const auto disparity_with = [&](const std::string& name, const ParameterValue& value) {
    StereoOptions changed = options;
    findParameter(name).set(changed, value);
    return StereoMatcher(shippedForest("middlebury.forest"), changed)
        .match(scene.left, scene.right)
        .disparity;
  };
  const cv::Mat usual = disparity_with("sgm_iterations", 2);
  const std::vector<std::pair<std::string, ParameterValue>> changes = {
      {"cbca_arm_length", 3},
      {"cbca_intensity_threshold", 0.8},
      {"cbca_iterations_before", 0},
      {"cbca_iterations_after", 4},
      {"surface_prior", false},
      {"surface_reach", 4.0},
      {"P1", 0.4},
      {"P2", 3.0},
      {"sgm_q1", 4.0},
      {"sgm_q2", 9.0},
      {"sgm_alpha1", 3.0},
      {"sgm_tau_so", 0.5},
      {"sgm_iterations", 1},
      {"sgm_iterations", 0},
      {"left_right_check", false},
      {"optimize_right_view", false},
      {"left_right_max_difference", 0.0},
      {"fill_occlusions", false},
      {"fill_mismatches", false},
      {"subpixel", false},
      {"median_size", 1},
      {"bilateral_sigma", 0.0},
      {"bilateral_threshold", 0.2},
      {"speckle_size", 1000},
      {"second_forest", false},
      {"replace_improbable", false}};
  for (const auto& [name, value] : changes) {
    EXPECT_FALSE(equal(disparity_with(name, value), usual)) << name;
  }
}

std::shared_ptr<const Forest> judgingForest() {
  auto forest = std::make_shared<Forest>(*randomForest());
  addSecondForest(3, *forest);
  return forest;
}

/// The second forest determines the final disparities and confidences.
TEST(StereoMatcher, JudgesItsMaps) {
  const RenderedScene scene = renderScene(150, 80, 7);
  for (const bool fill : {true, false}) {
    StereoOptions options = optionsFor({0, 20});
    options.refinement.fill_mismatches = fill;
    options.refinement.sigma_scale = 1.5F;
    const StereoResult result =
        StereoMatcher(judgingForest(), options).match(scene.left, scene.right);
    StereoResult expected = StereoMatcher(randomForest(), options).match(scene.left, scene.right);
    EXPECT_TRUE(expected.disparity_sigma.empty());
    MapSelector selector(judgingForest());
    selector.select({expected.disparity, expected.right_disparity, expected.labels,
                     expected.confidence, expected.margin, expected.range},
                    {true, fill, 1.0F, 0.0F, 1.5F},
                    {expected.disparity, expected.confidence, expected.disparity_sigma});
    expectSame(result, expected);
    cv::patchNaNs(expected.disparity_sigma);
    cv::Mat sigma = result.disparity_sigma.clone();
    cv::patchNaNs(sigma);
    EXPECT_TRUE(equal(sigma, expected.disparity_sigma));
  }
}

TEST(StereoMatcher, DoesWithoutTheSecondForest) {
  const RenderedScene scene = renderScene(150, 80, 7);
  StereoOptions options = optionsFor({0, 20});
  const StereoResult expected =
      StereoMatcher(randomForest(), options).match(scene.left, scene.right);
  StereoMatcher matcher(judgingForest(), options);
  StereoResult result = matcher.match(scene.left, scene.right);
  EXPECT_FALSE(equal(result.confidence, expected.confidence));
  options.refinement.second_forest = false;
  matcher.setOptions(options);
  matcher.match(scene.left, scene.right, {}, result);
  EXPECT_TRUE(result.disparity_sigma.empty());
  EXPECT_TRUE(equal(result.confidence, expected.confidence));
}

TEST(StereoMatcher, IsSureOfNothingWhereSpecklesWere) {
  const RenderedScene scene = renderScene(150, 80, 7);
  StereoOptions options = optionsFor({0, 20});
  options.refinement.speckle_size_px = 100;
  const StereoResult result =
      StereoMatcher(judgingForest(), options).match(scene.left, scene.right);
  int removed = 0;
  for (int y = 0; y < result.disparity.rows; ++y) {
    for (int x = 0; x < result.disparity.cols; ++x) {
      const bool is_invalid = result.disparity.at<float>(y, x) == options.range.invalid();
      removed += is_invalid ? 1 : 0;
      ASSERT_EQ(std::isnan(result.disparity_sigma.at<float>(y, x)), is_invalid);
      ASSERT_TRUE(!is_invalid || result.confidence.at<float>(y, x) == 0);
    }
  }
  EXPECT_GT(removed, 0);
}

TEST(StereoMatcher, TwoWorkSideBySide) {
  const RenderedScene scene = renderScene(150, 80, 7);
  StereoMatcher first(randomForest(), optionsFor({0, 20}));
  StereoMatcher second(randomForest(), optionsFor({-5, 31}));
  const StereoResult expected_first = first.match(scene.left, scene.right);
  const StereoResult expected_second = second.match(scene.left, scene.right);
  StereoResult result_first;
  std::thread thread([&] { result_first = first.match(scene.left, scene.right); });
  const StereoResult result_second = second.match(scene.left, scene.right);
  thread.join();
  expectSame(result_first, expected_first);
  expectSame(result_second, expected_second);
}

TEST(StereoMatcher, RejectsBadImages) {
  StereoMatcher matcher(randomForest(), optionsFor({0, 8}));
  const cv::Mat gray(20, 30, CV_8UC1, cv::Scalar(1));
  const auto rejection = [&](const cv::Mat& left, const cv::Mat& right) -> std::string {
    try {
      matcher.match(left, right);
      return {};
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_THAT(rejection(gray, cv::Mat()), HasSubstr("right image is empty"));
  EXPECT_THAT(rejection(cv::Mat(), gray), HasSubstr("left image is empty"));
  EXPECT_THAT(rejection(gray, cv::Mat(20, 31, CV_8UC1)),
              AllOf(HasSubstr("30x20"), HasSubstr("31x20")));
  EXPECT_THAT(rejection(gray, cv::Mat(20, 30, CV_8UC3)), HasSubstr("gray"));
  EXPECT_EQ(rejection(gray, gray), "");
}

TEST(StereoMatcher, RejectsInconsistentOptionsAndKeepsTheOld) {
  StereoOptions bad = optionsFor({0, 8});
  bad.sgm.p1 = 20;
  EXPECT_THROW(StereoMatcher(randomForest(), bad), Error);
  StereoMatcher matcher(randomForest(), optionsFor({0, 8}));
  EXPECT_THROW(matcher.setOptions(bad), Error);
  EXPECT_EQ(matcher.options().sgm.p1, StereoOptions().sgm.p1);
}

/// Middlebury's Motorcycle with a forest that was trained on neither Motorcycle nor MotorcycleE.
/// CBMV_DATA is the folder with middlebury_eval3_Q.
TEST(StereoMatcher, FindsMotorcycle) {
  const char* data = std::getenv("CBMV_DATA");
  if (data == nullptr) {
    GTEST_SKIP() << "CBMV_DATA does not name a folder of data sets";
  }
  const StereoScene scene =
      readMiddleburyScene(std::string(data) + "/middlebury_eval3_Q/Motorcycle");
  const StereoOptions options = optionsFor({0, scene.calibration.disparities});
  StereoMatcher matcher(shippedForest("middlebury_without_motorcycle.forest"), options);
  const DisparityError error =
      evaluateDisparity(matcher.match(scene.left, scene.right).disparity, scene.truth,
                        scene.visible, options.range.invalid());
  RecordProperty("bad_05", std::to_string(error.bad_05));
  RecordProperty("bad_1", std::to_string(error.bad_1));
  EXPECT_LT(error.bad_05, 13.0);
  EXPECT_LT(error.bad_1, 5.5);
}

}  // namespace
}  // namespace cbmv::test
