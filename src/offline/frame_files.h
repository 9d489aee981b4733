#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include "offline/frame_outputs.h"

namespace cbmv {

/// Writes the frames of a bag as files DIR/OUTPUT/FRAME_STAMP.EXTENSION, and DIR/index.csv with one
/// line per frame. The parts of Segments then contain only these lines.
class FrameFiles {
 public:
  /// Creates the folder DIR. Throws Error with its path on failure.
  FrameFiles(const std::string& folder, const FrameOutputs& outputs, DisparityFormat format);

  /// Path of the index, which is written after all frames.
  std::string indexPath() const;
  /// Creates the folders of the outputs. `anew`: removes the files of earlier runs. Throws Error.
  void begin(bool anew) const;

  /// Writes the files of a frame and returns its index line. Each file has a temporary name until
  /// it is complete. Thread-safe. Throws Error with the file.
  RawMessage write(std::size_t frame, const PreparedFrame& prepared,
                   const ProcessedFrame& processed);
  /// The index line of a failed frame.
  RawMessage failed(std::size_t frame, const ros::Time& stamp, const std::string& reason) const;
  /// Topic of the lines from write().
  static const char* doneTopic();

  /// Syncs all written files to disk. Throws Error.
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
  std::vector<std::string> unsynced_;  ///< files that may not be on disk yet
};

}  // namespace cbmv
