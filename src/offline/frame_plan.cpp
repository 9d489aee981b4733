#include "offline/frame_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "offline/pairing.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kLongestDurationS = 2e9;  // ros::Duration holds a little more

using Messages = std::vector<BagMessage>;

std::vector<ros::Time> stampsOf(const Messages& messages) {
  std::vector<ros::Time> stamps;
  stamps.reserve(messages.size());
  for (const BagMessage& message : messages) {
    stamps.push_back(message.entry->stamp);
  }
  return stamps;
}

/// Messages of a topic sorted by stamp.
class StampedTopic {
 public:
  explicit StampedTopic(Messages messages) : messages_(std::move(messages)) {
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const auto& a, const auto& b) { return a.entry->stamp < b.entry->stamp; });
    stamps_ = stampsOf(messages_);
  }
  bool empty() const { return messages_.empty(); }
  const BagMessage& nearest(const ros::Time& stamp) const {
    return messages_[nearestStamp(stamps_, stamp)];
  }

 private:
  Messages messages_;
  std::vector<ros::Time> stamps_;
};

StampedTopic readInfos(const BagSet& bags, const std::string& topic) {
  StampedTopic infos(bags.onTopic(topic));
  if (infos.empty()) {
    throw Error(bags.names() + ": no message on " + topic + ", so the calibration is unknown");
  }
  return infos;
}

Messages inPart(const Messages& messages, const FramePlan& plan) {
  Messages part;
  std::copy_if(messages.begin(), messages.end(), std::back_inserter(part), [&](const auto& m) {
    return m.entry->time >= plan.begin && m.entry->time <= plan.end;
  });
  return part;
}

/// `time` and so many seconds, at most the last moment that ROS knows.
ros::Time later(const ros::Time& time, double seconds) {
  const double left_s = ros::TIME_MAX.toSec() - time.toSec();
  return seconds < std::min(left_s, kLongestDurationS) ? time + ros::Duration(seconds)
                                                       : ros::TIME_MAX;
}

void choosePart(const BagSet& bags, const PlanOptions& options, FramePlan& plan) {
  if (bags.messages().empty()) {
    return;
  }
  plan.begin = later(bags.messages().front().entry->time, options.start_s);
  plan.end = options.duration_s > 0 ? later(plan.begin, options.duration_s)
                                    : bags.messages().back().entry->time;
}

double smallestGap(const Messages& left, const StampPairs& pairs,
                   const std::vector<ros::Time>& right) {
  std::vector<ros::Time> sorted = right;
  std::sort(sorted.begin(), sorted.end());
  double gap_s = std::numeric_limits<double>::infinity();
  for (const std::size_t index : pairs.left_alone) {
    if (!sorted.empty()) {
      const ros::Time& stamp = left[index].entry->stamp;
      const std::int64_t gap_ns = distanceNs(sorted[nearestStamp(sorted, stamp)], stamp);
      gap_s = std::min(gap_s, static_cast<double>(gap_ns) * 1e-9);
    }
  }
  return gap_s;
}

void chooseOffsetFrames(double interval_s, std::vector<PlannedFrame>& frames) {
  const auto interval = [&](std::size_t index) {
    return std::floor(frames[index].left.entry->stamp.toSec() / interval_s);
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool same = interval_s > 0 && i > 0 && interval(i) == interval(i - 1);
    frames[i].offset_frame = same ? frames[i - 1].offset_frame : i;
  }
}

}  // namespace

FramePlan planFrames(const BagSet& bags, const CameraTopics& topics, const PlanOptions& options) {
  FramePlan plan;
  plan.topics = topics;
  choosePart(bags, options, plan);
  const Messages left = inPart(bags.onTopic(topics.left.name), plan);
  // Right images that were recorded around the ends of the part belong to left ones in it.
  const Messages right = bags.onTopic(topics.right.name);
  const StampedTopic left_infos = readInfos(bags, topics.left_info);
  const StampedTopic right_infos = readInfos(bags, topics.right_info);
  const StampedTopic colors(topics.color.name.empty() ? Messages()
                                                      : bags.onTopic(topics.color.name));
  const std::vector<ros::Time> right_stamps = stampsOf(right);
  const StampPairs pairs = pairStamps(stampsOf(left), right_stamps, options.max_stamp_difference_s);
  for (std::size_t i = 0; i < pairs.pairs.size(); i += static_cast<std::size_t>(options.every)) {
    const auto [l, r] = pairs.pairs[i];
    const ros::Time& stamp = left[l].entry->stamp;
    PlannedFrame frame{left[l],
                       right[r],
                       left_infos.nearest(stamp),
                       right_infos.nearest(right[r].entry->stamp),
                       std::nullopt,
                       0};
    if (!colors.empty() && colors.nearest(stamp).entry->stamp == stamp) {
      frame.color = colors.nearest(stamp);
    }
    plan.infos_of_other_stamps += frame.left_info.entry->stamp != stamp ||
                                  frame.right_info.entry->stamp != frame.right.entry->stamp;
    plan.frames.push_back(frame);
  }
  chooseOffsetFrames(options.offset_interval_s, plan.frames);
  plan.left_images = left.size();
  plan.right_images = inPart(right, plan).size();
  plan.pairs = pairs.pairs.size();
  plan.left_alone = pairs.left_alone.size();
  plan.right_alone = static_cast<std::size_t>(
      std::count_if(pairs.right_alone.begin(), pairs.right_alone.end(), [&](std::size_t index) {
        const ros::Time& time = right[index].entry->time;
        return time >= plan.begin && time <= plan.end;
      }));
  plan.repeated_stamps = pairs.left_repeated.size() + pairs.right_repeated.size();
  plan.smallest_gap_s = smallestGap(left, pairs, right_stamps);
  return plan;
}

}  // namespace cbmv
