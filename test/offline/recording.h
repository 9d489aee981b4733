#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "offline/bag_processing.h"
#include "ros/stereo_pair.h"
#include "support/forest_fixture.h"
#include "support/temporary_folder.h"

namespace cbmv {

/// The messages of frame `index` of a bag. Each frame shows another scene.
inline PairMessages recordedFrame(int index, cv::Size size = {96, 64}) {
  return makeMessages(renderPair(size, 3, 8, static_cast<std::uint64_t>(index) + 1), Rig{},
                      ros::Time(100 + 0.1 * index));
}

inline void writeFrame(rosbag::Bag& bag, const PairMessages& messages) {
  const ros::Time time = messages.left_image->header.stamp + ros::Duration(0.02);
  bag.write("/stereo/left/image_rect", time, messages.left_image);
  bag.write("/stereo/left/camera_info", time, messages.left_info);
  bag.write("/stereo/right/image_rect", time, messages.right_image);
  bag.write("/stereo/right/camera_info", time, messages.right_info);
}

/// Writes a bag; `fill` may add messages.
inline std::string writeRecording(
    const std::string& path, int frames, const std::function<void(rosbag::Bag&)>& fill = nullptr,
    rosbag::CompressionType compression = rosbag::compression::Uncompressed,
    cv::Size size = {96, 64}) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(20000);  // several chunks even in small bags
  for (int frame = 0; frame < frames; ++frame) {
    writeFrame(bag, recordedFrame(frame, size));
  }
  if (fill) {
    fill(bag);
  }
  bag.close();
  return path;
}

/// A bag with four frames; the images of the third have different sizes.
inline std::string writeRecordingWithABadFrame(const std::string& path) {
  PairMessages bad = recordedFrame(2, {80, 64});
  bad.right_image = recordedFrame(2).right_image;
  return writeRecording(path, 2, [&](rosbag::Bag& bag) {
    writeFrame(bag, bad);
    writeFrame(bag, recordedFrame(3));
  });
}

inline std::shared_ptr<const Forest> fixtureForest() {
  return std::make_shared<const Forest>(makeForestFixture());
}

/// Outputs available with the fixture forest. It has no second forest, which depth_sigma needs.
inline std::vector<std::string> fixtureOutputs() {
  std::vector<std::string> names = offlineOutputNames();
  names.erase(std::remove(names.begin(), names.end(), "depth_sigma"), names.end());
  return names;
}

inline BagProcessingOptions processingOf(const std::string& input, const std::string& output) {
  BagProcessingOptions options;
  options.inputs = {input};
  options.output = output;
  options.frames_per_part = 3;
  options.matching.stereo.range = {0, 16};
  options.matching.stereo.threads = 2;
  return options;
}

/// Topic, time and bytes of every message, read by rosbag.
using Content = std::vector<std::tuple<std::string, double, std::string>>;

inline Content messagesOf(const std::string& path) {
  rosbag::Bag bag(path, rosbag::bagmode::Read);
  Content content;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    std::string bytes(message.size(), '\0');
    ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()),
                                       message.size());
    message.write(stream);
    content.emplace_back(message.getTopic(), message.getTime().toSec(), bytes);
  }
  return content;
}

template <typename Message>
std::string bytesOf(const Message& message) {
  const RawMessage raw = toRawMessage(message, "");
  return std::string(raw.data, raw.data + raw.size);
}

/// The messages on a topic.
template <typename Message>
std::vector<boost::shared_ptr<Message>> readTopic(const std::string& path,
                                                  const std::string& topic) {
  rosbag::Bag bag(path, rosbag::bagmode::Read);
  std::vector<boost::shared_ptr<Message>> messages;
  for (const rosbag::MessageInstance& message : rosbag::View(bag, rosbag::TopicQuery(topic))) {
    messages.push_back(message.instantiate<Message>());
  }
  return messages;
}

}  // namespace cbmv
