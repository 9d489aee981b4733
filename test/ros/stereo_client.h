#pragma once

#include <stdexcept>
#include <string>

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include "ros/cameras.h"
#include "ros/collector.h"
#include "ros/log_reader.h"
#include "ros/parameter_server.h"
#include "ros/wait_for.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {

/// Counterpart of the node: cameras, subscriber, log reader and operator.
class StereoClient {
 public:
  ~StereoClient() {
    unsubscribeAll();
    waitFor([this] { return !cameras.pairIsWanted(); });
  }

  void subscribeAll() {
    withEach([this](auto& output, const char* topic) { output.subscribe(nh_, topic); });
  }

  void unsubscribeAll() {
    withEach([](auto& output, const char*) { output.unsubscribe(); });
  }

  /// Calls use(collector, topic) for each output.
  template <typename Use>
  void withEach(const Use& use) {
    use(disparity, "disparity");
    use(points, "points2");
    use(depth, "depth");
    use(depth_raw, "depth_raw");
    use(camera_info, "camera_info");
    use(confidence, "confidence");
    use(valid_mask, "valid_mask");
    use(disparity_color, "disparity_color");
    use(status, "status");
    use(rectification, "rectification");
  }

  bool allConnected() {
    bool all = true;
    withEach([&](auto& output, const char*) { all = all && output.isConnected(); });
    return all;
  }
  bool allHave(ros::Time stamp) {
    bool all = true;
    withEach([&](auto& output, const char*) { all = all && output.has(stamp); });
    return all;
  }

  /// Sets all run-time parameters; returns the resulting options of the method.
  StereoOptions setOptions(const StereoOptions& options, double min_confidence = 0) {
    auto config = cbmv_stereo::StereoConfig::__getDefault__();
    writeConfig(options, config);
    config.min_confidence = min_confidence;
    dynamic_reconfigure::Reconfigure call;
    config.__toMessage__(call.request.config);
    if (!ros::service::waitForService(nh_.resolveName("cbmv_stereo/set_parameters"), 10000) ||
        !ros::service::call(nh_.resolveName("cbmv_stereo/set_parameters"), call)) {
      throw std::runtime_error("the parameters could not be set");
    }
    config.__fromMessage__(call.response.config);
    StereoOptions set = options;
    applyConfig(config, set);
    return set;
  }

  Cameras cameras;
  Collector<stereo_msgs::DisparityImage> disparity;
  Collector<sensor_msgs::PointCloud2> points;
  Collector<sensor_msgs::Image> depth;
  Collector<sensor_msgs::Image> depth_raw;
  Collector<sensor_msgs::CameraInfo> camera_info;
  Collector<sensor_msgs::Image> confidence;
  Collector<sensor_msgs::Image> valid_mask;
  Collector<sensor_msgs::Image> disparity_color;
  Collector<cbmv_stereo::Status> status;
  Collector<cbmv_stereo::Rectification> rectification;
  LogReader log;

 private:
  ros::NodeHandle nh_;
};

}  // namespace cbmv
