#include "ros/conversions.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include <cv_bridge/cv_bridge.h>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "cbmv_stereo/io/preview.h"

namespace cbmv {
namespace {

namespace encodings = sensor_msgs::image_encodings;

std::string sizeText(cv::Size size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height) + " px";
}

cv::Size imageSize(const sensor_msgs::Image& message) {
  return {static_cast<int>(message.width), static_cast<int>(message.height)};
}

std::size_t bytesPerPixel(const sensor_msgs::Image& message, const std::string& topic) {
  try {
    return static_cast<std::size_t>(encodings::bitDepth(message.encoding)) / 8 *
           encodings::numChannels(message.encoding);
  } catch (const std::runtime_error&) {
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " has the encoding '" + message.encoding +
                         "', which is unknown; mono8 or a colour encoding would be right");
  }
}

void checkImage(const sensor_msgs::Image& message, const std::string& topic) {
  if (message.width == 0 || message.height == 0) {
    throw InputError(InputFault::kEmptyImage,
                     topic + " is an empty image (" + sizeText(imageSize(message)) + ")");
  }
  const std::size_t row_bytes = bytesPerPixel(message, topic) * message.width;
  if (message.step < row_bytes) {
    throw InputError(InputFault::kTruncatedImage,
                     topic + " has a step of " + std::to_string(message.step) +
                         " bytes, a row of " + std::to_string(message.width) + " px " +
                         message.encoding + " needs " + std::to_string(row_bytes));
  }
  const std::size_t image_bytes = static_cast<std::size_t>(message.step) * message.height;
  if (message.data.size() != image_bytes) {
    throw InputError(InputFault::kTruncatedImage, topic + " holds " +
                                                      std::to_string(message.data.size()) +
                                                      " bytes, " + std::to_string(message.height) +
                                                      " rows of " + std::to_string(message.step) +
                                                      " bytes are " + std::to_string(image_bytes));
  }
}

/// The conversion of cv_bridge with its exceptions made InputError.
cv::Mat convert(const sensor_msgs::Image& message, const boost::shared_ptr<const void>& owner,
                const std::string& encoding, const std::string& topic) {
  try {
    return cv_bridge::toCvShare(message, owner, encoding)->image;
  } catch (const std::exception& error) {  // cv_bridge's own and OpenCV's
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " has the encoding '" + message.encoding +
                         "', which cannot be converted to " + encoding + ": " + error.what());
  }
}

/// The part of a projection matrix that is used, in pixels of the image as it is sent.
struct Projection {
  double fx;
  double fy;
  double cx;
  double cy;
  double tx;  ///< P[3]: −fx times the camera's place on the baseline, px m
};

/// Size of the images that belong to `info`.
cv::Size describedSize(const sensor_msgs::CameraInfo& info) {
  const bool whole = info.roi.width == 0 || info.roi.height == 0;
  const std::uint32_t width = whole ? info.width : info.roi.width;
  const std::uint32_t height = whole ? info.height : info.roi.height;
  return {static_cast<int>(width / std::max(1U, info.binning_x)),
          static_cast<int>(height / std::max(1U, info.binning_y))};
}

void checkInfo(const sensor_msgs::CameraInfo& info, const std::string& topic, cv::Size image_size) {
  if (describedSize(info) != image_size) {
    throw InputError(InputFault::kCameraInfoSize, topic + " describes images of " +
                                                      sizeText(describedSize(info)) +
                                                      ", the image has " + sizeText(image_size));
  }
  const bool finite =
      std::all_of(info.P.begin(), info.P.end(), [](double value) { return std::isfinite(value); });
  if (!finite || info.P[0] <= 0 || info.P[5] <= 0) {
    throw InputError(InputFault::kUncalibrated,
                     topic + " has no usable projection matrix (P[0] = " +
                         std::to_string(info.P[0]) + ", P[5] = " + std::to_string(info.P[5]) +
                         "; both have to be > 0): calibrate the cameras");
  }
}

/// P refers to the whole sensor without binning.
Projection toProjection(const sensor_msgs::CameraInfo& info) {
  const double binning_x = std::max(1U, info.binning_x);
  const double binning_y = std::max(1U, info.binning_y);
  return {info.P[0] / binning_x, info.P[5] / binning_y, (info.P[2] - info.roi.x_offset) / binning_x,
          (info.P[6] - info.roi.y_offset) / binning_y, info.P[3] / binning_x};
}

sensor_msgs::RegionOfInterest validWindow(const DisparityRange& range, cv::Size size) {
  const int first = std::clamp(range.min, 0, size.width);
  const int end = std::clamp(size.width + range.max(), first, size.width);
  sensor_msgs::RegionOfInterest window;
  window.x_offset = static_cast<std::uint32_t>(first);
  window.width = static_cast<std::uint32_t>(end - first);
  window.height = static_cast<std::uint32_t>(size.height);
  return window;
}

sensor_msgs::Image toMessage(const cv::Mat& image, const std::string& encoding,
                             const std_msgs::Header& header) {
  sensor_msgs::Image message;
  cv_bridge::CvImage(header, encoding, image).toImageMsg(message);
  return message;
}

sensor_msgs::PointCloud2 makeCloud(cv::Size size, const std_msgs::Header& header) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header = header;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2FieldsByString(2, "xyz", "rgb");
  modifier.resize(static_cast<std::size_t>(size.area()));
  cloud.width = static_cast<std::uint32_t>(size.width);
  cloud.height = static_cast<std::uint32_t>(size.height);
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.is_bigendian = 0;
  cloud.is_dense = 0;
  return cloud;
}

/// Point of pixel (x, y) in metres; NaN if `disparity_px` is not positive.
cv::Vec3f toPoint(const StereoGeometry& geometry, int x, int y, double disparity_px) {
  if (!(disparity_px > 0)) {
    return cv::Vec3f::all(std::numeric_limits<float>::quiet_NaN());
  }
  const double z = geometry.focal_length_px * geometry.baseline_m / disparity_px;
  return {static_cast<float>((x - geometry.left_cx_px) * z / geometry.left_fx_px),
          static_cast<float>((y - geometry.left_cy_px) * z / geometry.left_fy_px),
          static_cast<float>(z)};
}

/// Of a rectified camera without distortion: K, R, P of calib.txt's one focal length.
sensor_msgs::CameraInfo toCameraInfo(const StereoCalibration& calibration, double cx, double tx,
                                     const std_msgs::Header& header) {
  const double f = calibration.focal_length_px;
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(calibration.width);
  info.height = static_cast<std::uint32_t>(calibration.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {f, 0, cx, 0, f, calibration.cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {f, 0, cx, tx, 0, f, calibration.cy, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace

GreyPair toGreyPair(const StereoMessages& messages, const StereoTopics& topics,
                    bool allow_different_frame_ids) {
  const sensor_msgs::Image& left = *messages.left_image;
  const sensor_msgs::Image& right = *messages.right_image;
  checkImage(left, topics.left_image);
  checkImage(right, topics.right_image);
  const std::string both = topics.left_image + " and " + topics.right_image;
  if (imageSize(left) != imageSize(right)) {
    throw InputError(InputFault::kDifferentSizes,
                     both + " differ in size (" + sizeText(imageSize(left)) + " and " +
                         sizeText(imageSize(right)) + "); a rectified pair has one size");
  }
  if (left.encoding != right.encoding) {
    throw InputError(InputFault::kDifferentEncodings,
                     both + " differ in encoding ('" + left.encoding + "' and '" + right.encoding +
                         "'); both images have to have the same");
  }
  if (left.header.frame_id != right.header.frame_id && !allow_different_frame_ids) {
    throw InputError(InputFault::kDifferentFrameIds,
                     both + " differ in frame_id ('" + left.header.frame_id + "' and '" +
                         right.header.frame_id +
                         "'); a rectified pair has the left camera's, or set the parameter "
                         "allow_different_frame_ids");
  }
  return {convert(left, messages.left_image, encodings::MONO8, topics.left_image),
          convert(right, messages.right_image, encodings::MONO8, topics.right_image)};
}

cv::Mat toColor(const sensor_msgs::Image& message, const std::string& topic, cv::Size size) {
  const auto& encoding = message.encoding;
  if (encoding != encodings::MONO8 && encoding != encodings::RGB8 && encoding != encodings::BGR8 &&
      encoding != encodings::RGBA8 && encoding != encodings::BGRA8) {
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " has the encoding '" + encoding +
                         "'; mono8, rgb8, bgr8, rgba8 or bgra8 would be right");
  }
  checkImage(message, topic);
  if (imageSize(message) != size) {
    throw InputError(InputFault::kDifferentSizes, topic + " has " + sizeText(imageSize(message)) +
                                                      ", the rectified pair " + sizeText(size) +
                                                      "; they have to be the same");
  }
  return convert(message, nullptr, encodings::BGR8, topic);
}

StereoGeometry toGeometry(const StereoMessages& messages, const StereoTopics& topics) {
  checkInfo(*messages.left_info, topics.left_info, imageSize(*messages.left_image));
  checkInfo(*messages.right_info, topics.right_info, imageSize(*messages.right_image));
  const Projection left = toProjection(*messages.left_info);
  const Projection right = toProjection(*messages.right_info);
  if (right.tx >= 0) {
    throw InputError(InputFault::kUncalibrated,
                     topics.right_info + " has P[3] = " + std::to_string(right.tx) +
                         ", which has to be negative (-fx * baseline): the cameras are swapped, or "
                         "calibrated one by one");
  }
  StereoGeometry geometry;
  geometry.focal_length_px = right.fx;
  geometry.baseline_m = -right.tx / right.fx;
  geometry.disparity_offset_px = left.cx - right.cx;
  geometry.left_fx_px = left.fx;
  geometry.left_fy_px = left.fy;
  geometry.left_cx_px = left.cx;
  geometry.left_cy_px = left.cy;
  return geometry;
}

double disparityStep(const DisparityRange& range, const RefinementOptions& options) {
  if (!options.subpixel && options.bilateral_sigma_px == 0) {
    return 1;
  }
  const auto largest = static_cast<float>(std::max(std::abs(range.min), std::abs(range.max())));
  return std::nextafter(largest, std::numeric_limits<float>::infinity()) - largest;
}

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
  message.valid_window = validWindow(result.range, result.disparity.size());

  message.image = toMessage(result.disparity, encodings::TYPE_32FC1, header);
  cv::Mat_<float> published(result.disparity.rows, result.disparity.cols,
                            reinterpret_cast<float*>(message.image.data.data()),
                            message.image.step);
  const float invalid = message.min_disparity - 1.0F;
  for (float& disparity : published) {
    disparity =
        disparity == result.range.invalid() ? invalid : static_cast<float>(disparity - offset);
  }
  return message;
}

sensor_msgs::PointCloud2 toPointCloud(const StereoResult& result, const StereoGeometry& geometry,
                                      const cv::Mat& color, const std_msgs::Header& header) {
  sensor_msgs::PointCloud2 cloud = makeCloud(result.disparity.size(), header);
  sensor_msgs::PointCloud2Iterator<float> point(cloud, "x");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> point_color(cloud, "rgb");
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  for (int y = 0; y < result.disparity.rows; ++y) {
    for (int x = 0; x < result.disparity.cols; ++x, ++point, ++point_color) {
      const float found = result.disparity.at<float>(y, x);
      const double disparity =
          found == result.range.invalid() ? nothing : found - geometry.disparity_offset_px;
      const cv::Vec3f xyz = toPoint(geometry, x, y, disparity);
      std::copy_n(xyz.val, 3, &point[0]);
      std::copy_n(color.at<cv::Vec3b>(y, x).val, 3, &point_color[0]);
    }
  }
  return cloud;
}

sensor_msgs::Image toConfidenceImage(const StereoResult& result, const std_msgs::Header& header) {
  return toMessage(result.confidence, encodings::TYPE_32FC1, header);
}

sensor_msgs::Image toDisparityColorImage(const StereoResult& result,
                                         const std_msgs::Header& header) {
  const DisparityRange& range = result.range;
  const cv::Mat color = colorizeDisparity(result.disparity, static_cast<float>(range.min),
                                          static_cast<float>(range.max()), range.invalid());
  return toMessage(color, encodings::BGR8, header);
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
  status.vertical_offset_sigma_px = result.rectification.offset_sigma_px;
  status.vertical_offset_residual_px = result.rectification.residual_px;
  status.vertical_offset_matches = result.rectification.matches;
  status.forest = state.forest;
  status.threads = state.threads;
  return status;
}

RecordedPair toRecordedPair(const cv::Mat& left, const cv::Mat& right,
                            const StereoCalibration& calibration, const std_msgs::Header& header) {
  RecordedPair pair;
  cv::Mat grey;
  cv::cvtColor(left, grey, cv::COLOR_BGR2GRAY);
  pair.left_grey = toMessage(grey, encodings::MONO8, header);
  pair.left_color = toMessage(left, encodings::BGR8, header);
  cv::cvtColor(right, grey, cv::COLOR_BGR2GRAY);
  pair.right_grey = toMessage(grey, encodings::MONO8, header);
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

cv::Mat fromFloatImage(const sensor_msgs::Image& message) {
  return cv_bridge::toCvCopy(message, encodings::TYPE_32FC1)->image;
}

std::vector<ColoredPoint> fromPointCloud(const sensor_msgs::PointCloud2& message) {
  std::vector<ColoredPoint> points;
  sensor_msgs::PointCloud2ConstIterator<float> point(message, "x");
  sensor_msgs::PointCloud2ConstIterator<std::uint8_t> color(message, "rgb");
  for (; point != point.end(); ++point, ++color) {
    if (std::isfinite(point[2])) {
      points.push_back({point[0], point[1], point[2], color[2], color[1], color[0]});
    }
  }
  return points;
}

}  // namespace cbmv
