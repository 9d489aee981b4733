#include "offline/frame_outputs.h"

#include <algorithm>
#include <functional>

#include "offline/message_files.h"
#include "ros/conversions.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr const char* kDisparity = "disparity";
constexpr const char* kCloud = "points2";

/// Data from which the messages of a frame are built.
struct Source {
  const StereoResult& result;
  const StereoGeometry& geometry;
  const std_msgs::Header& header;
  double disparity_step_px;
  std::function<cv::Mat()> color;
};

struct OfflineOutput {
  std::string topic;
  std::string extension;  ///< extension of its files
  std::function<RawMessage(const Source&, const std::string& topic)> make;
  std::function<void(const Source&, const std::string& path)> write;
};

template <typename Make>
OfflineOutput output(const char* topic, const char* extension, Make make) {
  return {topic, extension,
          [make](const Source& source, const std::string& name) {
            return toRawMessage(make(source), name);
          },
          [make](const Source& source, const std::string& path) {
            writeMessageFile(path, make(source));
          }};
}

sensor_msgs::Image depthSigmaOf(const Source& source) {
  if (source.result.disparity_sigma.empty()) {
    throw Error(
        "depth_sigma needs a forest file with a second forest, but the file has none. Use --forest "
        "with a file written by cbmv_train, or remove depth_sigma from --write.");
  }
  return toDepthSigmaImage(source.result, source.geometry, source.header);
}

std::vector<OfflineOutput> offlineOutputs() {
  return {
      output(kDisparity, ".pfm",
             [](const Source& s) {
               return toDisparityImage(s.result, s.geometry, s.disparity_step_px, s.header);
             }),
      output("depth", ".pfm",
             [](const Source& s) { return toDepthImage(s.result, s.geometry, s.header); }),
      output("depth_sigma", ".pfm", depthSigmaOf),
      output("depth_raw", ".png",
             [](const Source& s) { return toRawDepthImage(s.result, s.geometry, s.header); }),
      output("camera_info", ".yaml",
             [](const Source& s) {
               return toRectifiedInfo(s.geometry, s.result.disparity.size(), s.header);
             }),
      output("confidence", ".pfm",
             [](const Source& s) { return toConfidenceImage(s.result, s.header); }),
      output("valid_mask", ".png", [](const Source& s) { return toValidMask(s.result, s.header); }),
      output("disparity_color", ".png",
             [](const Source& s) { return toDisparityColorImage(s.result, s.header); }),
      output(kCloud, ".ply",
             [](const Source& s) {
               const CloudSource source{
                   toValidDisparity(s.result, s.geometry), s.color(), s.result.confidence, {}};
               return toPointCloud(source, s.geometry, {}, s.header);
             }),
  };
}

Source sourceOf(const PreparedFrame& prepared, const ProcessedFrame& processed,
                const std::string& color_topic) {
  return {processed.result, processed.geometry, prepared.loaded.messages.left_image->header,
          processed.disparity_step_px, [&] {
            return toCloudColor(prepared.loaded.color, color_topic, processed.left_gray, nullptr);
          }};
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
        list.append(known).append(", ");
      }
      throw Error("unknown output '" + name + "', expected some of " + list +
                  "cloud (points2). Correct --write");
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
  const Source source = sourceOf(prepared, processed, color_topic_);
  const std::vector<OfflineOutput> outputs = offlineOutputs();
  std::vector<RawMessage> messages;
  for (const std::size_t index : wanted_) {
    messages.push_back(outputs[index].make(source, output_namespace_ + "/" + outputs[index].topic));
  }
  return messages;
}

std::vector<FrameOutputs::FileKind> FrameOutputs::fileKinds(DisparityFormat format) const {
  const std::vector<OfflineOutput> outputs = offlineOutputs();
  std::vector<FileKind> kinds;
  for (const std::size_t index : wanted_) {
    const OfflineOutput& output = outputs[index];
    const bool kitti = output.topic == kDisparity && format == DisparityFormat::kKitti;
    kinds.push_back({output.topic, kitti ? ".png" : output.extension});
  }
  return kinds;
}

void FrameOutputs::write(const PreparedFrame& prepared, const ProcessedFrame& processed,
                         const std::vector<std::string>& paths) const {
  const Source source = sourceOf(prepared, processed, color_topic_);
  const std::vector<OfflineOutput> outputs = offlineOutputs();
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    outputs[wanted_[i]].write(source, paths[i]);
  }
}

}  // namespace cbmv
