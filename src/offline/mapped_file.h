#pragma once

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cbmv_stereo/error.h"

namespace cbmv {

/// A file as memory that is only read.
class MappedFile {
 public:
  /// Throws Error that names the file.
  explicit MappedFile(const std::string& path) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (file < 0 || fstat(file, &status) != 0) {
      const int cause = errno;
      closeIfOpen(file);
      throw Error("cannot read " + path + ": " + std::strerror(cause));
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
    if (size_ > 0) {
      data_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
    }
    closeIfOpen(file);
    if (data_ == MAP_FAILED) {
      throw Error("cannot read " + path + ": it is no file that can be mapped");
    }
  }
  ~MappedFile() {
    if (data_ != nullptr) {
      munmap(data_, size_);
    }
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const std::uint8_t* data() const { return static_cast<const std::uint8_t*>(data_); }
  std::uint64_t size() const { return size_; }

  /// Takes bytes that have been read out of the process's memory; reading brings them back. Without
  /// it the process holds all of the file in the end. By several threads at once.
  void release(std::uint64_t offset, std::uint64_t size) const {
    // The system brings whole blocks of addresses, what lies beside the bytes that are read, too.
    constexpr std::uintptr_t kBlock = 1 << 16;
    const auto first = reinterpret_cast<std::uintptr_t>(data_);
    const std::uintptr_t begin = std::max(first, (first + offset) / kBlock * kBlock);
    const std::uintptr_t end =
        std::min(first + size_, (first + offset + size + kBlock - 1) / kBlock * kBlock);
    if (begin < end) {
      madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
    }
  }

 private:
  static void closeIfOpen(int file) {
    if (file >= 0) {
      close(file);
    }
  }

  void* data_ = nullptr;
  std::uint64_t size_ = 0;
};

}  // namespace cbmv
