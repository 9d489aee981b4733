#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <ros/time.h>

#include "offline/input_file.h"
#include "offline/raw_message.h"

namespace cbmv {

/// Position of a message in a bag.
struct BagEntry {
  ros::Time time;                ///< recording time
  ros::Time stamp;               ///< header stamp, if the message type begins with a header
  std::uint32_t connection = 0;  ///< index into BagReader::connections
  std::int32_t chunk = -1;       ///< index of its compressed chunk; −1: not in a compressed chunk
  std::uint64_t offset = 0;      ///< position in the unpacked chunk or in the file, bytes
  std::uint32_t size = 0;        ///< bytes
};

/// Returns a pointer to existing bytes, valid until the next call.
using BytesAt = std::function<const std::uint8_t*(std::uint64_t offset, std::uint64_t size)>;

/// Reads a bag of version 2.0, http://wiki.ros.org/Bags/Format/2.0. It scans the records and needs
/// no index, so it also reads the intact part of bags that are still being recorded or are
/// truncated.
class BagReader {
 public:
  /// Scans the whole bag, on all cores if it is compressed. Throws Error if it cannot be read, is
  /// not a bag of version 2.0, or is encrypted.
  explicit BagReader(const std::string& path);

  const std::string& path() const { return path_; }
  std::uint64_t fileSize() const { return file_.size(); }
  const std::vector<std::shared_ptr<const BagConnection>>& connections() const {
    return connections_;
  }
  /// All messages, sorted by recording time.
  const std::vector<BagEntry>& entries() const { return entries_; }
  /// A message if a part of the bag could not be read or its index is missing; else empty.
  const std::string& damage() const { return damage_; }

  /// Thread-safe. The bytes live as long as the returned message. Throws Error if the chunk cannot
  /// be unpacked, or if the file is truncated or unreadable since it was opened.
  RawMessage read(const BagEntry& entry) const;

 private:
  using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;

  /// A chunk record.
  struct Chunk {
    std::string compression;
    std::uint64_t offset = 0;  ///< of the compressed bytes in the file
    std::uint32_t packed_size = 0;
    std::uint32_t size = 0;
  };
  /// Content of a part of the file; connections by their number in the file.
  struct Findings {
    std::map<std::uint32_t, std::shared_ptr<const BagConnection>> connections;
    std::vector<BagEntry> entries;
    std::string damage;
  };

  void walkFile();
  static void walkRecords(const BytesAt& bytes, std::uint64_t begin, std::uint64_t end,
                          std::int32_t chunk, Findings& findings);
  void walkCompressedChunks();
  void collect(std::vector<Findings> findings);
  Bytes unpack(const Chunk& chunk) const;
  Bytes unpacked(std::int32_t chunk) const;
  void addDamage(const std::string& message);

  std::string path_;
  InputFile file_;
  std::vector<Chunk> chunks_;  ///< compressed chunks only
  std::vector<std::shared_ptr<const BagConnection>> connections_;
  std::vector<BagEntry> entries_;
  std::string damage_;
  std::vector<Findings> findings_;  ///< used during the scan only

  mutable std::mutex cache_mutex_;
  mutable std::list<std::pair<std::int32_t, Bytes>> cache_;  ///< the most recently unpacked chunks
};

}  // namespace cbmv
