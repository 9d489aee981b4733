#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include "offline/frame_outputs.h"

namespace cbmv {

/// The frames of a recording as files, DIR/OUTPUT/FRAME_STAMP.EXTENSION, and DIR/index.csv, one
/// line a frame. The parts of Segments then hold these lines alone.
class FrameFiles {
 public:
  /// Makes the folder DIR. Throws Error that names it if it cannot be made.
  FrameFiles(const std::string& folder, const FrameOutputs& outputs, DisparityFormat format);

  /// Of the index, which is there once all frames are.
  std::string indexPath() const;
  /// Makes the folders of the outputs; `anew`: removes the files of earlier runs. Throws Error.
  void begin(bool anew) const;

  /// Writes the files of a frame, each under another name until it is complete, and returns its
  /// line. May be called by several threads at once. Throws Error that names the file.
  RawMessage write(std::size_t frame, const PreparedFrame& prepared,
                   const ProcessedFrame& processed);
  /// The line of a frame that failed.
  RawMessage failed(std::size_t frame, const ros::Time& stamp, const std::string& reason) const;
  /// Topic of the lines of write().
  static const char* doneTopic();

  /// Waits until what has been written is on the disk. Throws Error.
  void sync();
  /// Writes the index from the lines in the parts. Throws Error.
  void writeIndex(const std::vector<std::string>& parts) const;

 private:
  void removeAll() const;
  std::string subfolder(const FrameOutputs::FileKind& kind) const;

  const std::string folder_;
  const FrameOutputs& outputs_;
  const std::vector<FrameOutputs::FileKind> kinds_;
  std::mutex unsynced_mutex_;
  std::vector<std::string> unsynced_;  ///< files that may not be on the disk yet
};

}  // namespace cbmv
