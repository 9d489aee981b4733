#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "offline/bag_writer.h"
#include "offline/frame_plan.h"

namespace cbmv {

/// One of `count` parts of a bag, each processed by its own process.
struct Shard {
  std::size_t number = 1;  ///< 1 … count
  std::size_t count = 1;
};

/// Parses "2/4". Throws Error.
Shard parseShard(const std::string& text);

/// Returns "shard 2/4".
std::string describeShard(const Shard& shard);

/// Limits the plan to the frames of a shard, starting at FramePlan::first. Earlier frames remain
/// for their vertical offsets, so results do not depend on the shard. The shards get equal numbers
/// of bytes of left images, or equal numbers of images if they are compressed. Messages of other
/// topics go to the shard of the frame before which a run over all frames would write them. Throws
/// Error if there is no frame.
void cutToShard(const Shard& shard, FramePlan& plan);

/// Describes the bag of a shard.
struct ShardLabel {
  Shard shard;
  std::size_t first = 0;   ///< number of its first frame among the frames of all shards
  std::size_t end = 0;     ///< one past its last frame
  std::size_t failed = 0;  ///< number of failed frames
  bool damaged = false;    ///< whether the input is damaged
  std::string origin;      ///< everything the frames of all shards depend on
};

/// The message that stores a label.
RawMessage toMessage(const ShardLabel& label);

/// Throws Error if the bag is not from a shard or is incomplete.
ShardLabel readShardLabel(const std::string& path);

struct MergeOptions {
  std::vector<std::string> shards;  ///< in any order
  std::string output;
  std::string compression = "none";
  bool overwrite = false;
};

struct MergeSummary {
  std::size_t shards = 0;
  std::size_t frames = 0;
  std::size_t failed = 0;  ///< number of failed frames
  bool damaged = false;    ///< whether the input is damaged

  bool isComplete() const { return failed == 0 && !damaged; }
};

/// Merges the bags of all shards into one bag, as a run over all frames writes it. Throws Error if
/// a shard is missing, given twice or damaged, or if its settings or input differ from the first
/// shard.
MergeSummary mergeShards(const MergeOptions& options);

}  // namespace cbmv
