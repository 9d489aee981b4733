#include "ros/conversions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "io/preview.h"

#include "cbmv_stereo/points.h"

namespace cbmv {
namespace {

namespace encodings = sensor_msgs::image_encodings;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

cv::Mat isFound(const StereoResult& result) { return result.disparity != result.range.invalid(); }

sensor_msgs::RegionOfInterest validWindow(const StereoResult& result) {
  const cv::Size size = result.disparity.size();
  const cv::Mat found = isFound(result);
  int first = std::clamp(result.range.min, 0, size.width);
  int end = std::clamp(size.width + result.range.max(), first, size.width);
  if (cv::countNonZero(found.colRange(0, first)) > 0) {
    first = 0;
  }
  if (cv::countNonZero(found.colRange(end, size.width)) > 0) {
    end = size.width;
  }
  sensor_msgs::RegionOfInterest window;
  window.x_offset = static_cast<std::uint32_t>(first);
  window.width = static_cast<std::uint32_t>(end - first);
  window.height = static_cast<std::uint32_t>(size.height);
  return window;
}

/// Z in meters, CV_32FC1; NaN where there is no point.
cv::Mat depthOf(const StereoResult& result, const StereoGeometry& geometry) {
  return toDepth(toValidDisparity(result, geometry), geometry);
}

/// camera_info of a rectified camera without distortion; calib.txt has one focal length for x and
/// y.
sensor_msgs::CameraInfo toCameraInfo(const StereoCalibration& calibration, double cx, double tx,
                                     const std_msgs::Header& header) {
  StereoGeometry geometry;
  geometry.left_fx_px = geometry.left_fy_px = calibration.focal_length_px;
  geometry.left_cx_px = cx;
  geometry.left_cy_px = calibration.cy;
  auto info = toRectifiedInfo(geometry, {calibration.width, calibration.height}, header);
  info.P[3] = tx;
  return info;
}

}  // namespace

stereo_msgs::DisparityImage toDisparityImage(const StereoResult& result,
                                             const StereoGeometry& geometry, double delta_d,
                                             const std_msgs::Header& header) {
  const double offset = geometry.disparity_offset_px;
  stereo_msgs::DisparityImage message;
  message.header = header;
  message.f = static_cast<float>(geometry.focal_length_px);
  message.T = static_cast<float>(geometry.baseline_m);
  message.min_disparity = static_cast<float>(result.range.min - offset);
  message.max_disparity = static_cast<float>(result.range.max() - offset);
  message.delta_d = static_cast<float>(delta_d);
  message.valid_window = validWindow(result);
  cv::Mat published = toValidDisparity(result, geometry);
  cv::patchNaNs(published, message.min_disparity - 1.0F);
  message.image = toMessage(published, encodings::TYPE_32FC1, header);
  return message;
}

cv::Mat toValidDisparity(const StereoResult& result, const StereoGeometry& geometry) {
  return toValidDisparity(result.disparity, result.range.invalid(), geometry.disparity_offset_px);
}

cv::Mat toValidDisparity(const stereo_msgs::DisparityImage& message, const std::string& topic) {
  cv::Mat_<float> valid = toFloats(message.image, topic).clone();
  for (float& disparity : valid) {
    if (!std::isfinite(disparity) || disparity < message.min_disparity) {
      disparity = kNone;
    }
  }
  return valid;
}

sensor_msgs::Image toDepthImage(const StereoResult& result, const StereoGeometry& geometry,
                                const std_msgs::Header& header) {
  return toMessage(depthOf(result, geometry), encodings::TYPE_32FC1, header);
}

cv::Mat toDepthSigma(const StereoResult& result, const StereoGeometry& geometry) {
  return result.disparity_sigma.empty()
             ? cv::Mat()
             : toDepthSigma(toValidDisparity(result, geometry), result.disparity_sigma, geometry);
}

sensor_msgs::Image toDepthSigmaImage(const StereoResult& result, const StereoGeometry& geometry,
                                     const std_msgs::Header& header) {
  CV_Assert(!result.disparity_sigma.empty());
  return toMessage(toDepthSigma(result, geometry), encodings::TYPE_32FC1, header);
}

sensor_msgs::Image toRawDepthImage(const StereoResult& result, const StereoGeometry& geometry,
                                   const std_msgs::Header& header) {
  const cv::Mat_<float> depth = depthOf(result, geometry);
  cv::Mat_<std::uint16_t> raw(depth.size());
  std::transform(depth.begin(), depth.end(), raw.begin(), [](float meters) {
    const double millimeters = std::round(meters * 1000.0);
    const bool fits = millimeters <= std::numeric_limits<std::uint16_t>::max();  // false for NaN
    return static_cast<std::uint16_t>(fits ? millimeters : 0);
  });
  return toMessage(raw, encodings::TYPE_16UC1, header);
}

sensor_msgs::Image toValidMask(const StereoResult& result, const std_msgs::Header& header) {
  return toMessage(isFound(result), encodings::MONO8, header);
}

sensor_msgs::Image toConfidenceImage(const StereoResult& result, const std_msgs::Header& header) {
  return toMessage(result.confidence, encodings::TYPE_32FC1, header);
}

sensor_msgs::Image toDisparityColorImage(const StereoResult& result,
                                         const std_msgs::Header& header) {
  const DisparityRange& range = result.range;
  cv::Mat color = colorizeDisparity(result.disparity, static_cast<float>(range.min),
                                    static_cast<float>(range.max()), range.invalid());
  cv::cvtColor(color, color, cv::COLOR_BGR2RGB);
  return toMessage(color, encodings::RGB8, header);
}

cbmv_stereo::Status toStatus(const StereoResult& result, const NodeState& state,
                             const std_msgs::Header& header) {
  cbmv_stereo::Status status;
  status.header = header;
  status.rectification_ms = result.times.rectification_ms;
  status.volume_ms = result.times.volume_ms;
  status.aggregation_ms = result.times.aggregation_ms;
  status.sgm_ms = result.times.sgm_ms;
  status.refinement_ms = result.times.refinement_ms;
  status.selection_ms = result.times.selection_ms;
  status.total_ms = result.times.total_ms;
  status.age_ms = state.age_ms;
  const FrameCounts& counts = state.counts;
  status.frames_processed = counts.processed;
  status.frames_dropped = counts.dropped_busy + counts.dropped_bad_input + counts.dropped_failed;
  status.dropped_busy = counts.dropped_busy;
  status.dropped_bad_input = counts.dropped_bad_input;
  status.dropped_failed = counts.dropped_failed;
  status.vertical_offset_px = result.rectification.offset_px;
  status.vertical_offset_slope_x = result.rectification.slope_x;
  status.vertical_offset_slope_y = result.rectification.slope_y;
  status.vertical_offset_twist = result.rectification.twist;
  status.vertical_offset_curvature_x = result.rectification.curvature_x;
  status.vertical_offset_curvature_y = result.rectification.curvature_y;
  status.vertical_offset_sigma_px = result.rectification.offset_sigma_px;
  status.vertical_offset_residual_px = result.rectification.residual_px;
  status.vertical_offset_matches = result.rectification.matches;
  status.forest = state.forest;
  status.threads = state.threads;
  return status;
}

cbmv_stereo::Rectification toRectification(const RectificationState& state,
                                           const StereoResult& result,
                                           const std_msgs::Header& header) {
  const VerticalOffset& model = state.measurement.model;
  cbmv_stereo::Rectification message;
  message.header = header;
  message.is_corrected = static_cast<std::uint8_t>(!result.rectification.isZero());
  if (model.matches == 0) {
    return message;
  }
  message.matches = model.matches;
  message.age_s = state.age_s;
  message.offset_px = model.offset_px;
  message.slope_x = model.slope_x;
  message.slope_y = model.slope_y;
  message.twist = model.twist;
  message.curvature_x = model.curvature_x;
  message.curvature_y = model.curvature_y;
  message.offset_sigma_px = model.offset_sigma_px;
  message.slope_x_sigma = model.slope_x_sigma;
  message.slope_y_sigma = model.slope_y_sigma;
  message.twist_sigma = model.twist_sigma;
  message.curvature_x_sigma = model.curvature_x_sigma;
  message.curvature_y_sigma = model.curvature_y_sigma;
  message.rms_px = model.rootMeanSquare(result.disparity.size());
  message.rms_before_px = state.measurement.rms_before_px;
  message.rms_after_px = state.measurement.rms_after_px;
  return message;
}

RecordedPair toRecordedPair(const cv::Mat& left, const cv::Mat& right,
                            const StereoCalibration& calibration, const std_msgs::Header& header) {
  RecordedPair pair;
  cv::Mat gray;
  cv::cvtColor(left, gray, cv::COLOR_BGR2GRAY);
  pair.left_gray = toMessage(gray, encodings::MONO8, header);
  pair.left_color = toMessage(left, encodings::BGR8, header);
  cv::cvtColor(right, gray, cv::COLOR_BGR2GRAY);
  pair.right_gray = toMessage(gray, encodings::MONO8, header);
  pair.left_info = toCameraInfo(calibration, calibration.cx_left, 0, header);
  pair.right_info = toCameraInfo(calibration, calibration.cx_right,
                                 -calibration.focal_length_px * calibration.baseline_m, header);
  return pair;
}

RecordedDisparity fromDisparityImage(const stereo_msgs::DisparityImage& message,
                                     double disparity_offset_px) {
  const auto offset = static_cast<float>(disparity_offset_px);
  RecordedDisparity disparity;
  disparity.values = fromFloatImage(message.image) + offset;
  disparity.lowest = message.min_disparity + offset;
  disparity.highest = message.max_disparity + offset;
  disparity.invalid = disparity.lowest - 1.0F;
  const cv::Mat none = fromFloatImage(message.image) < message.min_disparity - 0.75F;
  disparity.values.setTo(disparity.invalid, none);
  return disparity;
}

}  // namespace cbmv
