#pragma once

#include <memory>
#include <string>

#include <ros/time.h>
#include <rosbag/bag.h>

#include "offline/raw_message.h"

namespace cbmv {

/// Compression by the name that users give it: none, lz4, bz2. Throws Error for others.
rosbag::CompressionType compressionOf(const std::string& name);

/// Writes a bag that has its name only once it is complete and on the disk.
class BagWriter {
 public:
  /// Writes to `path` with ".writing" behind it.
  BagWriter(std::string path, rosbag::CompressionType compression);
  /// What has not been finished is removed.
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// Throws Error that names the file and the cause: a full disk, as a rule.
  void write(const RawMessage& message, const ros::Time& time);
  /// Closes, waits for the disk, and gives the file its name. Throws Error likewise.
  void finish(const std::string& final_name);
  void finish() { finish(path_); }

 private:
  std::string path_;
  std::string written_path_;
  std::unique_ptr<rosbag::Bag> bag_;
};

/// Waits until the file, or the folder's list of files, is on the disk. Throws Error.
void syncToDisk(const std::string& path);

}  // namespace cbmv
