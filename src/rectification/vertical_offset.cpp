#include "cbmv_stereo/vertical_offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include <tbb/parallel_for.h>

#include "rectification/sparse_matches.h"

namespace cbmv {
namespace {

constexpr int kMinSide = 32;            // px; smaller images have too few matches for a fit
constexpr double kMaxResidual = 0.5;    // px; matches that scatter more are not usable
constexpr double kMinConsistent = 0.5;  // fraction of the matches that must agree with the model

constexpr int kSteps = 32;             // positions between two rows
constexpr int kWeightUnits = 1 << 15;  // sum of the weights at a position

/// Weights of the rows −1, 0, 1 and 2 relative to the row above the position, for each position.
using CubicWeights = std::array<std::array<int, 4>, kSteps>;

CubicWeights cubicWeights() {
  constexpr double a = -0.75;
  const auto outer = [](double t) { return a * t * (t - 1) * (t - 1); };
  const auto inner = [](double t) { return ((a + 2) * t - (a + 3)) * t * t + 1; };
  const auto in_units = [](double weight) {
    return static_cast<int>(std::lround(kWeightUnits * weight));
  };
  CubicWeights weights{};
  for (int step = 0; step < kSteps; ++step) {
    const double t = static_cast<double>(step) / kSteps;
    weights[step] = {in_units(outer(t)), in_units(inner(t)), in_units(inner(1 - t)),
                     in_units(outer(1 - t))};
  }
  return weights;
}

/// Resamples some columns of a row of the result, all from the same position in `image`: row place
/// / kSteps.
void resampleColumns(const cv::Mat& image, const cv::Range& columns, int place,
                     const CubicWeights& weights, std::uint8_t* out) {
  const int step = place & (kSteps - 1);
  const int above = (place - step) / kSteps;
  const std::array<int, 4>& weight = weights[step];
  std::array<const std::uint8_t*, 4> rows{};
  for (int k = 0; k < 4; ++k) {
    rows[k] = image.ptr(std::clamp(above - 1 + k, 0, image.rows - 1));
  }
  for (int i = columns.start * image.channels(); i < columns.end * image.channels(); ++i) {
    const int sum = weight[0] * rows[0][i] + weight[1] * rows[1][i] + weight[2] * rows[2][i] +
                    weight[3] * rows[3][i] + kWeightUnits / 2;
    out[i] = static_cast<std::uint8_t>(std::clamp(sum / kWeightUnits, 0, 255));
  }
}

/// Resamples row y of the aligned image. The offset changes slowly, so runs of columns share a
/// position.
void alignRow(const cv::Mat& right, int y, const VerticalOffset& model, const CubicWeights& weights,
              std::uint8_t* out) {
  const auto place_of = [&](int x) {
    return static_cast<int>(
        std::lrint(kSteps * static_cast<float>(y + model.at(x, y, right.size()))));
  };
  int place = place_of(0);
  for (int x = 0; x < right.cols;) {
    cv::Range columns(x, x + 1);
    int next = place;
    while (columns.end < right.cols && (next = place_of(columns.end)) == place) {
      ++columns.end;
    }
    resampleColumns(right, columns, place, weights, out);
    place = next;
    x = columns.end;
  }
}

}  // namespace

bool RectificationOptions::operator==(const RectificationOptions& other) const {
  const auto fields = [](const RectificationOptions& o) {
    return std::tie(o.enabled, o.max_offset_px, o.max_features, o.min_matches, o.min_correction_px,
                    o.interval_s, o.smoothing);
  };
  return fields(*this) == fields(other);
}

double VerticalOffset::at(double x, double y, cv::Size size) const {
  const double u = x - 0.5 * (size.width - 1);
  const double v = y - 0.5 * (size.height - 1);
  return offset_px + (slope_x + curvature_x * u) * u + (slope_y + curvature_y * v + twist * u) * v;
}

double VerticalOffset::rootMeanSquare(cv::Size size) const {
  const double half_width = 0.5 * (size.width - 1);
  const double half_height = 0.5 * (size.height - 1);
  const double x = slope_x * half_width;
  const double y = slope_y * half_height;
  const double xy = twist * half_width * half_height;
  const double xx = curvature_x * half_width * half_width;
  const double yy = curvature_y * half_height * half_height;
  const double mean = offset_px + (xx + yy) / 3.0;
  return std::sqrt(mean * mean + (x * x + y * y) / 3.0 + xy * xy / 9.0 +
                   (xx * xx + yy * yy) * 4.0 / 45.0);
}

void VerticalOffset::clearCorrection() {
  offset_px = slope_x = slope_y = twist = curvature_x = curvature_y = 0.0;
}

bool VerticalOffset::isZero() const {
  return offset_px == 0.0 && slope_x == 0.0 && slope_y == 0.0 && twist == 0.0 &&
         curvature_x == 0.0 && curvature_y == 0.0;
}

VerticalOffsetMeasurement measureVerticalOffset(const cv::Mat& left, const cv::Mat& right,
                                                const DisparityRange& range,
                                                const RectificationOptions& options) {
  requireGrayPair(left, right);
  if (!options.enabled || std::min(left.cols, left.rows) < kMinSide) {
    return {};
  }
  const std::vector<SparseMatch> matches = findSparseMatches(left, right, range, options);
  const int min_matches = std::max(options.min_matches, VerticalOffset::kParameters);
  if (static_cast<int>(matches.size()) < min_matches) {
    return {};
  }
  const VerticalOffsetMeasurement measurement = fitVerticalOffset(matches, left.size());
  const VerticalOffset& model = measurement.model;
  if (model.matches < min_matches || model.residual_px > kMaxResidual ||
      model.matches < kMinConsistent * static_cast<double>(matches.size())) {
    return {};
  }
  return measurement;
}

VerticalOffset toCorrection(const VerticalOffsetMeasurement& measurement, cv::Size size,
                            const RectificationOptions& options) {
  VerticalOffset model = measurement.model;
  if (!measurement.is_significant || model.rootMeanSquare(size) < options.min_correction_px) {
    model.clearCorrection();
  }
  return model;
}

VerticalOffset estimateVerticalOffset(const cv::Mat& left, const cv::Mat& right,
                                      const DisparityRange& range,
                                      const RectificationOptions& options) {
  return toCorrection(measureVerticalOffset(left, right, range, options), left.size(), options);
}

cv::Mat alignRightRows(const cv::Mat& right, const VerticalOffset& model, cv::Mat& aligned) {
  if (model.isZero()) {
    return right;
  }
  CV_Assert(right.depth() == CV_8U && right.data != aligned.data);
  aligned.create(right.size(), right.type());
  const CubicWeights weights = cubicWeights();
  tbb::parallel_for(0, right.rows, [&](int y) {
    alignRow(right, y, model, weights, aligned.ptr<std::uint8_t>(y));
  });
  return aligned;
}

cv::Mat alignRightRows(const cv::Mat& right, const VerticalOffset& model) {
  cv::Mat aligned;
  return alignRightRows(right, model, aligned);
}

}  // namespace cbmv
