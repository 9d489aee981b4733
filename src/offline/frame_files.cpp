#include "offline/frame_files.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <regex>

#include <std_msgs/String.h>

#include "io/binary_file.h"
#include "offline/bag_reader.h"
#include "offline/bag_writer.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDone = "done";
constexpr const char* kFailed = "failed";
constexpr const char* kUnfinished = ".unfinished.";  // prefix of a temporary file name

std::string stampText(const ros::Time& stamp) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%u.%09u", stamp.sec, stamp.nsec);
  return text.data();
}

std::string fileName(std::size_t frame, const ros::Time& stamp, const std::string& extension) {
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "%08zu_", frame);
  return number.data() + stampText(stamp) + extension;
}

/// Quotes a CSV field.
std::string csvField(const std::string& text) {
  std::string field = "\"";
  for (const char c : text) {
    field += c == '"' ? "\"\"" : std::string(1, c);
  }
  return field + "\"";
}

RawMessage line(const char* topic, std::size_t frame, const ros::Time& stamp,
                const std::string& fields) {
  std_msgs::String text;
  text.data = std::to_string(frame) + "," + stampText(stamp) + "," + fields + "\n";
  return toRawMessage(text, topic);
}

void rename(const std::string& from, const std::string& to) {
  std::error_code failure;
  fs::rename(from, to, failure);
  if (failure) {
    throw cannotWrite(to, failure.message());
  }
}

/// Temporary files.
class Unfinished {
 public:
  explicit Unfinished(std::vector<std::string> paths) : paths_(std::move(paths)) {}
  ~Unfinished() {
    std::error_code ignored;
    for (const std::string& path : paths_) {
      fs::remove(path, ignored);
    }
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
  const std::vector<std::string>& paths() const { return paths_; }

 private:
  std::vector<std::string> paths_;
};

}  // namespace

FrameFiles::FrameFiles(const std::string& folder, const FrameOutputs& outputs,
                       DisparityFormat format)
    : folder_((fs::path(folder) / "").parent_path().string()),
      outputs_(outputs),
      kinds_(outputs.fileKinds(format)) {
  makeFolder(folder_);
}

void FrameFiles::begin(bool anew) const {
  for (const FrameOutputs::FileKind& kind : kinds_) {
    makeFolder(subfolder(kind));
  }
  if (anew) {
    removeAll();
  }
}

std::string FrameFiles::indexPath() const { return folder_ + "/index.csv"; }

const char* FrameFiles::doneTopic() { return kDone; }

std::string FrameFiles::subfolder(const FrameOutputs::FileKind& kind) const {
  return folder_ + "/" + kind.name;
}

RawMessage FrameFiles::write(std::size_t frame, const PreparedFrame& prepared,
                             const ProcessedFrame& processed) {
  const std_msgs::Header& header = prepared.loaded.messages.left_image->header;
  std::string fields = csvField(header.frame_id);
  std::vector<std::string> unfinished_paths;
  std::vector<std::string> paths;
  for (const FrameOutputs::FileKind& kind : kinds_) {
    const std::string name = fileName(frame, header.stamp, kind.extension);
    unfinished_paths.push_back(subfolder(kind) + "/" + kUnfinished + name);
    paths.push_back(subfolder(kind) + "/" + name);
    fields += "," + kind.name + "/" + name;
  }
  const Unfinished unfinished(unfinished_paths);
  outputs_.write(prepared, processed, unfinished.paths());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    rename(unfinished.paths()[i], paths[i]);
  }
  const std::lock_guard<std::mutex> lock(unsynced_mutex_);
  unsynced_.insert(unsynced_.end(), paths.begin(), paths.end());
  return line(kDone, frame, header.stamp, fields + ",");
}

RawMessage FrameFiles::failed(std::size_t frame, const ros::Time& stamp,
                              const std::string& reason) const {
  return line(kFailed, frame, stamp, std::string(kinds_.size() + 1, ',') + csvField(reason));
}

void FrameFiles::sync() {
  std::vector<std::string> files;
  {
    const std::lock_guard<std::mutex> lock(unsynced_mutex_);
    files.swap(unsynced_);
  }
  for (const std::string& file : files) {
    syncToDisk(file);
  }
  for (const FrameOutputs::FileKind& kind : kinds_) {
    syncToDisk(subfolder(kind));
  }
}

void FrameFiles::writeIndex(const std::vector<std::string>& parts) const {
  std::string text = "frame,stamp,frame_id";
  for (const FrameOutputs::FileKind& kind : kinds_) {
    text += "," + kind.name;
  }
  text += ",failure\n";
  for (const std::string& part : parts) {
    const BagReader reader(part);
    std::vector<BagEntry> entries = reader.entries();
    std::sort(entries.begin(), entries.end(),  // in the order of writing; times may be out of order
              [](const BagEntry& a, const BagEntry& b) { return a.offset < b.offset; });
    for (const BagEntry& entry : entries) {
      text += fromRawMessage<std_msgs::String>(reader.read(entry))->data;
    }
  }
  const std::string unfinished = folder_ + "/" + kUnfinished + "index.csv";
  writeFile(unfinished, text);
  syncToDisk(unfinished);
  rename(unfinished, indexPath());
  syncToDisk(folder_);
}

void FrameFiles::removeAll() const {
  const std::regex ours(R"((\.unfinished\.)?[0-9]{8,}_[0-9]+\.[0-9]{9}\.(pfm|png|ply|yaml))");
  std::error_code ignored;
  fs::remove(indexPath(), ignored);
  for (const FrameOutputs::FileKind& kind : kinds_) {
    for (const auto& file : fs::directory_iterator(subfolder(kind))) {
      if (std::regex_match(file.path().filename().string(), ours)) {
        fs::remove(file.path(), ignored);
      }
    }
  }
}

}  // namespace cbmv
