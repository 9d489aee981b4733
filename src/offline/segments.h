#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "offline/bag_set.h"
#include "offline/bag_writer.h"

namespace cbmv {

/// What to do with the parts of an earlier run.
enum class EarlierParts { kReject, kResume, kOverwrite };

/// A file lock for one process at a time. The kernel releases it whenever the process ends.
class LockFile {
 public:
  /// Creates the file if needed. Throws Error with `purpose` if another process holds the lock.
  LockFile(const std::string& path, const std::string& purpose);
  ~LockFile();
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

 private:
  int file_;
};

/// Stores finished frames as small bags beside the output: OUTPUT.part.FIRST-LAST with frame
/// numbers. Each part is complete and on disk. OUTPUT.part.json describes what the frames depend
/// on. A killed process loses only the frames since its last part.
class Segments {
 public:
  /// Returns the free bytes on the file system of a path; tests replace it.
  using FreeSpace = std::function<std::uint64_t(const std::string& path)>;

  /// `origin`: text with everything the frames depend on. Throws Error if the output exists (but
  /// see isComplete), if parts exist that are not allowed or have another origin, or if another
  /// process writes them.
  Segments(std::string output, const std::string& origin, EarlierParts earlier,
           FreeSpace free_space = nullptr);

  /// With EarlierParts::kResume: the output already exists and nothing is written.
  bool isComplete() const { return complete_; }
  /// Frames 0 … framesDone() − 1 are in the parts.
  std::size_t framesDone() const { return done_; }
  /// Adds the next frame; without messages, a failed frame. Opens and closes parts. Throws Error if
  /// the disk is full; all earlier frames are kept.
  void write(const std::vector<RawMessage>& messages, const ros::Time& time);
  /// Closes the current part.
  void closePart();
  /// The parts in order.
  std::vector<std::string> paths() const { return paths_; }
  /// Removes all parts after the output is complete.
  void remove();
  void setFramesPerPart(std::size_t frames) { frames_per_part_ = frames; }
  /// Called before a part gets its final name.
  void setBeforePart(std::function<void()> action) { before_part_ = std::move(action); }

 private:
  void findParts();
  void removeFiles(bool complete_ones);
  std::string partPath(std::size_t first, std::size_t end) const;
  void requireSpace(const std::vector<RawMessage>& messages);

  std::string output_;
  std::string origin_path_;
  FreeSpace free_space_;
  std::function<void()> before_part_;
  std::unique_ptr<LockFile> lock_;
  std::size_t frames_per_part_ = 50;
  bool complete_ = false;
  std::size_t done_ = 0;   ///< frames in complete parts
  std::size_t taken_ = 0;  ///< including the current part
  double part_begin_s_ = 0;
  std::vector<std::string> paths_;
  std::unique_ptr<BagWriter> writer_;
};

/// Topic of the ShardLabel; not copied to the output.
inline constexpr const char* kShardTopic = "/cbmv_bag/shard";

/// Writes the messages of the parts in order and merges in `others` by time; without kShardTopic.
/// Throws Error if a part is damaged or the output cannot be written.
void mergeBags(const std::vector<std::string>& parts, const std::vector<BagMessage>& others,
               BagWriter& writer);

}  // namespace cbmv
