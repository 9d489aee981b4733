#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/time.h>

#include "pipeline/frame_processor.h"
#include "ros/conversions.h"

namespace cbmv {

/// Limits above which diagnostics and log warn.
struct DiagnosticsLimits {
  double silence_s = 3;           ///< time without a pair while an output has a subscriber
  double age_s = 1;               ///< time from stamp to publishing; 0: no limit
  double vertical_offset_px = 1;  ///< RMS over the image; 0: no limit
};

/// A warning if the measured vertical offset exceeds `limit_px` (0: no limit), with the offset and
/// the residual vertical offset after the rectification correction; else empty.
std::string verticalOffsetWarning(const ProcessedFrame& frame, double limit_px);

/// Reasons for dropping a frame.
enum class FrameDrop { kBusy, kBadInput, kFailed };

/// Values of the last kSpanS seconds.
class RecentValues {
 public:
  static constexpr double kSpanS = 10;

  void add(ros::SteadyTime now, double value = 0);
  void clear() { values_.clear(); }
  std::size_t count(ros::SteadyTime now) const;
  double rateHz(ros::SteadyTime now) const;
  double mean(ros::SteadyTime now) const;     ///< 0 if there is none
  double largest(ros::SteadyTime now) const;  ///< 0 if there is none

 private:
  using Entry = std::pair<ros::SteadyTime, double>;
  std::deque<Entry>::const_iterator firstOf(ros::SteadyTime now) const;

  std::deque<Entry> values_;
};

/// Counts frames by outcome and reports the state of the node as diagnostic_msgs; see the table in
/// docs/ros.md. Thread-safe. Needs no ROS master.
class StereoDiagnostics {
 public:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  StereoDiagnostics(const DiagnosticsLimits& limits, std::string forest, int threads);

  /// Whether inputs are subscribed. Without subscription, silence is not an error.
  void setWanted(bool wanted, ros::SteadyTime now);
  void received(ros::SteadyTime now);
  /// Reports why no pairs arrive, see SyncMonitor.
  void silent(const std::string& report);
  /// Reports wrong stamps, see SyncMonitor.
  void stampsAreWrong(const std::string& report, ros::SteadyTime now);
  /// Reports why parameters differ from the requested values.
  void parametersDiffer(const std::string& report);
  void dropped(FrameDrop cause, const std::string& message, ros::SteadyTime now);
  void processed(const ProcessedFrame& frame, ros::SteadyTime now);
  void published(double age_ms, ros::SteadyTime now);

  FrameCounts counts() const;
  const DiagnosticsLimits& limits() const { return limits_; }

  void describeInput(Status& status, ros::SteadyTime now) const;
  void describeOutput(Status& status, ros::SteadyTime now) const;
  void describeCalibration(Status& status, ros::SteadyTime now) const;
  void describeMethod(Status& status, ros::SteadyTime now) const;
  void describeRectification(Status& status, ros::SteadyTime now) const;

  /// Adds all of the above tasks. The updater must not outlive this object.
  void addTo(diagnostic_updater::Updater& updater) const;

 private:
  /// Data of the newest processed frame.
  struct Newest {
    cv::Size size;
    StereoGeometry geometry;
    StageTimes times;
    DisparityRange range;
    bool range_is_automatic = false;
    double memory_mb = 0;
    RectificationState rectification;
    bool is_corrected = false;
    std::string vertical_offset_warning;
    std::vector<std::string> warnings;  ///< about input and calibration
  };
  struct Fault {
    std::string message;
    ros::SteadyTime time;
    bool is_rejection = false;  ///< the newest frame was rejected for its messages
  };

  double silenceS(ros::SteadyTime now) const;
  void summarizeOutput(Status& status, ros::SteadyTime now) const;
  void summarizeRectification(Status& status) const;

  const DiagnosticsLimits limits_;
  const std::string forest_;
  const int threads_;

  mutable std::mutex mutex_;  ///< protects the members below
  bool wanted_ = false;
  ros::SteadyTime waiting_since_;  ///< start of the wait for the next pair
  std::string silence_report_;
  std::string stamp_report_;
  std::string parameter_report_;
  RecentValues wrong_stamps_;
  FrameCounts counts_;
  RecentValues pairs_;
  RecentValues results_;  ///< processing times, ms
  RecentValues ages_;     ///< ms
  RecentValues busy_;
  RecentValues faults_;  ///< bad input and failures
  std::optional<Newest> newest_;
  std::optional<Fault> fault_;
};

}  // namespace cbmv
