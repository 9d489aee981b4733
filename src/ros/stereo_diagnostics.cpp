#include "ros/stereo_diagnostics.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "input/camera_properties.h"
#include "ros/image_conversion.h"

namespace cbmv {
namespace {

using diagnostic_msgs::DiagnosticStatus;

std::string number(double value, int digits) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), "%.*f", digits, value);
  return buffer;
}

std::string orNone(const std::string& report) { return report.empty() ? "none" : report; }

constexpr const char* kIdle = "idle: no output has a subscriber";

}  // namespace

std::string verticalOffsetWarning(const ProcessedFrame& frame, double limit_px) {
  const VerticalOffsetMeasurement& measurement = frame.rectification.measurement;
  const VerticalOffset& model = measurement.model;
  const double rms_px = model.rootMeanSquare(frame.left_gray.size());
  if (model.matches == 0 || limit_px == 0 || rms_px <= limit_px) {
    return {};
  }
  return "the residual vertical offset is " + number(rms_px, 2) + " px (RMS; at the center " +
         number(model.offset_px, 2) + " +- " + number(model.offset_sigma_px, 2) +
         " px), more than warn_vertical_offset_px = " + number(limit_px, 2) +
         ". The rectification correction reduces it from " + number(measurement.rms_before_px, 2) +
         " to " + number(measurement.rms_after_px, 2) + " px. Calibrate the cameras again";
}

void RecentValues::add(ros::SteadyTime now, double value) {
  values_.emplace_back(now, value);
  values_.erase(values_.cbegin(), firstOf(now));
}

std::deque<RecentValues::Entry>::const_iterator RecentValues::firstOf(ros::SteadyTime now) const {
  return std::find_if(values_.begin(), values_.end(),
                      [now](const Entry& entry) { return (now - entry.first).toSec() <= kSpanS; });
}

std::size_t RecentValues::count(ros::SteadyTime now) const {
  return static_cast<std::size_t>(values_.end() - firstOf(now));
}

double RecentValues::rateHz(ros::SteadyTime now) const {
  const auto first = firstOf(now);
  const auto intervals = static_cast<double>(values_.end() - first) - 1;
  return intervals > 0 ? intervals / (now - first->first).toSec() : 0;
}

double RecentValues::mean(ros::SteadyTime now) const {
  const auto first = firstOf(now);
  const double sum =
      std::accumulate(first, values_.end(), 0.0,
                      [](double total, const Entry& entry) { return total + entry.second; });
  return sum / std::max<double>(1.0, static_cast<double>(values_.end() - first));
}

double RecentValues::largest(ros::SteadyTime now) const {
  const auto found =
      std::max_element(firstOf(now), values_.end(),
                       [](const Entry& a, const Entry& b) { return a.second < b.second; });
  return found == values_.end() ? 0 : found->second;
}

StereoDiagnostics::StereoDiagnostics(const DiagnosticsLimits& limits, std::string forest,
                                     int threads)
    : limits_(limits), forest_(std::move(forest)), threads_(threads) {}

void StereoDiagnostics::setWanted(bool wanted, ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (wanted != wanted_) {
    wanted_ = wanted;
    waiting_since_ = now;
    silence_report_.clear();
    for (RecentValues* values : {&pairs_, &results_, &ages_, &busy_, &faults_, &wrong_stamps_}) {
      values->clear();
    }
  }
}

void StereoDiagnostics::received(ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pairs_.add(now);
  waiting_since_ = now;
  silence_report_.clear();
}

void StereoDiagnostics::silent(const std::string& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  silence_report_ = report;
}

void StereoDiagnostics::stampsAreWrong(const std::string& report, ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  stamp_report_ = report;
  wrong_stamps_.add(now);
}

void StereoDiagnostics::parametersDiffer(const std::string& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  parameter_report_ = report;
}

void StereoDiagnostics::dropped(FrameDrop cause, const std::string& message, ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (cause == FrameDrop::kBusy) {
    ++counts_.dropped_busy;
    busy_.add(now);
    return;
  }
  ++(cause == FrameDrop::kBadInput ? counts_.dropped_bad_input : counts_.dropped_failed);
  faults_.add(now);
  fault_ = Fault{message, now, cause == FrameDrop::kBadInput};
}

void StereoDiagnostics::processed(const ProcessedFrame& frame, ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.processed;
  results_.add(now, frame.result.times.total_ms);
  newest_ = Newest{frame.left_gray.size(),
                   frame.geometry,
                   frame.result.times,
                   frame.result.range,
                   frame.range_is_automatic,
                   frame.result.memory_mb,
                   frame.rectification,
                   !frame.result.rectification.isZero(),
                   verticalOffsetWarning(frame, limits_.vertical_offset_px),
                   frame.warnings};
  if (fault_) {
    fault_->is_rejection = false;
  }
}

void StereoDiagnostics::published(double age_ms, ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ages_.add(now, age_ms);
}

FrameCounts StereoDiagnostics::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_;
}

double StereoDiagnostics::silenceS(ros::SteadyTime now) const {
  return (now - waiting_since_).toSec();
}

void StereoDiagnostics::describeInput(Status& status, ros::SteadyTime now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string rate = number(pairs_.rateHz(now), 1);
  if (!wanted_) {
    status.summary(DiagnosticStatus::OK, kIdle);
  } else if (silenceS(now) > limits_.silence_s) {
    status.summary(DiagnosticStatus::ERROR,
                   "no pair of images for " + number(silenceS(now), 0) + " s");
  } else if (wrong_stamps_.count(now) > 0) {
    status.summary(DiagnosticStatus::WARN, stamp_report_);
  } else {
    status.summary(DiagnosticStatus::OK, "pairs of images at " + rate + " Hz");
  }
  status.add("pairs (Hz)", rate);
  status.add("last wrong stamps", orNone(stamp_report_));
  status.add("report", silence_report_);
}

void StereoDiagnostics::summarizeOutput(Status& status, ros::SteadyTime now) const {
  const std::size_t faults = faults_.count(now);
  const double age_s = ages_.mean(now) / 1000;
  if (!wanted_) {
    status.summary(DiagnosticStatus::OK, kIdle);
  } else if (faults > 0 && results_.count(now) == 0) {
    status.summary(DiagnosticStatus::ERROR, "all frames are dropped: " + fault_->message);
  } else if (faults > 0) {
    status.summary(DiagnosticStatus::WARN, std::to_string(faults) + " frames dropped in the last " +
                                               number(RecentValues::kSpanS, 0) +
                                               " s: " + fault_->message);
  } else if (limits_.age_s > 0 && age_s > limits_.age_s) {
    status.summary(DiagnosticStatus::WARN,
                   "results are " + number(age_s, 2) +
                       " s old, more than warn_age_s = " + number(limits_.age_s, 2));
  } else if (age_s < 0) {
    status.summary(DiagnosticStatus::WARN,
                   "stamps are in the future: the clocks of the machines differ. Synchronize them "
                   "(chrony, PTP)");
  } else {
    status.summary(DiagnosticStatus::OK, "results at " + number(results_.rateHz(now), 1) + " Hz");
  }
}

void StereoDiagnostics::describeOutput(Status& status, ros::SteadyTime now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  summarizeOutput(status, now);
  status.add("results (Hz)", number(results_.rateHz(now), 1));
  status.add("age from stamp to publishing, mean (ms)", number(ages_.mean(now), 1));
  status.add("age from stamp to publishing, largest (ms)", number(ages_.largest(now), 1));
  status.add("dropped while busy (Hz)", number(busy_.rateHz(now), 1));
  status.add("frames processed", counts_.processed);
  status.add("frames dropped while busy", counts_.dropped_busy);
  status.add("frames dropped for bad input", counts_.dropped_bad_input);
  status.add("frames dropped after an error", counts_.dropped_failed);
}

void StereoDiagnostics::describeCalibration(Status& status, ros::SteadyTime now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (fault_ && fault_->is_rejection) {
    status.summary(DiagnosticStatus::ERROR, fault_->message);
  } else if (!newest_) {
    status.summary(DiagnosticStatus::OK, "no pair of images yet");
  } else if (!newest_->warnings.empty()) {
    status.summary(DiagnosticStatus::WARN, newest_->warnings.front());
  } else {
    status.summary(DiagnosticStatus::OK,
                   "focal length " + number(newest_->geometry.focal_length_px, 1) +
                       " px, baseline " + number(newest_->geometry.baseline_m, 4) + " m");
  }
  if (newest_) {
    status.add("image size", sizeText(newest_->size));
    status.add("focal length (px)", number(newest_->geometry.focal_length_px, 2));
    status.add("baseline (m)", number(newest_->geometry.baseline_m, 5));
    status.add("disparity at infinity (px)", number(newest_->geometry.disparity_offset_px, 2));
    for (std::size_t i = 0; i < newest_->warnings.size(); ++i) {
      status.add("warning " + std::to_string(i + 1), newest_->warnings[i]);
    }
  }
  status.add("last fault", fault_ ? fault_->message : std::string("none"));
  if (fault_) {
    status.add("time since the last fault (s)", number((now - fault_->time).toSec(), 0));
  }
}

void StereoDiagnostics::describeMethod(Status& status, ros::SteadyTime now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  status.summary(DiagnosticStatus::OK, number(results_.mean(now), 1) + " ms per frame");
  status.add("forest", forest_);
  status.add("threads", threads_);
  status.add("rejected parameters", orNone(parameter_report_));
  status.add("total, mean (ms)", number(results_.mean(now), 1));
  status.add("total, largest (ms)", number(results_.largest(now), 1));
  if (newest_) {
    status.add("disparities", describeRange(newest_->range) +
                                  (newest_->range_is_automatic ? ", found in the images" : ""));
    const StageTimes& times = newest_->times;
    status.add("rectification (ms)", number(times.rectification_ms, 1));
    status.add("volume (ms)", number(times.volume_ms, 1));
    status.add("aggregation (ms)", number(times.aggregation_ms, 1));
    status.add("sgm (ms)", number(times.sgm_ms, 1));
    status.add("refinement (ms)", number(times.refinement_ms, 1));
    status.add("selection (ms)", number(times.selection_ms, 1));
    status.add("memory (MB)", number(newest_->memory_mb, 0));
  }
}

void StereoDiagnostics::summarizeRectification(Status& status) const {
  if (!newest_) {
    status.summary(DiagnosticStatus::OK, "no pair of images yet");
  } else if (!newest_->rectification.is_watched) {
    status.summary(DiagnosticStatus::OK, "not measured: refine_rectification is false");
  } else if (newest_->rectification.measurement.model.matches == 0) {
    status.summary(DiagnosticStatus::OK,
                   "not measured: not enough matches within rectification_max_offset");
  } else if (!newest_->vertical_offset_warning.empty()) {
    status.summary(DiagnosticStatus::WARN, newest_->vertical_offset_warning);
  } else {
    status.summary(DiagnosticStatus::OK, newest_->is_corrected
                                             ? "a small residual vertical offset is corrected"
                                             : "the rows are aligned");
  }
}

void StereoDiagnostics::describeRectification(Status& status, ros::SteadyTime) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  summarizeRectification(status);
  if (!newest_ || newest_->rectification.measurement.model.matches == 0) {
    return;
  }
  const VerticalOffsetMeasurement& measurement = newest_->rectification.measurement;
  const VerticalOffset& model = measurement.model;
  status.add("offset at the center (px)", number(model.offset_px, 3));
  status.add("its standard error (px)", number(model.offset_sigma_px, 3));
  status.add("slope along x (px per px)", number(model.slope_x, 6));
  status.add("slope along y (px per px)", number(model.slope_y, 6));
  status.add("twist (px per px and px)", number(model.twist, 9));
  status.add("curvature along x (px per px and px)", number(model.curvature_x, 9));
  status.add("curvature along y (px per px and px)", number(model.curvature_y, 9));
  status.add("rms before correction (px)", number(measurement.rms_before_px, 3));
  status.add("rms after correction (px)", number(measurement.rms_after_px, 3));
  status.add("matches", model.matches);
  status.add("age of the measurement (s)", number(newest_->rectification.age_s, 1));
  status.add("corrected", newest_->is_corrected);
}

void StereoDiagnostics::addTo(diagnostic_updater::Updater& updater) const {
  const auto add = [&](const char* name,
                       void (StereoDiagnostics::*describe)(Status&, ros::SteadyTime) const) {
    updater.add(name, [this, describe](Status& status) {
      (this->*describe)(status, ros::SteadyTime::now());
    });
  };
  add("Input", &StereoDiagnostics::describeInput);
  add("Output", &StereoDiagnostics::describeOutput);
  add("Calibration", &StereoDiagnostics::describeCalibration);
  add("Method", &StereoDiagnostics::describeMethod);
  add("Rectification", &StereoDiagnostics::describeRectification);
}

}  // namespace cbmv
