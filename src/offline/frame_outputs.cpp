#include "offline/frame_outputs.h"

#include <algorithm>
#include <functional>

#include "ros/conversions.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr const char* kCloud = "points2";

/// What the messages of a frame are made from.
struct Source {
  const StereoResult& result;
  const StereoGeometry& geometry;
  const std_msgs::Header& header;
  double disparity_step_px;
  std::function<cv::Mat()> color;
};

struct OfflineOutput {
  std::string topic;
  std::function<RawMessage(const Source&, const std::string& topic)> make;
};

template <typename Make>
OfflineOutput output(const char* topic, Make make) {
  return {topic, [make](const Source& source, const std::string& name) {
            return toRawMessage(make(source), name);
          }};
}

std::vector<OfflineOutput> offlineOutputs() {
  return {
      output("disparity",
             [](const Source& s) {
               return toDisparityImage(s.result, s.geometry, s.disparity_step_px, s.header);
             }),
      output("depth", [](const Source& s) { return toDepthImage(s.result, s.geometry, s.header); }),
      output("depth_raw",
             [](const Source& s) { return toRawDepthImage(s.result, s.geometry, s.header); }),
      output("camera_info",
             [](const Source& s) {
               return toRectifiedInfo(s.geometry, s.result.disparity.size(), s.header);
             }),
      output("confidence", [](const Source& s) { return toConfidenceImage(s.result, s.header); }),
      output("valid_mask", [](const Source& s) { return toValidMask(s.result, s.header); }),
      output("disparity_color",
             [](const Source& s) { return toDisparityColorImage(s.result, s.header); }),
      output(kCloud,
             [](const Source& s) {
               const CloudSource source{toValidDisparity(s.result, s.geometry), s.color(),
                                        s.result.confidence};
               return toPointCloud(source, s.geometry, {}, s.header);
             }),
  };
}

}  // namespace

std::vector<std::string> offlineOutputNames() {
  std::vector<std::string> names;
  for (const OfflineOutput& output : offlineOutputs()) {
    names.push_back(output.topic);
  }
  return names;
}

FrameOutputs::FrameOutputs(const std::vector<std::string>& wanted, const CameraTopics& topics)
    : output_namespace_(topics.output_namespace), color_topic_(topics.color.name) {
  const std::vector<std::string> names = offlineOutputNames();
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name == "cloud" ? kCloud : name);
    if (found == names.end()) {
      std::string list;
      for (const std::string& known : names) {
        list += known + ", ";
      }
      throw Error("there is no output '" + name + "'; there are " + list + "cloud (points2)");
    }
    wanted_.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  std::sort(wanted_.begin(), wanted_.end());
  wanted_.erase(std::unique(wanted_.begin(), wanted_.end()), wanted_.end());
}

std::vector<std::string> FrameOutputs::topics() const {
  const std::vector<std::string> names = offlineOutputNames();
  std::vector<std::string> topics;
  for (const std::size_t index : wanted_) {
    topics.push_back(output_namespace_ + "/" + names[index]);
  }
  return topics;
}

bool FrameOutputs::needsColor() const {
  const std::vector<std::string> names = offlineOutputNames();
  return std::any_of(wanted_.begin(), wanted_.end(),
                     [&](std::size_t index) { return names[index] == kCloud; });
}

std::vector<RawMessage> FrameOutputs::make(const PreparedFrame& prepared,
                                           const ProcessedFrame& processed) const {
  const std_msgs::Header& header = prepared.loaded.messages.left_image->header;
  const Source source{processed.result, processed.geometry, header, processed.disparity_step_px,
                      [&] { return colorOf(prepared, color_topic_); }};
  const std::vector<OfflineOutput> outputs = offlineOutputs();
  std::vector<RawMessage> messages;
  for (const std::size_t index : wanted_) {
    messages.push_back(outputs[index].make(source, output_namespace_ + "/" + outputs[index].topic));
  }
  return messages;
}

}  // namespace cbmv
