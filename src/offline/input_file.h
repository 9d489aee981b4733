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

/// A file that is read in pieces, by several threads at once. It is not mapped into memory: what
/// another process cuts off, or a disk does not give, would end the program then, here it is an
/// Error.
class InputFile {
 public:
  /// Throws Error that names the file.
  explicit InputFile(const std::string& path) : path_(path) {
    // A pipe would hold up whoever opens it.
    file_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status {};
    if (file_ < 0 || fstat(file_, &status) != 0) {
      failAndClose(std::strerror(errno));
    }
    if (!S_ISREG(status.st_mode)) {
      failAndClose("it is no file that can be read in any order");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~InputFile() { close(file_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Bytes, when it was opened.
  std::uint64_t size() const { return size_; }

  /// Throws Error that names the file where it does not have these bytes any more, or the disk does
  /// not give them.
  void read(std::uint64_t offset, std::uint8_t* bytes, std::uint64_t size) const {
    while (size > 0) {
      const ssize_t read_bytes = pread(file_, bytes, size, static_cast<off_t>(offset));
      if (read_bytes < 0 && errno != EINTR) {
        throw Error("cannot read " + path_ + ": " + std::strerror(errno));
      }
      if (read_bytes == 0) {
        throw Error(path_ + " has become shorter while it was read: there is no byte " +
                    std::to_string(offset) + " any more");
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
