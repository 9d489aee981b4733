#include "cbmv_stereo/calibration_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "input/camera_properties.h"

namespace cbmv {
namespace {

/// Limits in px or m. Products and quotients of larger values may not fit a float.
constexpr double kLargest = 1e9;
constexpr double kSmallest = 1e-9;

// Tolerances between calibrations of one rig, because files round the values.
constexpr double kSameRatio = 1e-3;   // relative, focal lengths
constexpr double kSameRowPx = 0.1;    // cy
constexpr double kSameOffset = 0.01;  // relative to the baseline: Ty, Tz
constexpr double kZeroRatio = 1e-6;   // relative to the focal length: entries of P that must be 0
constexpr double kShortestBaselineM = 0.005;
constexpr double kLongestBaselineM = 5.0;

/// The values used from a projection matrix, in px of the published image.
struct Projection {
  double fx;
  double fy;
  double cx;
  double cy;
  double tx_m;  ///< position of the camera along the baseline, to the left of the reference
  double ty_m;  ///< the same, downwards
};

/// P refers to the whole sensor without binning, so binning and region of interest are applied
/// here.
Projection toProjection(const CameraCalibration& camera) {
  const auto& p = camera.projection;
  return {p[0] / camera.binning_x,
          p[5] / camera.binning_y,
          (p[2] - camera.roi.x) / camera.binning_x,
          (p[6] - camera.roi.y) / camera.binning_y,
          p[3] / p[0],
          p[7] / p[5]};
}

std::string entryText(const CameraCalibration& camera, std::size_t index) {
  return join("P[", index, "] = ", camera.projection[index]);
}

/// Checks the calibration of one camera.
class CameraChecker {
 public:
  CameraChecker(const CameraCalibration& camera, std::string name, std::string image_name,
                cv::Size image_size, RectifiedBy rectified_by, CalibrationCheck& check)
      : camera_(camera),
        name_(std::move(name)),
        image_name_(std::move(image_name)),
        image_size_(image_size),
        rectified_by_(rectified_by),
        check_(check) {}

  void run() {
    checkSize();
    if (checkProjection()) {
      checkProjectionEntries();
      checkPrincipalPoint();
    }
    checkRotation();
    checkSkippedRectification();
  }

 private:
  void fail(InputFault fault, const std::string& text) {
    check_.errors.push_back({fault, name_ + " " + text});
  }
  void warn(const std::string& text) { check_.warnings.push_back(name_ + " " + text); }

  void checkSize() {
    if (hasUnknownSize(camera_) && rectified_by_ == RectifiedBy::kFiles) {
      return;  // some formats have no size
    }
    if (hasUnknownSize(camera_)) {
      warn(join("has no image size (", camera_.width, " x ", camera_.height,
                "); the size of the image, ", sizeText(image_size_),
                ", is taken. Set width and height of the calibration."));
      return;
    }
    const std::string problem = sizeProblem(camera_, image_size_, image_name_);
    if (!problem.empty()) {
      fail(InputFault::kCameraInfoSize, problem);
    }
  }

  /// Returns whether P is usable in computations.
  bool checkProjection() {
    const auto& p = camera_.projection;
    const auto unusable = std::find_if_not(p.begin(), p.end(), [](double value) {
      return std::abs(value) <= kLargest;  // false for NaN
    });
    if (unusable == p.end() && p[0] >= kSmallest && p[5] >= kSmallest) {
      return true;
    }
    const std::string entries =
        unusable != p.end() ? entryText(camera_, static_cast<std::size_t>(unusable - p.begin()))
                            : entryText(camera_, 0) + ", " + entryText(camera_, 5);
    fail(InputFault::kUncalibrated, "has no usable projection matrix (" + entries +
                                        "). Expected finite entries, P[0] and P[5] above 0. "
                                        "Calibrate the cameras.");
    return false;
  }

  void checkProjectionEntries() {
    const auto& p = camera_.projection;
    for (const std::size_t index : {1U, 4U, 8U, 9U}) {
      if (std::abs(p[index]) > kZeroRatio * p[0]) {
        warn(join("has ", entryText(camera_, index),
                  ", expected 0: P is not that of a rectified camera. Calibrate the rig as a "
                  "stereo camera."));
      }
    }
    if (std::abs(p[10] - 1) > kZeroRatio) {
      warn(join("has ", entryText(camera_, 10), ", expected 1. Correct P."));
    }
    if (std::abs(p[0] / camera_.binning_x - p[5] / camera_.binning_y) >
        kSameRatio * p[0] / camera_.binning_x) {
      warn(join("has P with fx = ", p[0], " and fy = ", p[5],
                " px, expected equal focal lengths as in a rectified pair. Y of points is computed "
                "with fy. Calibrate the rig as a stereo camera."));
    }
  }

  void checkPrincipalPoint() {
    const Projection projection = toProjection(camera_);
    const bool inside = projection.cx >= 0 && projection.cx <= image_size_.width &&
                        projection.cy >= 0 && projection.cy <= image_size_.height;
    if (!inside) {
      warn(join("has P with its principal point at (", projection.cx, ", ", projection.cy,
                "), outside of the image of ", sizeText(image_size_),
                ". P is probably of another resolution: scale it to the image, or calibrate at "
                "this resolution."));
    }
  }

  void checkRotation() {
    const std::string problem = rotationProblem(camera_);
    if (problem.empty()) {
      return;
    }
    if (rectified_by_ == RectifiedBy::kUs) {
      fail(InputFault::kUncalibrated, problem + " Calibrate the cameras, or set R.");
    } else {
      warn(problem + " It is not used, because the images are treated as rectified. Set R.");
    }
  }

  /// image_proc forwards images without distortion unchanged, even if R and P require
  /// rectification.
  void checkSkippedRectification() {
    const bool has_rotation = isRotation(camera_.rectification);
    if (rectified_by_ == RectifiedBy::kOthers && hasNoCoefficients(camera_) && has_rotation &&
        camera_.camera_matrix[0] > 0 && !isIdentity(camera_)) {
      warn(
          "has no distortion (D = 0), but R is not the identity or P differs from K: image_proc "
          "does not rectify such images. If image_proc makes the rectified images, give D a tiny "
          "value (1e-9), so that it rectifies; if the camera rectifies, set R to the identity and "
          "K to the camera matrix of P.");
    }
  }

  const CameraCalibration& camera_;
  const std::string name_;
  const std::string image_name_;
  const cv::Size image_size_;
  const RectifiedBy rectified_by_;
  CalibrationCheck& check_;
};

/// Checks a pair whose cameras are usable individually, and sets the geometry.
class PairChecker {
 public:
  PairChecker(const StereoCameras& cameras, const InputNames& names, CalibrationCheck& check)
      : cameras_(cameras),
        names_(names),
        left_(toProjection(cameras.left)),
        right_(toProjection(cameras.right)),
        check_(check) {}

  void run() {
    setGeometry();
    if (checkBaseline()) {
      checkSameProjection();
      checkAxes();
    }
  }

 private:
  std::string both() const { return names_.left_info + " and " + names_.right_info; }
  void fail(const std::string& text) {
    check_.errors.push_back({InputFault::kUncalibrated, both() + " " + text});
  }
  void warn(const std::string& text) { check_.warnings.push_back(both() + " " + text); }

  void setGeometry() {
    StereoGeometry& geometry = check_.geometry;
    geometry.focal_length_px = right_.fx;
    geometry.baseline_m = left_.tx_m - right_.tx_m;
    geometry.disparity_offset_px = left_.cx - right_.cx;
    geometry.left_fx_px = left_.fx;
    geometry.left_fy_px = left_.fy;
    geometry.left_cx_px = left_.cx;
    geometry.left_cy_px = left_.cy;
  }

  /// Returns whether the baseline is usable. Even if each entry of P has a reasonable size, the
  /// baseline may not.
  bool checkBaseline() {
    const StereoGeometry& geometry = check_.geometry;
    const double baseline_m = geometry.baseline_m;
    const std::string entries =
        join("left ", entryText(cameras_.left, 3), ", right ", entryText(cameras_.right, 3));
    if (!(std::abs(baseline_m) <= kLargest) || !(geometry.focal_length_px <= kLargest) ||
        !(std::abs(geometry.disparity_offset_px) <= kLargest)) {
      fail(join("have projection matrices without reasonable size: they give a focal length of ",
                geometry.focal_length_px, " px and a baseline of ", baseline_m,
                " m. Calibrate the cameras."));
      return false;
    }
    if (std::abs(baseline_m) < kSmallest) {
      fail("have no baseline (" + entries +
           "). Expected right P[3] = -fx * baseline: the cameras were calibrated separately. "
           "Calibrate them as a stereo camera.");
      return false;
    }
    if (baseline_m < 0) {
      fail(join("have a negative baseline of ", baseline_m, " m (", entries,
                "). Expected a right camera to the right of the left one: the cameras are "
                "exchanged. Exchange left and right topics or calibrations."));
      return false;
    }
    if (baseline_m < kShortestBaselineM || baseline_m > kLongestBaselineM) {
      warn(join(
          "have a baseline of ", baseline_m, " m (", entries,
          "), expected 0.005 to 5 m. Two usual causes: lengths in mm or cm, where P[3] needs m; or "
          "P[3] = -baseline, where it has to be -fx * baseline. Depth is wrong by the same "
          "factor."));
    }
    return true;
  }

  void checkSameProjection() {
    if (std::abs(left_.fx - right_.fx) > kSameRatio * left_.fx ||
        std::abs(left_.fy - right_.fy) > kSameRatio * left_.fy) {
      warn(join("differ in focal length (fx ", left_.fx, " and ", right_.fx, " px, fy ", left_.fy,
                " and ", right_.fy, " px); a rectified pair has one. ", kRecalibrate));
    }
    if (std::abs(left_.cy - right_.cy) > kSameRowPx) {
      warn(join("differ in cy (", left_.cy, " and ", right_.cy,
                " px); the rows of a rectified pair agree. ", kRecalibrate));
    }
  }

  void checkAxes() {
    const double baseline_m = check_.geometry.baseline_m;
    const double height_m = left_.ty_m - right_.ty_m;
    if (std::abs(height_m) > kSameOffset * baseline_m) {
      warn(join("differ in height by ", std::abs(height_m), " m (left ",
                entryText(cameras_.left, 7), ", right ", entryText(cameras_.right, 7),
                "); P[7] of a rectified pair is 0. ", kRecalibrate));
    }
    const double depth_m = cameras_.left.projection[11] - cameras_.right.projection[11];
    if (std::abs(depth_m) > kSameOffset * baseline_m) {
      warn(join("differ along the optical axis by ", std::abs(depth_m), " m (left ",
                entryText(cameras_.left, 11), ", right ", entryText(cameras_.right, 11),
                "); P[11] of a rectified pair is 0. ", kRecalibrate));
    }
  }

  static constexpr const char* kRecalibrate =
      "Take both P from one stereo calibration; depth is probably wrong.";

  const StereoCameras& cameras_;
  const InputNames& names_;
  const Projection left_;
  const Projection right_;
  CalibrationCheck& check_;
};

}  // namespace

CalibrationCheck checkCalibration(const StereoCameras& cameras, cv::Size image_size,
                                  const InputNames& names, RectifiedBy rectified_by) {
  CalibrationCheck check;
  CameraChecker(cameras.left, names.left_info, names.left_image, image_size, rectified_by, check)
      .run();
  CameraChecker(cameras.right, names.right_info, names.right_image, image_size, rectified_by, check)
      .run();
  if (check.errors.empty()) {
    PairChecker(cameras, names, check).run();
  }
  return check;
}

const StereoGeometry& requireUsable(const CalibrationCheck& check) {
  if (!check.errors.empty()) {
    throw InputError(check.errors.front().fault, check.errors.front().text);
  }
  return check.geometry;
}

}  // namespace cbmv
