#include "ros/output_publishers.h"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include <boost/make_shared.hpp>

namespace cbmv {
namespace {

constexpr std::uint32_t kQueueSize = 1;  // a slow subscriber gets the newest message

/// Publisher for a message type; image_transport for images.
template <typename Message>
auto advertise(const OutputContext& context, const std::string& topic) {
  const auto changed = [call = context.changed](const auto&) { call(); };
  if constexpr (std::is_same_v<Message, sensor_msgs::Image>) {
    const image_transport::SubscriberStatusCallback callback = changed;
    return context.transport.advertise(topic, kQueueSize, callback, callback);
  } else {
    const ros::SubscriberStatusCallback callback = changed;
    return ros::NodeHandle(context.nh).advertise<Message>(topic, kQueueSize, callback, callback);
  }
}

template <typename Made>
struct MadeMessage {
  using Type = Made;
};
template <typename Message>
struct MadeMessage<std::optional<Message>> {
  using Type = Message;
};

/// Lets `output` handle messages that always exist like those that may be missing.
template <typename Message>
std::optional<Message> asOptional(Message message) {
  return message;
}
template <typename Message>
std::optional<Message> asOptional(std::optional<Message> message) {
  return message;
}

/// An output whose messages are make(frame), which may be an empty std::optional.
template <typename Make>
Output output(const char* topic, const char* description, Make make) {
  using Message = typename MadeMessage<std::invoke_result_t<Make, const OutputFrame&>>::Type;
  const auto advertise_it = [topic, make](const OutputContext& context) {
    const auto publisher = advertise<Message>(context, topic);
    return LiveOutput{
        topic, [publisher] { return publisher.getNumSubscribers(); },
        [publisher, make](const OutputFrame& frame) {
          if (auto message = asOptional(make(frame))) {
            publisher.publish(
                boost::shared_ptr<const Message>(  // shared with the nodelets of this process
                    boost::make_shared<Message>(std::move(*message))));
          }
        }};
  };
  return {topic, ros::message_traits::datatype<Message>(), description, advertise_it};
}

std::optional<sensor_msgs::Image> depthSigmaOf(const OutputFrame& frame) {
  if (frame.result().disparity_sigma.empty()) {
    frame.no_sigma("depth_sigma", "nothing is published");
    return std::nullopt;
  }
  return toDepthSigmaImage(frame.result(), frame.geometry(), frame.header);
}

sensor_msgs::PointCloud2 cloudOf(const OutputFrame& frame, const CloudOptions& options) {
  CloudSource source{toValidDisparity(frame.result(), frame.geometry()),
                     frame.color(),
                     frame.result().confidence,
                     {}};
  if (options.with_sigma) {
    source.depth_sigma = toDepthSigma(frame.result(), frame.geometry());
    if (source.depth_sigma.empty()) {
      frame.no_sigma("points2", "the field sigma is NaN");
    }
  }
  return toPointCloud(source, frame.geometry(), options, frame.header);
}

}  // namespace

std::vector<Output> stereoOutputs(const CloudOptions& cloud_options) {
  using Frame = OutputFrame;
  return {
      output("disparity", "Disparities in pixels, Z = f T / d; see the conventions below",
             [](const Frame& f) {
               const double step_px = f.processed.disparity_step_px;
               return toDisparityImage(f.result(), f.geometry(), step_px, f.header);
             }),
      output("depth", "32FC1, Z in meters (REP 118); NaN where there is none",
             [](const Frame& f) { return toDepthImage(f.result(), f.geometry(), f.header); }),
      output(
          "depth_sigma",
          "32FC1, standard deviation of `depth` in meters, if the disparity is right within 1 px "
          "(preset kitti: 3 px); NaN where there is no depth. Needs a forest file with a second "
          "forest",
          depthSigmaOf),
      output("depth_raw", "16UC1, Z in millimeters; 0 where there is none or more than 65 535",
             [](const Frame& f) { return toRawDepthImage(f.result(), f.geometry(), f.header); }),
      output("camera_info",
             "Calibration of `depth`, `depth_sigma` and `depth_raw` (rectified left camera)",
             [](const Frame& f) {
               return toRectifiedInfo(f.geometry(), f.result().disparity.size(), f.header);
             }),
      output(
          "confidence",
          "32FC1 in [0, 1]: probability that the disparity is within 1 px of the truth, or within "
          "the limit that the confidence was recalibrated for, 3 px with the preset kitti "
          "([confidence.md](confidence.md)); 0 where there is none",
          [](const Frame& f) { return toConfidenceImage(f.result(), f.header); }),
      output("valid_mask", "mono8: 255 where there is a disparity, 0 where there is none",
             [](const Frame& f) { return toValidMask(f.result(), f.header); }),
      output("disparity_color",
             "rgb8 for viewers: blue is the lowest disparity of the range, red the highest, black "
             "none",
             [](const Frame& f) { return toDisparityColorImage(f.result(), f.header); }),
      // After the images, because it may wait for the color image.
      output("points2", "Organized cloud in meters, with color; NaN where there is no point",
             [cloud_options](const Frame& f) { return cloudOf(f, cloud_options); }),
      output("status",
             "Time of each stage and age of the frame in milliseconds, frames processed and "
             "dropped, vertical offset in pixels",
             [](const Frame& f) { return toStatus(f.result(), f.state(), f.header); }),
      output("rectification",
             "Measured residual vertical offset in pixels, with standard errors, before and after "
             "the rectification correction",
             [](const Frame& f) {
               return toRectification(f.processed.rectification, f.result(), f.header);
             }),
  };
}

OutputPublishers::OutputPublishers(const ros::NodeHandle& nh, const std::vector<Output>& outputs,
                                   std::function<void()> changed)
    : transport_(nh) {
  const OutputContext context{nh, transport_, std::move(changed)};
  for (const Output& output : outputs) {
    outputs_.push_back(output.advertise(context));
  }
}

bool OutputPublishers::anyIsWanted() const {
  return std::any_of(outputs_.begin(), outputs_.end(),
                     [](const LiveOutput& output) { return output.subscribers() > 0; });
}

bool OutputPublishers::isWanted(const std::string& topic) const {
  return std::any_of(outputs_.begin(), outputs_.end(), [&](const LiveOutput& output) {
    return output.topic == topic && output.subscribers() > 0;
  });
}

void OutputPublishers::publish(const OutputFrame& frame) const {
  for (const LiveOutput& output : outputs_) {
    if (output.subscribers() > 0) {
      output.publish(frame);
    }
  }
}

}  // namespace cbmv
