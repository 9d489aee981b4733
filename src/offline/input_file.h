#pragma once

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cbmv_stereo/error.h"

namespace cbmv {

/// A file for random access by several threads. It is not memory-mapped, because truncation by
/// another process or a disk error would then kill the program. Here they throw Error.
class InputFile {
 public:
  /// Throws Error with the file.
  explicit InputFile(const std::string& path) : path_(path) {
    // Non-blocking, because opening a pipe would wait for a writer.
    file_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status {};
    if (file_ < 0 || fstat(file_, &status) != 0) {
      failAndClose(std::strerror(errno));
    }
    if (!S_ISREG(status.st_mode)) {
      failAndClose("it is not a regular file. Give the path of a bag file");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~InputFile() { close(file_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Bytes at the time of opening.
  std::uint64_t size() const { return size_; }

  /// Throws Error with the file if it was truncated or the disk fails.
  void read(std::uint64_t offset, std::uint8_t* bytes, std::uint64_t size) const {
    while (size > 0) {
      const ssize_t read_bytes = pread(file_, bytes, size, static_cast<off_t>(offset));
      if (read_bytes < 0 && errno != EINTR) {
        throw Error("cannot read " + path_ + ": " + std::strerror(errno));
      }
      if (read_bytes == 0) {
        throw Error(path_ + " was truncated while it was read: byte " + std::to_string(offset) +
                    " no longer exists. Do not modify the file during processing");
      }
      if (read_bytes > 0) {
        bytes += read_bytes;
        offset += static_cast<std::uint64_t>(read_bytes);
        size -= static_cast<std::uint64_t>(read_bytes);
      }
    }
  }

 private:
  [[noreturn]] void failAndClose(const std::string& cause) const {
    if (file_ >= 0) {
      close(file_);
    }
    throw Error("cannot read " + path_ + ": " + cause);
  }

  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace cbmv
