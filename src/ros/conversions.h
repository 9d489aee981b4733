#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/io/calibration.h"
#include "cbmv_stereo/io/ply.h"
#include "cbmv_stereo/pipeline/stereo_matcher.h"
#include <cbmv_stereo/Status.h>

// The one place in which ROS messages become the core's types and back.

namespace cbmv {

/// One synchronised set of input messages, each with the topic it came on.
struct StereoMessages {
  sensor_msgs::ImageConstPtr left_image;
  sensor_msgs::CameraInfoConstPtr left_info;
  sensor_msgs::ImageConstPtr right_image;
  sensor_msgs::CameraInfoConstPtr right_info;
};

/// Resolved topic names of the inputs, for messages to people.
struct StereoTopics {
  std::string left_image;
  std::string left_info;
  std::string right_image;
  std::string right_info;
};

/// What is wrong with a set of input messages.
enum class InputFault {
  kEmptyImage,
  kUnsupportedEncoding,
  kTruncatedImage,
  kDifferentFrameIds,
  kDifferentSizes,
  kDifferentEncodings,
  kUncalibrated,
  kCameraInfoSize,
  kDisparityRange,
  kMemory,
};

/// Input messages that cannot be used; the sentence names the topic.
class InputError : public Error {
 public:
  InputError(InputFault fault, const std::string& sentence) : Error(sentence), fault_(fault) {}
  InputFault fault() const { return fault_; }

 private:
  InputFault fault_;
};

/// The pair as CV_8UC1. May share the messages' memory: they have to live as long.
struct GreyPair {
  cv::Mat left;
  cv::Mat right;
};

/// Checks both images and converts them to grey. Throws InputError.
GreyPair toGreyPair(const StereoMessages& messages, const StereoTopics& topics,
                    bool allow_different_frame_ids);

/// Image in colour, CV_8UC3 in the order blue, green, red, from mono8, rgb8, bgr8, rgba8 or bgra8.
/// Throws InputError for other encodings, and for other sizes than `size`.
cv::Mat toColor(const sensor_msgs::Image& message, const std::string& topic, cv::Size size);

/// The rectified stereo camera, from the projection matrices, in pixels of the images as they are
/// sent (after binning and region of interest).
struct StereoGeometry {
  double focal_length_px = 0;  ///< of the right camera, horizontal: f in Z = f T / d
  double baseline_m = 0;       ///< T > 0: the right camera lies to the right of the left one
  /// cx_left − cx_right, 0 unless the rig is verged: a point at infinity is matched at this
  /// disparity, so it is taken off (once) of what is published.
  double disparity_offset_px = 0;
  double left_fx_px = 0;
  double left_fy_px = 0;
  double left_cx_px = 0;
  double left_cy_px = 0;
};

/// Throws InputError if a camera is not calibrated, if left and right are swapped, or if a
/// camera_info does not fit its image's size.
StereoGeometry toGeometry(const StereoMessages& messages, const StereoTopics& topics);

/// Smallest step between two disparities that `options` can give, in pixels: 1 if they are whole
/// pixels, else the spacing of float at the largest disparity of `range`.
double disparityStep(const DisparityRange& range, const RefinementOptions& options);

/// Conventions of stereo_image_proc: image 32FC1, f and T as in StereoGeometry, max_disparity the
/// largest that is tested. Published disparities, min_disparity and max_disparity are the matcher's
/// minus geometry.disparity_offset_px, so that Z = f T / d; pixels without a disparity hold
/// min_disparity − 1. valid_window: the columns in which at least one hypothesis exists.
stereo_msgs::DisparityImage toDisparityImage(const StereoResult& result,
                                             const StereoGeometry& geometry, double delta_d,
                                             const std_msgs::Header& header);

/// Organised cloud in the left camera's optical frame, in metres: fields x, y, z, rgb (float at
/// byte 0, 4, 8, 16; 32 bytes a point). Points without a disparity, or at or beyond infinity, have
/// NaN in x, y, z. `color` is CV_8UC3 in the order blue, green, red.
sensor_msgs::PointCloud2 toPointCloud(const StereoResult& result, const StereoGeometry& geometry,
                                      const cv::Mat& color, const std_msgs::Header& header);

/// 32FC1 in [0, 1], see StereoResult::confidence.
sensor_msgs::Image toConfidenceImage(const StereoResult& result, const std_msgs::Header& header);

/// bgr8 for viewers: from blue at the smallest disparity of the range to red at the largest; black
/// where there is none.
sensor_msgs::Image toDisparityColorImage(const StereoResult& result,
                                         const std_msgs::Header& header);

/// What became of the frames since the node came up.
struct FrameCounts {
  std::uint64_t processed = 0;
  std::uint64_t dropped_busy = 0;
  std::uint64_t dropped_bad_input = 0;
  std::uint64_t dropped_failed = 0;
};

/// What Status says about the node besides the frame.
struct NodeState {
  FrameCounts counts;
  std::string forest;  ///< file name
  int threads = 0;     ///< in use
  double age_ms = 0;   ///< from the frame's stamp to now
};

cbmv_stereo::Status toStatus(const StereoResult& result, const NodeState& state,
                             const std_msgs::Header& header);

/// A pair as a driver and image_proc publish it.
struct RecordedPair {
  sensor_msgs::Image left_grey;   ///< mono8
  sensor_msgs::Image left_color;  ///< bgr8
  sensor_msgs::Image right_grey;  ///< mono8
  sensor_msgs::CameraInfo left_info;
  sensor_msgs::CameraInfo right_info;
};

/// `left` and `right` are CV_8UC3 in the order blue, green, red; both get the same header, as
/// stereo rigs have it after rectification.
RecordedPair toRecordedPair(const cv::Mat& left, const cv::Mat& right,
                            const StereoCalibration& calibration, const std_msgs::Header& header);

/// Disparities of a message, back in pixels of the images.
struct RecordedDisparity {
  cv::Mat values;  ///< CV_32FC1; `invalid` where there is none
  float lowest = 0;
  float highest = 0;
  float invalid = 0;
};

/// Takes back the offset that toDisparityImage took off.
RecordedDisparity fromDisparityImage(const stereo_msgs::DisparityImage& message,
                                     double disparity_offset_px);

/// Copy of a 32FC1 image.
cv::Mat fromFloatImage(const sensor_msgs::Image& message);

/// The points of a cloud from toPointCloud that are not NaN.
std::vector<ColoredPoint> fromPointCloud(const sensor_msgs::PointCloud2& message);

}  // namespace cbmv
