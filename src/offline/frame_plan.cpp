#include "offline/frame_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "offline/pairing.h"
#include "ros/stamps.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kLargestSensibleGapS = 1;  // largest plausible difference of the images of a pair
constexpr double kLongestDurationS = 2e9;   // slightly below the limit of ros::Duration

using Messages = std::vector<BagMessage>;

std::vector<ros::Time> stampsOf(const Messages& messages) {
  std::vector<ros::Time> stamps;
  stamps.reserve(messages.size());
  for (const BagMessage& message : messages) {
    stamps.push_back(message.entry->stamp);
  }
  return stamps;
}

std::vector<StampedImage> imagesOf(const Messages& messages) {
  std::vector<StampedImage> images;
  images.reserve(messages.size());
  for (const BagMessage& message : messages) {
    images.push_back({message.entry->stamp, message.place});
  }
  return images;
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
  /// The message for an image: with its stamp, else with the last stamp before it, else the first
  /// message. Of several with the same stamp, the last one recorded before the image, else the
  /// first.
  const BagMessage& of(const BagMessage& image) const {
    const auto later = std::upper_bound(stamps_.begin(), stamps_.end(), image.entry->stamp);
    const ros::Time& stamp = later == stamps_.begin() ? stamps_.front() : *(later - 1);
    const auto [first, end] = std::equal_range(stamps_.begin(), stamps_.end(), stamp);
    const auto begin = messages_.begin() + (first - stamps_.begin());
    const auto recorded_later =
        std::upper_bound(begin, messages_.begin() + (end - stamps_.begin()), image.entry->time,
                         [](const ros::Time& time, const BagMessage& message) {
                           return time < message.entry->time;
                         });
    return recorded_later == begin ? *begin : *(recorded_later - 1);
  }

 private:
  Messages messages_;
  std::vector<ros::Time> stamps_;
};

/// Empty if a calibration was given.
StampedTopic readInfos(const BagSet& bags, const CameraTopics& topics, const std::string& topic) {
  if (topics.cameras) {
    return StampedTopic({});
  }
  StampedTopic infos(bags.onTopic(topic));
  if (infos.empty()) {
    throw Error(bags.names() + ": no message on " + topic +
                ", expected camera_info. Record it, or use --left-calibration");
  }
  return infos;
}

/// `time` plus `seconds`, limited to ros::TIME_MAX.
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

Messages inPart(const Messages& messages, const FramePlan& plan) {
  Messages part;
  std::copy_if(messages.begin(), messages.end(), std::back_inserter(part),
               [&](const auto& message) { return plan.isInPart(message); });
  return part;
}

Messages inPart(const std::vector<std::size_t>& indices, const Messages& messages,
                const FramePlan& plan) {
  Messages chosen;
  for (const std::size_t index : indices) {
    chosen.push_back(messages[index]);
  }
  return inPart(chosen, plan);
}

double smallestGap(const Messages& left_alone, const Messages& right) {
  std::vector<ros::Time> sorted = stampsOf(right);
  std::sort(sorted.begin(), sorted.end());
  double gap_s = std::numeric_limits<double>::infinity();
  for (const BagMessage& left : left_alone) {
    if (!sorted.empty()) {
      const ros::Time& stamp = left.entry->stamp;
      gap_s = std::min(gap_s, std::abs(secondsBetween(sorted[nearestStamp(sorted, stamp)], stamp)));
    }
  }
  return gap_s;
}

void countImages(const Messages& left, const Messages& right, const StampPairs& pairs,
                 FramePlan& plan) {
  const Messages left_alone = inPart(pairs.left_alone, left, plan);
  plan.left_images = inPart(left, plan).size();
  plan.right_images = inPart(right, plan).size();
  plan.left_alone = left_alone.size();
  plan.right_alone = inPart(pairs.right_alone, right, plan).size();
  plan.repeated_stamps = inPart(pairs.left_repeated, left, plan).size() +
                         inPart(pairs.right_repeated, right, plan).size();
  plan.smallest_gap_s = smallestGap(left_alone, right);
}

/// The messages that accompany the images.
class Companions {
 public:
  Companions(const BagSet& bags, const CameraTopics& topics)
      : left_infos_(readInfos(bags, topics, topics.left_info)),
        right_infos_(readInfos(bags, topics, topics.right_info)),
        colors_(topics.color.name.empty() ? Messages() : bags.onTopic(topics.color.name)) {}

  PlannedFrame join(const BagMessage& left, const BagMessage& right) const {
    const ros::Time& stamp = left.entry->stamp;
    PlannedFrame frame{left, right, {}, {}, {}, 0};
    if (!left_infos_.empty()) {
      frame.left_info = left_infos_.of(left);
      frame.right_info = right_infos_.of(right);
    }
    if (!colors_.empty() && colors_.of(left).entry->stamp == stamp) {
      frame.color = colors_.of(left);
    }
    return frame;
  }

 private:
  StampedTopic left_infos_;
  StampedTopic right_infos_;
  StampedTopic colors_;
};

/// Reports how many left images have no partner and how to pair them; empty if all have one.
std::string unpairedText(const FramePlan& plan) {
  if (plan.left_alone == 0) {
    return {};
  }
  const std::string images = std::to_string(plan.left_alone) + " left images have no right image";
  if (!std::isfinite(plan.smallest_gap_s) || plan.smallest_gap_s <= 0) {
    return images + ". Check that both cameras were recorded at the same time.";
  }
  std::array<char, 160> remedy{};
  if (plan.smallest_gap_s > kLargestSensibleGapS) {
    std::snprintf(remedy.data(), remedy.size(),
                  " with equal stamp; the nearest stamp is %.3g s away: the clocks of the cameras "
                  "differ. Synchronize them.",
                  plan.smallest_gap_s);
  } else {
    std::snprintf(remedy.data(), remedy.size(),
                  " with equal stamp; the nearest is %.6f s away. Pair them with "
                  "--max-stamp-difference-s %.2g.",
                  plan.smallest_gap_s, 1.05 * plan.smallest_gap_s);
  }
  return images + remedy.data();
}

bool hasOtherStamp(const std::optional<BagMessage>& info, const BagMessage& image) {
  return info && info->entry->stamp != image.entry->stamp;
}

bool isOfSameInterval(const PlannedFrame& a, const PlannedFrame& b, double interval_s) {
  const auto interval = [&](const PlannedFrame& frame) {
    return std::floor(frame.left.entry->stamp.toSec() / interval_s);
  };
  return interval_s > 0 && interval(a) == interval(b);
}

}  // namespace

PlanProblems findProblems(const FramePlan& plan) {
  PlanProblems problems;
  const std::string unpaired = unpairedText(plan);
  if (plan.frames.empty()) {
    const std::string images = std::to_string(plan.left_images) + " left and " +
                               std::to_string(plan.right_images) + " right images";
    problems.nothing_to_process =
        "no pair to process: " +
        (plan.left_images + plan.right_images == 0
             ? "the selected part of the bag has no images on " + plan.topics.left.name + " and " +
                   plan.topics.right.name + ". Change --start and --duration."
             : images + ". " + (unpaired.empty() ? "No left image has a right image." : unpaired));
  } else if (!unpaired.empty()) {
    problems.others.push_back(unpaired);
  }
  if (plan.equal_stamps > 0) {
    problems.others.push_back(
        std::to_string(plan.equal_stamps) +
        " pairs have the same stamp as the previous pair. They are paired in recording order, so a "
        "lost image can cause wrong pairs. Set header.stamp in the driver.");
  }
  return problems;
}

FramePlan planFrames(const BagSet& bags, const CameraTopics& topics, const PlanOptions& options) {
  FramePlan plan;
  plan.topics = topics;
  choosePart(bags, options, plan);
  const Messages left = bags.onTopic(topics.left.name);
  const Messages right = bags.onTopic(topics.right.name);
  const Companions companions(bags, topics);
  const StampPairs pairs =
      pairStamps(imagesOf(left), imagesOf(right), options.max_stamp_difference_s);
  for (const auto& [l, r] : pairs.pairs) {
    PlannedFrame frame = companions.join(left[l], right[r]);
    if (plan.offset_frames.empty() ||
        !isOfSameInterval(frame, plan.offset_frames.back(), options.offset_interval_s)) {
      plan.offset_frames.push_back(frame);
    }
    if (!plan.isInPart(left[l]) || plan.pairs++ % static_cast<std::size_t>(options.every) != 0) {
      continue;
    }
    frame.offset_frame = plan.offset_frames.size() - 1;
    plan.equal_stamps +=
        !plan.frames.empty() && plan.frames.back().left.entry->stamp == frame.left.entry->stamp;
    plan.infos_of_other_stamps +=
        hasOtherStamp(frame.left_info, left[l]) || hasOtherStamp(frame.right_info, right[r]);
    plan.frames.push_back(frame);
  }
  countImages(left, right, pairs, plan);
  return plan;
}

}  // namespace cbmv
