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

/// What to do about the parts of an earlier run.
enum class EarlierParts { kRefuse, kResume, kOverwrite };

/// A file that one process at a time holds; the kernel lets go of it whatever ends the process.
class LockFile {
 public:
  /// Makes the file if there is none. Throws Error that says `purpose` is taken.
  LockFile(const std::string& path, const std::string& purpose);
  ~LockFile();
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

 private:
  int file_;
};

/// The frames that are done, as small bags beside the output: OUTPUT.part.FIRST-LAST, numbers of
/// frames, each complete and on the disk; OUTPUT.part.json says what they were made from. A process
/// that is killed loses the frames since its last part only.
class Segments {
 public:
  /// Bytes that are free where a file lies; tests bring their own.
  using FreeSpace = std::function<std::uint64_t(const std::string& path)>;

  /// `origin` is a text of everything the frames depend on. Throws Error if the output exists (but
  /// see isComplete), if
  /// there are parts that must not be there or are of another origin, or if another process writes
  /// them.
  Segments(std::string output, const std::string& origin, EarlierParts earlier,
           FreeSpace free_space = nullptr);

  /// With EarlierParts::kResume: the output is there already. Nothing is written then.
  bool isComplete() const { return complete_; }
  /// Frames 0 … framesDone() − 1 are in the parts.
  std::size_t framesDone() const { return done_; }
  /// The next frame; without messages it is one that failed. Begins and ends parts. Throws Error if
  /// the disk is full, and then has kept all frames before.
  void write(const std::vector<RawMessage>& messages, const ros::Time& time);
  /// Ends the part in work.
  void closePart();
  /// The parts in their order.
  std::vector<std::string> paths() const { return paths_; }
  /// Removes all parts: the output is complete.
  void remove();
  void setFramesPerPart(std::size_t frames) { frames_per_part_ = frames; }
  /// Called before a part gets its name.
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
  std::size_t done_ = 0;   ///< in parts
  std::size_t taken_ = 0;  ///< with those in the part in work
  double part_begin_s_ = 0;
  std::vector<std::string> paths_;
  std::unique_ptr<BagWriter> writer_;
};

/// A topic that is no part of the output: what a bag says of itself, see ShardLabel.
inline constexpr const char* kShardTopic = "/cbmv_bag/shard";

/// Writes what is in parts, in their order, and other messages, which come before those of a later
/// time; without kShardTopic. Throws Error if a part is damaged or the output cannot be written.
void mergeBags(const std::vector<std::string>& parts, const std::vector<BagMessage>& others,
               BagWriter& writer);

}  // namespace cbmv
