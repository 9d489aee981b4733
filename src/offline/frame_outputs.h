#pragma once

#include <string>
#include <vector>

#include "offline/prepared_frame.h"
#include "offline/raw_message.h"

namespace cbmv {

/// Names of the available outputs: the topics of the node, and cloud for points2.
std::vector<std::string> offlineOutputNames();

/// Format of disparity files, see writeMessageFile.
enum class DisparityFormat { kPfm, kKitti };

/// Builds the messages of a frame with the same functions as the node, or writes them as files.
class FrameOutputs {
 public:
  /// `wanted`: names from offlineOutputNames. Throws Error with the list of names for others.
  FrameOutputs(const std::vector<std::string>& wanted, const CameraTopics& topics);

  /// The topics that are written.
  std::vector<std::string> topics() const;
  bool needsColor() const;

  /// In the order of offlineOutputNames, with the header of the left image. Thread-safe.
  std::vector<RawMessage> make(const PreparedFrame& prepared,
                               const ProcessedFrame& processed) const;

  /// A kind of file: the name of its output and its extension.
  struct FileKind {
    std::string name;
    std::string extension;  ///< with the dot
  };
  /// For the wanted outputs, in the order of offlineOutputNames.
  std::vector<FileKind> fileKinds(DisparityFormat format) const;
  /// Writes the messages of make() to `paths`, one per element of fileKinds. Thread-safe. Throws
  /// Error with the file.
  void write(const PreparedFrame& prepared, const ProcessedFrame& processed,
             const std::vector<std::string>& paths) const;

 private:
  std::vector<std::size_t> wanted_;  ///< indices in the table of outputs
  std::string output_namespace_;
  std::string color_topic_;
};

}  // namespace cbmv
