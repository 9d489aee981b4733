#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "offline/bag_writer.h"
#include "offline/frame_plan.h"

namespace cbmv {

/// One of so many parts of a recording, each processed by a process of its own.
struct Shard {
  std::size_t number = 1;  ///< 1 … count
  std::size_t count = 1;
};

/// From "2/4". Throws Error.
Shard parseShard(const std::string& text);

/// "shard 2/4".
std::string describeShard(const Shard& shard);

/// Leaves the frames of a shard in the plan, from FramePlan::first on; those before stay for their
/// vertical offsets, so nothing of a frame depends on the shard. The bytes of the left images, or
/// the number of compressed ones, are shared out evenly. Messages of other topics belong to the
/// shard of the frame before which a run over all frames writes them. Throws Error if there is no
/// frame.
void cutToShard(const Shard& shard, FramePlan& plan);

/// What the bag of a shard says of itself.
struct ShardLabel {
  Shard shard;
  std::size_t first = 0;   ///< number of its first frame among those of all shards
  std::size_t end = 0;     ///< number behind its last one
  std::size_t failed = 0;  ///< frames
  bool damaged = false;    ///< the recording
  std::string origin;      ///< everything that the frames of all shards depend on
};

/// The message that holds a label.
RawMessage toMessage(const ShardLabel& label);

/// Throws Error if the bag is not the one of a shard, or not complete.
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
  std::size_t failed = 0;  ///< frames
  bool damaged = false;    ///< the recording

  bool isComplete() const { return failed == 0 && !damaged; }
};

/// One bag from those of all shards of a recording, as a run over all frames writes it. Throws
/// Error if a shard is missing, is there twice, is damaged, or comes from other settings or another
/// recording than the first.
MergeSummary mergeShards(const MergeOptions& options);

}  // namespace cbmv
