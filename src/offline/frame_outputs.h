#pragma once

#include <string>
#include <vector>

#include "offline/prepared_frame.h"
#include "offline/raw_message.h"

namespace cbmv {

/// Names of the outputs that can be asked for: the topics of the live node, and cloud for points2.
std::vector<std::string> offlineOutputNames();

/// Of files of disparities, see writeMessageFile.
enum class DisparityFormat { kPfm, kKitti };

/// Makes the messages of a frame, by the functions that the live node uses, or files of these.
class FrameOutputs {
 public:
  /// `wanted` are names from offlineOutputNames; throws Error that lists them for others.
  FrameOutputs(const std::vector<std::string>& wanted, const CameraTopics& topics);

  /// The topics that are written.
  std::vector<std::string> topics() const;
  bool needsColor() const;

  /// In the order of offlineOutputNames, with the header of the left image. May be called by
  /// several threads at once.
  std::vector<RawMessage> make(const PreparedFrame& prepared,
                               const ProcessedFrame& processed) const;

  /// A kind of file: the name of its output, and how its name ends.
  struct FileKind {
    std::string name;
    std::string extension;  ///< with the dot
  };
  /// Of the outputs that are wanted, in the order of offlineOutputNames.
  std::vector<FileKind> fileKinds(DisparityFormat format) const;
  /// Writes what make() makes as the files `paths`, one for each of fileKinds. May be called by
  /// several threads at once. Throws Error that names the file.
  void write(const PreparedFrame& prepared, const ProcessedFrame& processed,
             const std::vector<std::string>& paths) const;

 private:
  std::vector<std::size_t> wanted_;  ///< rows of the table of outputs
  std::string output_namespace_;
  std::string color_topic_;
};

}  // namespace cbmv
