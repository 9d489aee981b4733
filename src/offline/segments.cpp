#include "offline/segments.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMarginBytes = 4 << 20;  // for the index of a part and unwritten buffers
constexpr double kPartSeconds = 20;              // limit of lost work

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::uint64_t freeSpace(const std::string& path) {
  std::error_code ignored;
  const auto space = fs::space(fs::absolute(path).parent_path(), ignored);
  return static_cast<std::uint64_t>(space.available);
}

std::string readText(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void writeText(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::trunc);
  file << text;
  file.close();
  if (!file) {
    throw cannotWrite(path, std::strerror(errno));
  }
  syncToDisk(path);
}

/// A complete part of an output.
struct Part {
  std::size_t first = 0;
  std::size_t end = 0;
  std::string path;
};

std::vector<Part> listParts(const std::string& output, std::vector<std::string>& unfinished) {
  const fs::path folder = fs::absolute(output).parent_path();
  const std::string prefix = fs::path(output).filename().string() + ".part.";
  const std::regex range("([0-9]{8,})-([0-9]{8,})");
  std::vector<Part> parts;
  for (const auto& file : fs::directory_iterator(folder)) {
    const std::string name = file.path().filename().string();
    if (name.rfind(prefix, 0) != 0) {
      continue;
    }
    const std::string rest = name.substr(prefix.size());
    std::smatch numbers;
    if (std::regex_match(rest, numbers, range)) {
      parts.push_back({std::stoul(numbers[1]), std::stoul(numbers[2]) + 1, file.path().string()});
    } else if (rest != "json") {
      unfinished.push_back(file.path().string());
    }
  }
  std::sort(parts.begin(), parts.end(),
            [](const Part& a, const Part& b) { return a.first < b.first; });
  return parts;
}

}  // namespace

LockFile::LockFile(const std::string& path, const std::string& purpose)
    : file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  if (file_ < 0) {
    throw cannotWrite(path, std::strerror(errno));
  }
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    close(file_);
    throw Error(purpose +
                " is being written by another process. Wait for it, or choose another output");
  }
}

LockFile::~LockFile() { close(file_); }

Segments::Segments(std::string output, const std::string& origin, EarlierParts earlier,
                   FreeSpace free_space)
    : output_(std::move(output)),
      origin_path_(output_ + ".part.json"),
      free_space_(free_space ? std::move(free_space) : freeSpace) {
  const bool overwrite = earlier == EarlierParts::kOverwrite;
  complete_ = earlier == EarlierParts::kResume && fs::exists(output_);
  if (complete_) {
    remove();  // left over if a process was killed at its very end
    return;
  }
  if (fs::exists(output_) && !overwrite) {
    throw Error(output_ +
                " exists. Choose another name for the output, or use --overwrite to replace it");
  }
  if (!fs::is_directory(fs::absolute(output_).parent_path())) {
    throw Error("cannot write " + output_ +
                ": its folder does not exist. Create it or choose another output");
  }
  lock_ = std::make_unique<LockFile>(origin_path_, output_);
  const std::string known = readText(origin_path_);
  if (!known.empty() && earlier == EarlierParts::kReject) {
    throw Error(output_ + " is unfinished. Use --resume to continue or --overwrite to start again");
  }
  if (!known.empty() && !overwrite && known != origin) {
    throw Error(output_ + " was started with other input or options (see " + origin_path_ +
                "). Use the same ones, or --overwrite");
  }
  removeFiles(overwrite || known.empty());
  writeText(origin_path_, origin);
  findParts();
}

void Segments::removeFiles(bool complete_ones) {
  std::vector<std::string> files;
  for (const Part& part : listParts(output_, files)) {
    if (complete_ones) {
      files.push_back(part.path);
    }
  }
  std::error_code ignored;
  for (const std::string& file : files) {
    fs::remove(file, ignored);
  }
}

void Segments::findParts() {
  std::vector<std::string> unfinished;
  for (const Part& part : listParts(output_, unfinished)) {
    if (part.first == done_ && part.end > done_) {
      paths_.push_back(part.path);
      done_ = part.end;
    }
  }
  taken_ = done_;
}

std::string Segments::partPath(std::size_t first, std::size_t end) const {
  std::array<char, 64> numbers{};
  std::snprintf(numbers.data(), numbers.size(), ".part.%08zu-%08zu", first, end - 1);
  return output_ + numbers.data();
}

void Segments::requireSpace(const std::vector<RawMessage>& messages) {
  std::uint64_t bytes = kMarginBytes;
  for (const RawMessage& message : messages) {
    bytes += message.size;
  }
  if (free_space_(output_) < bytes) {
    closePart();
    throw Error("the disk of " + output_ + " is full. " + std::to_string(done_) +
                " frames are kept. Free some space and use --resume");
  }
}

void Segments::write(const std::vector<RawMessage>& messages, const ros::Time& time) {
  requireSpace(messages);
  if (!writer_) {
    writer_ =
        std::make_unique<BagWriter>(output_ + ".part.next", rosbag::compression::Uncompressed);
    part_begin_s_ = steadySeconds();
  }
  try {
    for (const RawMessage& message : messages) {
      writer_->write(message, time);
    }
  } catch (const Error&) {
    writer_.reset();  // discards the frames of this part
    throw;
  }
  ++taken_;
  if (taken_ - done_ >= frames_per_part_ || steadySeconds() - part_begin_s_ > kPartSeconds) {
    closePart();
  }
}

void Segments::closePart() {
  if (!writer_) {
    return;
  }
  if (before_part_) {
    before_part_();
  }
  const std::string path = partPath(done_, taken_);
  const std::unique_ptr<BagWriter> writer = std::move(writer_);
  writer->finish(path);
  paths_.push_back(path);
  done_ = taken_;
}

void Segments::remove() {
  removeFiles(true);
  std::error_code ignored;
  fs::remove(origin_path_, ignored);
}

void mergeBags(const std::vector<std::string>& parts, const std::vector<BagMessage>& others,
               BagWriter& writer) {
  auto other = others.begin();
  const auto write_others = [&](const ros::Time& end) {
    for (; other != others.end() && other->entry->time <= end; ++other) {
      writer.write(other->read(), other->entry->time);
    }
  };
  for (const std::string& part : parts) {
    const BagReader reader(part);
    if (!reader.damage().empty()) {
      throw Error(part + " is damaged. Process its frames again with --overwrite");
    }
    for (const BagEntry& entry : reader.entries()) {
      if (reader.connections()[entry.connection]->topic != kShardTopic) {
        write_others(entry.time);
        writer.write(reader.read(entry), entry.time);
      }
    }
  }
  write_others(ros::TIME_MAX);
}

}  // namespace cbmv
