#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include "pipeline/frame_processor.h"
#include "ros/conversions.h"

namespace cbmv {

/// Data from which the messages of one frame are built.
struct OutputFrame {
  std_msgs::Header header;
  const ProcessedFrame& processed;
  std::function<cv::Mat()> color;    ///< left image, CV_8UC3, BGR
  std::function<NodeState()> state;  ///< node state at the time of the call
  /// Called for an output that needs the standard deviation when the result has none; `effect`
  /// describes the consequence for this output.
  std::function<void(const std::string& topic, const std::string& effect)> no_sigma;

  const StereoResult& result() const { return processed.result; }
  const StereoGeometry& geometry() const { return processed.geometry; }
};

/// A publisher, independent of the message type.
struct LiveOutput {
  std::string topic;
  std::function<std::uint32_t()> subscribers;
  std::function<void(const OutputFrame&)> publish;
};

/// Where outputs are advertised.
struct OutputContext {
  ros::NodeHandle nh;
  image_transport::ImageTransport& transport;
  std::function<void()> changed;  ///< called when a subscriber connects or disconnects
};

/// One output: a row of the table in docs/ros.md.
struct Output {
  std::string topic;
  std::string type;
  std::string description;
  std::function<LiveOutput(const OutputContext&)> advertise;
};

/// All outputs of cbmv_stereo/stereo.
std::vector<Output> stereoOutputs(const CloudOptions& cloud_options);

/// Publishes each output while it has a subscriber. Images use image_transport.
class OutputPublishers {
 public:
  /// Other threads may call `changed` before the constructor returns.
  OutputPublishers(const ros::NodeHandle& nh, const std::vector<Output>& outputs,
                   std::function<void()> changed);

  bool anyIsWanted() const;
  bool isWanted(const std::string& topic) const;
  void publish(const OutputFrame& frame) const;

 private:
  image_transport::ImageTransport transport_;
  std::vector<LiveOutput> outputs_;
};

}  // namespace cbmv
