#include "offline/shard.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <regex>
#include <utility>

#include <nlohmann/json.hpp>
#include <rosbag/view.h>
#include <std_msgs/String.h>

#include "io/other_file.h"
#include "offline/segments.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostShards = 100000;
constexpr const char* kUnfinished = ".merge";  // suffix of the output name

std::uint64_t costOf(const PlannedFrame& frame, const CameraTopics& topics) {
  return topics.left.compressed ? 1 : frame.left.entry->size;
}

/// Number of frames in the first `number` shards; at least 1, so that lastTime is defined.
std::size_t boundAfter(std::size_t number, std::size_t count, const FramePlan& plan) {
  const std::uint64_t all = std::accumulate(
      plan.frames.begin(), plan.frames.end(), std::uint64_t{0},
      [&](std::uint64_t sum, const auto& frame) { return sum + costOf(frame, plan.topics); });
  std::uint64_t before = 0;
  std::size_t bound = 0;
  while (bound < plan.frames.size() && before * count < all * number) {
    before += costOf(plan.frames[bound], plan.topics);
    ++bound;
  }
  return bound;
}

/// The latest recording time of the first `bound` frames.
ros::Time lastTime(std::size_t bound, const FramePlan& plan) {
  ros::Time last = plan.frames.front().left.entry->time;
  for (std::size_t i = 1; i < bound; ++i) {
    last = std::max(last, plan.frames[i].left.entry->time);
  }
  return last;
}

struct LabeledShard {
  std::string path;
  ShardLabel label;
};

/// Sorted by number.
std::vector<LabeledShard> readLabels(const std::vector<std::string>& paths) {
  std::vector<LabeledShard> shards;
  shards.reserve(paths.size());
  for (const std::string& path : paths) {
    shards.push_back({path, readShardLabel(path)});
  }
  std::stable_sort(shards.begin(), shards.end(), [](const auto& a, const auto& b) {
    return a.label.shard.number < b.label.shard.number;
  });
  return shards;
}

void requireSameOrigin(const std::vector<LabeledShard>& shards) {
  const LabeledShard& first = shards.front();
  for (const LabeledShard& other : shards) {
    if (other.label.origin != first.label.origin) {
      throw Error(first.path + " and " + other.path +
                  " have different input bags or settings, expected shards of the same run. Give "
                  "the shards of one run");
    }
    if (other.label.shard.count != first.label.shard.count) {
      throw Error(
          first.path + " is " + describeShard(first.label.shard) + " and " + other.path + " is " +
          describeShard(other.label.shard) +
          ", which overlap, expected the same number of shards. Give the shards of one run");
    }
  }
}

void requireEachOnce(const std::vector<LabeledShard>& shards) {
  const std::size_t count = shards.front().label.shard.count;
  for (std::size_t i = 0; i <= shards.size(); ++i) {
    const std::size_t number = i < shards.size() ? shards[i].label.shard.number : count + 1;
    if (i > 0 && number == shards[i - 1].label.shard.number) {
      throw Error(shards[i - 1].path + " and " + shards[i].path + " are both " +
                  describeShard(shards[i].label.shard) +
                  ", expected each shard once. Leave out one of them");
    }
    const std::size_t expected = i > 0 ? shards[i - 1].label.shard.number + 1 : 1;
    if (number != expected) {
      throw Error(
          describeShard({expected, count}) + " is missing" +
          (i > 0 ? " (frames from " + std::to_string(shards[i - 1].label.end) + " on)" : "") +
          ". Process it, or give its bag");
    }
  }
}

}  // namespace

Shard parseShard(const std::string& text) {
  std::smatch numbers;
  Shard shard{0, 0};
  if (std::regex_match(text, numbers, std::regex("([0-9]{1,6})/([0-9]{1,6})"))) {
    shard = {std::stoul(numbers[1]), std::stoul(numbers[2])};
  }
  if (shard.number < 1 || shard.number > shard.count || shard.count > kMostShards) {
    throw Error("--shard is '" + text + "', expected NUMBER/COUNT such as 2/4, with at most " +
                std::to_string(kMostShards) + " shards. Correct --shard");
  }
  return shard;
}

std::string describeShard(const Shard& shard) {
  return "shard " + std::to_string(shard.number) + "/" + std::to_string(shard.count);
}

void cutToShard(const Shard& shard, FramePlan& plan) {
  if (plan.frames.empty()) {
    throw Error(
        "there is no pair to process, so there are no shards. Check --start and --duration");
  }
  if (shard.number > 1) {
    plan.first = boundAfter(shard.number - 1, shard.count, plan);
    plan.begin = lastTime(plan.first, plan) + ros::Duration(0, 1);
  }
  if (shard.number < shard.count) {
    const std::size_t end = boundAfter(shard.number, shard.count, plan);
    plan.end = lastTime(end, plan);
    plan.frames.erase(plan.frames.begin() + static_cast<std::ptrdiff_t>(end), plan.frames.end());
  }
}

RawMessage toMessage(const ShardLabel& label) {
  const nlohmann::json json = {{"shard", label.shard.number}, {"shards", label.shard.count},
                               {"first_frame", label.first},  {"end_frame", label.end},
                               {"failed", label.failed},      {"damaged", label.damaged},
                               {"origin", label.origin}};
  std_msgs::String text;
  text.data = json.dump();
  return toRawMessage(text, kShardTopic);
}

ShardLabel readShardLabel(const std::string& path) {
  try {
    const rosbag::Bag bag(path, rosbag::bagmode::Read);
    rosbag::View labels(bag, rosbag::TopicQuery(kShardTopic));
    const auto text =
        labels.size() == 1 ? labels.begin()->instantiate<std_msgs::String>() : nullptr;
    if (!text) {
      throw Error(path +
                  " is not the bag of a shard, expected a bag written with --shard. Give the bags "
                  "of all shards");
    }
    const nlohmann::json json = nlohmann::json::parse(text->data);
    return {{json.at("shard"), json.at("shards")},
            json.at("first_frame"),
            json.at("end_frame"),
            json.at("failed"),
            json.at("damaged"),
            json.at("origin")};
  } catch (const ros::Exception& error) {
    throw Error("cannot read " + path + " as the bag of a shard: " + error.what() +
                ". Process the shard again");
  } catch (const nlohmann::json::exception& error) {
    throw Error(path + " was written by another version of cbmv_bag: " + error.what() +
                ". Process the shard again");
  }
}

MergeSummary mergeShards(const MergeOptions& options) {
  const rosbag::CompressionType compression = compressionOf(options.compression);
  for (const std::string& shard : options.shards) {
    requireOtherFile(shard, options.output);
    requireOtherFile(shard, options.output + kUnfinished);
  }
  if (fs::exists(options.output) && !options.overwrite) {
    throw Error(options.output +
                " exists. Choose another name for the output, or use --overwrite to replace it");
  }
  const std::vector<LabeledShard> shards = readLabels(options.shards);
  requireSameOrigin(shards);
  requireEachOnce(shards);
  MergeSummary summary;
  std::vector<std::string> paths;
  for (const LabeledShard& shard : shards) {
    paths.push_back(shard.path);
    summary.failed += shard.label.failed;
    summary.damaged |= shard.label.damaged;
  }
  summary.shards = shards.size();
  summary.frames = shards.back().label.end;
  const std::string written = options.output + kUnfinished;
  {
    const LockFile lock(written, options.output);
    BagWriter writer(written, compression);
    mergeBags(paths, {}, writer);
    writer.finish(options.output);
  }
  std::error_code ignored;
  fs::remove(written, ignored);
  return summary;
}

}  // namespace cbmv
