#pragma once

#include <memory>
#include <string>

#include <ros/time.h>
#include <rosbag/bag.h>

#include "offline/raw_message.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

/// Parses a compression name: none, lz4, bz2. Throws Error for others.
rosbag::CompressionType compressionOf(const std::string& name);

/// Writes a bag under a temporary name and renames it when it is complete and on disk.
class BagWriter {
 public:
  /// Writes to `path`.writing.
  BagWriter(std::string path, rosbag::CompressionType compression);
  /// Removes an unfinished bag.
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// Throws Error with the file and the cause (usually a full disk).
  void write(const RawMessage& message, const ros::Time& time);
  /// Closes the bag, syncs it to disk and renames it. Errors as write().
  void finish(const std::string& final_name);
  void finish() { finish(path_); }

 private:
  std::string path_;
  std::string written_path_;
  std::unique_ptr<rosbag::Bag> bag_;
};

/// The error for a file that cannot be written, with what to do.
Error cannotWrite(const std::string& path, const std::string& reason);

/// Syncs a file, or a folder's list of files, to disk. Throws Error.
void syncToDisk(const std::string& path);

}  // namespace cbmv
