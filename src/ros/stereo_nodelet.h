#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>

#include "base/frame_worker.h"
#include "pipeline/frame_processor.h"
#include "ros/color_buffer.h"
#include "ros/nodelet_inputs.h"
#include "ros/output_publishers.h"
#include "ros/private_parameters.h"
#include "ros/stereo_diagnostics.h"
#include "ros/warning_throttle.h"

#include <cbmv_stereo/StereoConfig.h>

namespace cbmv {

/// Connects topics and parameters to FrameProcessor; docs/ros.md lists them.
///
/// Subscribes to its inputs only while an output has a subscriber, and builds each output only
/// while it has a subscriber. Callbacks only pass frames to the worker thread, which converts,
/// matches and publishes.
class StereoNodelet : public nodelet::Nodelet {
 public:
  StereoNodelet() = default;
  ~StereoNodelet() override;

 private:
  /// Throws Error, and logs it as fatal, if the configuration is invalid.
  void onInit() override;
  void initialize();
  void stop();
  StereoOptions readOptions(const PrivateParameters& parameters);
  std::shared_ptr<const Forest> readForestParameter(const PrivateParameters& parameters);
  void offerConfig(const PrivateParameters& parameters);
  void openDiagnostics(const PrivateParameters& parameters);
  void openTopics(const PrivateParameters& parameters);

  /// Called when a subscriber of an output connects or disconnects.
  void updateSubscriptions();
  void updateColorSubscription();
  void watch();
  void reportInputs();

  void reconfigure(cbmv_stereo::StereoConfig& config);
  void reportParameters(const std::string& message);
  StereoOptions optionsOf(const cbmv_stereo::StereoConfig& config) const;
  void receive(const StereoMessages& frame);

  // Called by the worker thread:
  void work(const StereoMessages& frame);
  void warnOf(const ProcessedFrame& processed);
  /// Logs an automatic disparity range when it changes.
  void reportRange(const ProcessedFrame& processed);
  cv::Mat colorOf(const StereoMessages& frame, const ProcessedFrame& processed);
  /// Warns once per output that needs the standard deviation if the forest does not provide it.
  void warnOfNoSigma(const std::string& topic, const std::string& effect);
  /// How long to wait for the color image after the pair is matched.
  std::chrono::milliseconds colorPatience();
  NodeState stateAt(const ros::Time& stamp) const;

  void drop(FrameDrop drop, int cause, const std::string& message);
  /// Logs at most one warning per cause and period.
  void warn(int cause, const std::string& message);

  std::string forest_name_;
  int threads_ = 0;
  std::unique_ptr<FrameProcessor> processor_;
  // Used by the worker thread only:
  FollowedOffset offset_;
  FollowedRange range_;
  std::optional<DisparityRange> reported_range_;
  std::set<std::string> without_sigma_;  ///< outputs already warned about

  bool allow_different_frame_ids_ = true;
  StereoTopics topics_;
  std::string color_name_;   ///< as configured
  std::string color_topic_;  ///< resolved

  std::mutex subscriptions_mutex_;  ///< protects the members below
  bool stopping_ = false;
  std::unique_ptr<StereoInputs> inputs_;
  std::unique_ptr<image_transport::ImageTransport> color_transport_;
  image_transport::Subscriber color_subscriber_;
  std::unique_ptr<OutputPublishers> outputs_;

  std::optional<ColorBuffer> colors_;
  std::unique_ptr<StereoDiagnostics> diagnostics_;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::SteadyTime last_update_;  ///< time of the last diagnostics update
  ros::WallTimer watch_timer_;   ///< checks inputs and diagnostics

  boost::recursive_mutex config_mutex_;
  StereoOptions options_;
  std::string preset_;  ///< preset of options_, or kNoPreset
  float min_confidence_ = 0;
  std::unique_ptr<dynamic_reconfigure::Server<cbmv_stereo::StereoConfig>> config_server_;

  WarningThrottle throttle_{5.0};
  WarningThrottle rig_throttle_{60.0};
  std::unique_ptr<FrameWorker<StereoMessages>> worker_;  ///< stopped first
};

}  // namespace cbmv
