#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <dynamic_reconfigure/server.h>
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>

#include "ros/color_buffer.h"
#include "ros/frame_worker.h"
#include "ros/stereo_inputs.h"
#include "ros/stereo_processor.h"
#include "ros/warning_throttle.h"

#include <cbmv_stereo/StereoConfig.h>

namespace cbmv {

/// Wires topics and parameters to StereoProcessor. README.md and docs/parameters.md list them.
///
/// Inputs are subscribed only while an output has a subscriber, and each output is built only while
/// it has one itself. Callbacks only hand frames over to the worker's thread, which converts,
/// matches and publishes.
class StereoNodelet : public nodelet::Nodelet {
 public:
  StereoNodelet() = default;
  ~StereoNodelet() override;

 private:
  /// Throws Error, after having logged it as fatal, if the nodelet cannot work as configured.
  void onInit() override;
  void initialize();
  void stop();
  StereoOptions readOptions();
  std::shared_ptr<const Forest> loadForest();
  void advertise();
  void reportSilence();

  /// Called when a subscriber of an output comes or goes.
  void updateSubscriptions();
  bool wantsInput() const;
  void updateColorSubscription();

  void reconfigure(cbmv_stereo::StereoConfig& config);
  void receive(const StereoMessages& frame);

  // In the worker's thread
  void work(const StereoMessages& frame);
  void publish(const StereoMessages& frame, const ProcessedFrame& processed);
  cv::Mat colorOf(const StereoMessages& frame, const ProcessedFrame& processed);
  NodeState stateAt(const ros::Time& stamp) const;

  /// At most one warning per cause in a while.
  void warn(int cause, const std::string& sentence);

  std::string forest_name_;
  int threads_ = 0;
  std::unique_ptr<StereoProcessor> processor_;
  std::unique_ptr<StereoInputs> inputs_;
  StereoTopics topics_;
  std::string color_topic_;

  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Subscriber color_subscriber_;
  std::optional<ColorBuffer> colors_;

  std::mutex subscriptions_mutex_;  ///< also held while advertising
  ros::Publisher disparity_publisher_;
  ros::Publisher points_publisher_;
  ros::Publisher status_publisher_;
  image_transport::Publisher confidence_publisher_;
  image_transport::Publisher disparity_color_publisher_;
  ros::WallTimer silence_timer_;

  boost::recursive_mutex config_mutex_;
  StereoOptions options_;
  std::unique_ptr<dynamic_reconfigure::Server<cbmv_stereo::StereoConfig>> config_server_;

  WarningThrottle throttle_{5.0};
  std::atomic<std::uint64_t> processed_{0};
  std::atomic<std::uint64_t> dropped_busy_{0};
  std::atomic<std::uint64_t> dropped_bad_input_{0};
  std::atomic<std::uint64_t> dropped_failed_{0};
  std::unique_ptr<FrameWorker> worker_;  ///< stops first
};

}  // namespace cbmv
