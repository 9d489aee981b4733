#include "cbmv_stereo/vertical_offset.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "data_sets/middlebury_scene.h"
#include "evaluation/rendered_scene.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

const DisparityRange kRange{0, 32};

double offsetOf(const RenderOptions& options, double x, double y, const cv::Size& size) {
  const double u = x - 0.5 * (size.width - 1);
  const double v = y - 0.5 * (size.height - 1);
  return options.vertical_offset + options.vertical_slope_x * u + options.vertical_slope_y * v +
         options.vertical_twist * u * v + options.vertical_curvature_x * u * u +
         options.vertical_curvature_y * v * v;
}

/// Largest difference between the model and the rendered offset, at the corners and in the middle
/// of the sides.
double largestError(const VerticalOffset& model, const RenderOptions& options,
                    const cv::Size& size) {
  double largest = 0.0;
  for (const int x : {0, size.width / 2, size.width - 1}) {
    for (const int y : {0, size.height / 2, size.height - 1}) {
      largest = std::max(largest, std::abs(model.at(x, y, size) - offsetOf(options, x, y, size)));
    }
  }
  return largest;
}

RenderOptions withOffset(double offset, double slope_x, double slope_y, double twist = 0.0,
                         double curvature_x = 0.0, double curvature_y = 0.0) {
  RenderOptions options;
  options.vertical_offset = offset;
  options.vertical_slope_x = slope_x;
  options.vertical_slope_y = slope_y;
  options.vertical_twist = twist;
  options.vertical_curvature_x = curvature_x;
  options.vertical_curvature_y = curvature_y;
  return options;
}

cv::Mat noise(const cv::Size& size, int seed) {
  cv::Mat image(size, CV_8UC1);
  cv::RNG(static_cast<uint64_t>(seed)).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

void expectNoEstimate(const VerticalOffset& model) {
  EXPECT_TRUE(model.isZero());
  EXPECT_EQ(model.matches, 0);
}

TEST(VerticalOffset, IsQuadraticAboutTheImageCentre) {
  VerticalOffset model;
  model.offset_px = 1.5;
  model.slope_x = 0.01;
  model.slope_y = -0.02;
  const cv::Size size(101, 51);
  EXPECT_DOUBLE_EQ(model.at(50, 25, size), 1.5);
  EXPECT_DOUBLE_EQ(model.at(100, 25, size), 2.0);
  EXPECT_DOUBLE_EQ(model.at(50, 0, size), 2.0);
  model.twist = 0.001;
  EXPECT_DOUBLE_EQ(model.at(50, 0, size), 2.0);
  EXPECT_DOUBLE_EQ(model.at(100, 50, size), 1.5 + 0.5 - 0.5 + 1.25);
  model.curvature_x = 0.0002;
  model.curvature_y = -0.0016;
  EXPECT_DOUBLE_EQ(model.at(100, 25, size), 2.0 + 0.5);
  EXPECT_DOUBLE_EQ(model.at(50, 0, size), 2.0 - 1.0);
  double squares = 0.0;
  for (int y = 0; y < 51 * 8; ++y) {
    for (int x = 0; x < 101 * 8; ++x) {
      squares += std::pow(model.at(x * 100.0 / 807.0, y * 50.0 / 407.0, size), 2);
    }
  }
  EXPECT_NEAR(model.rootMeanSquare(size), std::sqrt(squares / (51 * 8 * 101 * 8)), 1e-3);
  model.clearCorrection();
  EXPECT_TRUE(model.isZero());
}

TEST(EstimateVerticalOffset, RecoversEveryTermOfTheModel) {
  const cv::Size size(351, 263);
  int seed = 0;
  for (const RenderOptions& options :
       {withOffset(0.6, 0.0, 0.0), withOffset(-2.3, 0.0, 0.0), withOffset(0.0, 0.006, 0.0),
        withOffset(0.0, 0.0, -0.008), withOffset(-1.3, -0.005, 0.004),
        withOffset(0.0, 0.0, 0.0, 5e-5), withOffset(0.4, 0.002, 0.003, -4e-5),
        withOffset(0.0, 0.0, 0.0, 0.0, 3e-5), withOffset(0.0, 0.0, 0.0, 0.0, 0.0, 5e-5),
        withOffset(-0.3, 0.001, 0.0, 2e-5, -2e-5, 3e-5)}) {
    const RenderedScene scene = renderScene(size.width, size.height, ++seed, options);
    const VerticalOffset model = estimateVerticalOffset(scene.left, scene.right, kRange, {});
    EXPECT_LT(largestError(model, options, size), 0.05);
    EXPECT_GE(model.matches, 40);
    EXPECT_LT(model.residual_px, 0.1);
    EXPECT_GT(model.offset_sigma_px, 0.0);
    EXPECT_LT(model.offset_sigma_px, 0.02);
  }
}

/// Parameters in px: the offset, and the others at the image border.
TEST(MeasureVerticalOffset, ErrorsLieWithinThreeStatedStandardDeviations) {
  const cv::Size size(351, 263);
  int seed = 10;
  for (const double offset : {-2.3, 0.05, 0.35}) {
    for (const double slope : {-0.006, 0.0, 0.002}) {
      const double twist = 0.01 * slope;
      const RenderOptions options = withOffset(offset, slope, 0.5 * slope, twist, -twist, twist);
      const RenderedScene scene = renderScene(size.width, size.height, ++seed, options);
      const VerticalOffset model = measureVerticalOffset(scene.left, scene.right, kRange, {}).model;
      SCOPED_TRACE(testing::Message() << "offset " << offset << ", slope " << slope);
      EXPECT_NEAR(model.offset_px, offset, 3.0 * model.offset_sigma_px);
      EXPECT_NEAR(model.slope_x, slope, 3.0 * model.slope_x_sigma);
      EXPECT_NEAR(model.slope_y, 0.5 * slope, 3.0 * model.slope_y_sigma);
      EXPECT_NEAR(model.twist, twist, 3.0 * model.twist_sigma);
      EXPECT_NEAR(model.curvature_x, -twist, 3.0 * model.curvature_x_sigma);
      EXPECT_NEAR(model.curvature_y, twist, 3.0 * model.curvature_y_sigma);
      EXPECT_LT(3.0 * model.offset_sigma_px, 0.1);  // a meaningful limit
      EXPECT_LT(3.0 * model.slope_x_sigma, 0.1 / (size.width / 2.0));
      EXPECT_LT(3.0 * model.slope_y_sigma, 0.1 / (size.height / 2.0));
      EXPECT_LT(3.0 * model.twist_sigma, 0.1 / (size.width / 2.0) / (size.height / 2.0));
    }
  }
}

TEST(MeasureVerticalOffset, SaysWhatTheCorrectionIsWorth) {
  const RenderOptions options = withOffset(1.2, 0.004, 0.0);
  const RenderedScene scene = renderScene(351, 263, 4, options);
  const auto measurement = measureVerticalOffset(scene.left, scene.right, kRange, {});
  const double expected = measurement.model.rootMeanSquare(scene.left.size());
  EXPECT_NEAR(measurement.rms_before_px, expected,
              0.2 * expected);  // matches do not cover the whole image
  EXPECT_LT(measurement.rms_after_px, 0.1);
}

TEST(MeasureVerticalOffset, TellsWhatIsTooSmallToCorrect) {
  const RenderedScene scene = renderScene(351, 263, 2, withOffset(0.5, 0.0, 0.0));
  RectificationOptions coarse;
  coarse.min_correction_px = 0.7;
  const auto measurement = measureVerticalOffset(scene.left, scene.right, kRange, coarse);
  EXPECT_NEAR(measurement.model.offset_px, 0.5, 0.05);
  EXPECT_TRUE(measurement.is_significant);
  EXPECT_TRUE(toCorrection(measurement, scene.left.size(), coarse).isZero());
  EXPECT_EQ(toCorrection(measurement, scene.left.size(), {}).offset_px,
            measurement.model.offset_px);
}

TEST(EstimateVerticalOffset, RecoversWithNegativeDisparities) {
  const RenderOptions options = withOffset(0.8, 0.0, 0.0);
  const RenderedScene scene = renderScene(363, 263, 3, options);
  const cv::Mat left = scene.left.colRange(12, 363);
  const cv::Mat right = scene.right.colRange(0, 351);
  const VerticalOffset model = estimateVerticalOffset(left, right, {-12, 32}, {});
  EXPECT_LT(largestError(model, options, left.size()), 0.05);
}

TEST(EstimateVerticalOffset, SurvivesNoiseInAThirdOfTheImage) {
  const RenderOptions options = withOffset(0.7, 0.003, 0.0);
  const RenderedScene scene = renderScene(351, 263, 4, options);
  noise({117, 263}, 5).copyTo(scene.right.colRange(117, 234));
  const VerticalOffset model = estimateVerticalOffset(scene.left, scene.right, kRange, {});
  EXPECT_LT(largestError(model, options, scene.left.size()), 0.05);
}

/// A quarter of the matches agree on another offset, in one corner where a tilted model could fit
/// them.
TEST(EstimateVerticalOffset, RejectsAQuarterThatMovedOtherwise) {
  const RenderOptions options = withOffset(0.7, 0.0, 0.0);
  const RenderedScene scene = renderScene(351, 263, 4, options);
  const RenderedScene other = renderScene(351, 263, 4, withOffset(-1.5, 0.0, 0.0));
  const cv::Rect quarter(0, 0, 175, 131);
  other.right(quarter).copyTo(scene.right(quarter));
  const VerticalOffset model = estimateVerticalOffset(scene.left, scene.right, kRange, {});
  EXPECT_LT(largestError(model, options, scene.left.size()), 0.05);
}

TEST(EstimateVerticalOffset, RepetitiveTextureGivesNoEstimate) {
  cv::Mat image(263, 351, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<uchar>(y, x) = static_cast<uchar>(
          128.0 + 50.0 * (std::sin(2.0 * CV_PI * x / 12.0) + std::sin(2.0 * CV_PI * y / 6.0)));
    }
  }
  expectNoEstimate(estimateVerticalOffset(image, image, {-16, 33}, {}));
}

TEST(EstimateVerticalOffset, AlignedPairsGetTheZeroModel) {
  for (int seed = 1; seed <= 4; ++seed) {
    const RenderedScene scene = renderScene(351, 263, seed);
    const VerticalOffset model = estimateVerticalOffset(scene.left, scene.right, kRange, {});
    EXPECT_TRUE(model.isZero());
    EXPECT_GE(model.matches, 40);
  }
}

TEST(EstimateVerticalOffset, ImagesWithoutMatchesGiveNoEstimate) {
  const cv::Size size(351, 263);
  expectNoEstimate(estimateVerticalOffset(noise(size, 1), noise(size, 2), kRange, {}));
  cv::Mat smooth[2] = {noise(size, 3), noise(size, 4)};
  for (cv::Mat& image : smooth) {
    cv::GaussianBlur(image, image, cv::Size(), 3.0);
  }
  expectNoEstimate(estimateVerticalOffset(smooth[0], smooth[1], kRange, {}));
  const cv::Mat gray(size, CV_8UC1, cv::Scalar(90));
  expectNoEstimate(estimateVerticalOffset(gray, gray, kRange, {}));
  const RenderedScene scene = renderScene(351, 263, 1);
  expectNoEstimate(estimateVerticalOffset(scene.left, scene.right, {400, 16}, {}));
}

TEST(EstimateVerticalOffset, AnOffsetBeyondTheLimitGivesNoEstimate) {
  const RenderedScene scene = renderScene(351, 263, 2, withOffset(9.0, 0.0, 0.0));
  expectNoEstimate(estimateVerticalOffset(scene.left, scene.right, kRange, {}));
  RectificationOptions wide;
  wide.max_offset_px = 12.0;
  EXPECT_NEAR(estimateVerticalOffset(scene.left, scene.right, kRange, wide).offset_px, 9.0, 0.05);
}

TEST(EstimateVerticalOffset, SmallImagesGiveNoEstimate) {
  for (const cv::Size size :
       {cv::Size(200, 1), cv::Size(1, 200), cv::Size(31, 200), cv::Size(33, 32), cv::Size(1, 1)}) {
    expectNoEstimate(estimateVerticalOffset(noise(size, 1), noise(size, 1), kRange, {}));
  }
}

TEST(EstimateVerticalOffset, ObeysItsOptions) {
  const RenderedScene scene = renderScene(351, 263, 2, withOffset(0.5, 0.0, 0.0));
  const auto estimate = [&](const RectificationOptions& options) {
    return estimateVerticalOffset(scene.left, scene.right, kRange, options);
  };
  RectificationOptions off;
  off.enabled = false;
  expectNoEstimate(estimate(off));
  RectificationOptions demanding;
  demanding.min_matches = demanding.max_features + 1;
  expectNoEstimate(estimate(demanding));
  RectificationOptions coarse;
  coarse.min_correction_px = 0.7;
  EXPECT_TRUE(estimate(coarse).isZero());
  EXPECT_GE(estimate(coarse).matches, 40);
}

TEST(EstimateVerticalOffset, IsDeterministic) {
  const RenderedScene scene = renderScene(351, 263, 2, withOffset(0.5, 0.001, 0.0));
  const VerticalOffset first = estimateVerticalOffset(scene.left, scene.right, kRange, {});
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const VerticalOffset second = estimateVerticalOffset(scene.left, scene.right, kRange, {});
  cv::setNumThreads(threads);
  EXPECT_EQ(first.offset_px, second.offset_px);
  EXPECT_EQ(first.slope_x, second.slope_x);
  EXPECT_EQ(first.slope_y, second.slope_y);
  EXPECT_EQ(first.twist, second.twist);
  EXPECT_EQ(first.curvature_x, second.curvature_x);
  EXPECT_EQ(first.curvature_y, second.curvature_y);
  EXPECT_EQ(first.matches, second.matches);
}

TEST(EstimateVerticalOffset, RejectsOtherImages) {
  const cv::Mat gray = noise({64, 48}, 1);
  EXPECT_THROW(estimateVerticalOffset(gray, gray.rowRange(0, 40), kRange, {}), Error);
  EXPECT_THROW(estimateVerticalOffset(gray, cv::Mat::zeros(48, 64, CV_8UC3), kRange, {}), Error);
  EXPECT_THROW(estimateVerticalOffset(cv::Mat::zeros(48, 64, CV_16UC1), gray, kRange, {}), Error);
}

/// Weight of a sample at distance t for cubic convolution with OpenCV's parameter −0.75.
double cubicWeight(double t) {
  const double a = -0.75;
  t = std::abs(t);
  if (t <= 1.0) {
    return ((a + 2.0) * t - (a + 3.0)) * t * t + 1.0;
  }
  return t < 2.0 ? a * (((t - 5.0) * t + 8.0) * t - 4.0) : 0.0;
}

double interpolated(const cv::Mat& image, int x, double y) {
  double sum = 0.0;
  const int base = static_cast<int>(std::floor(y));
  for (int row = base - 1; row <= base + 2; ++row) {
    sum += cubicWeight(y - row) * image.at<uchar>(std::clamp(row, 0, image.rows - 1), x);
  }
  return std::clamp(sum, 0.0, 255.0);
}

TEST(AlignRightRows, ResamplesAlongTheColumns) {
  VerticalOffset model;
  model.offset_px = -1.75;
  model.slope_x = 0.02;
  model.slope_y = 0.05;
  model.twist = 0.002;
  model.curvature_x = -0.001;
  model.curvature_y = 0.003;
  for (const cv::Size size : {cv::Size(47, 31), cv::Size(1, 9), cv::Size(23, 1)}) {
    const cv::Mat image = noise(size, 9);
    const cv::Mat aligned = alignRightRows(image, model);
    ASSERT_EQ(aligned.size(), size);
    ASSERT_EQ(aligned.type(), CV_8UC1);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        // OpenCV rounds coordinates to 1/32 px. The tolerance covers ties and 15-bit weights.
        const double exact = std::round(32.0 * (y + model.at(x, y, size))) / 32.0;
        ASSERT_NEAR(aligned.at<uchar>(y, x), interpolated(image, x, exact), 1.5) << x << ' ' << y;
      }
    }
  }
}

TEST(AlignRightRows, TheZeroModelCopiesNothing) {
  const cv::Mat image = noise({20, 10}, 1);
  EXPECT_EQ(alignRightRows(image, {}).data, image.data);
}

TEST(AlignRightRows, ColorIsAlignedLikeGray) {
  VerticalOffset model;
  model.offset_px = 0.3;
  const cv::Mat gray = noise({20, 10}, 1);
  cv::Mat color;
  cv::cvtColor(gray, color, cv::COLOR_GRAY2BGR);
  cv::Mat expected;
  cv::cvtColor(alignRightRows(gray, model), expected, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(cv::norm(alignRightRows(color, model), expected, cv::NORM_INF), 0.0);
}

TEST(AlignRightRows, UndoesWhatWasEstimated) {
  const RenderedScene straight = renderScene(351, 263, 6);
  const RenderedScene scene =
      renderScene(351, 263, 6, withOffset(1.4, 0.004, -0.003, 3e-5, 2e-5, -2e-5));
  const VerticalOffset model = estimateVerticalOffset(scene.left, scene.right, kRange, {});
  const cv::Mat aligned = alignRightRows(scene.right, model);
  EXPECT_TRUE(estimateVerticalOffset(scene.left, aligned, kRange, {}).isZero());
  const cv::Rect inner(4, 4, 343, 255);  // rows from outside the image are unknown
  const double before = cv::norm(scene.right(inner), straight.right(inner), cv::NORM_L1);
  const double after = cv::norm(aligned(inner), straight.right(inner), cv::NORM_L1);
  EXPECT_LT(after, 0.1 * before);
}

class MiddleburyOffsets : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("CBMV_DATA") == nullptr) {
      GTEST_SKIP() << "CBMV_DATA names no data folder";
    }
  }

  static VerticalOffset estimate(const std::string& name) {
    const StereoScene scene =
        readMiddleburyScene(std::getenv("CBMV_DATA") + ("/middlebury_eval3_Q/" + name));
    return estimateVerticalOffset(scene.left, scene.right, {0, scene.calibration.disparities}, {});
  }
};

TEST_F(MiddleburyOffsets, PerfectPairsAreLeftAlone) {
  for (const char* name : {"ArtL", "PlaytableP", "Teddy"}) {
    EXPECT_TRUE(estimate(name).isZero()) << name;
  }
}

TEST_F(MiddleburyOffsets, ImperfectPairsAreCorrected) {
  EXPECT_NEAR(estimate("Motorcycle").offset_px, -0.23, 0.1);
  EXPECT_NEAR(estimate("MotorcycleE").offset_px, -0.23, 0.1);
  EXPECT_NEAR(estimate("Playtable").offset_px, 0.24, 0.1);
  EXPECT_NEAR(estimate("Adirondack").offset_px, -0.18, 0.1);
}

}  // namespace
}  // namespace cbmv
