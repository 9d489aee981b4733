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

/// Where a message lies in a bag.
struct BagEntry {
  ros::Time time;                ///< when it was recorded
  ros::Time stamp;               ///< of the header, where the type of the message begins with one
  std::uint32_t connection = 0;  ///< index into BagReader::connections
  std::int32_t chunk = -1;       ///< index of the compressed chunk it lies in; −1: in none
  std::uint64_t offset = 0;      ///< of the bytes: in the chunk once unpacked, or in the file
  std::uint32_t size = 0;        ///< bytes
};

/// Gives bytes that are there; they live until the next call.
using BytesAt = std::function<const std::uint8_t*(std::uint64_t offset, std::uint64_t size)>;

/// Reads a bag of version 2.0, http://wiki.ros.org/Bags/Format/2.0, from its records alone: it
/// needs no index, so it reads what there is of bags that are still being recorded, or were cut
/// off.
class BagReader {
 public:
  /// Looks through the whole bag, on all cores where it is compressed. Throws Error if it cannot be
  /// read, is no such bag, or is encrypted.
  explicit BagReader(const std::string& path);

  const std::string& path() const { return path_; }
  std::uint64_t fileSize() const { return file_.size(); }
  const std::vector<std::shared_ptr<const BagConnection>>& connections() const {
    return connections_;
  }
  /// All messages in the order of their time.
  const std::vector<BagEntry>& entries() const { return entries_; }
  /// One sentence if not all of the bag could be read, or it lacks its index; else empty.
  const std::string& damage() const { return damage_; }

  /// May be called by several threads at once. The bytes live as long as the message. Throws Error
  /// if the chunk cannot be unpacked, or the file has become shorter or cannot be read any more.
  RawMessage read(const BagEntry& entry) const;

 private:
  using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;

  /// A chunk record.
  struct Chunk {
    std::string compression;
    std::uint64_t offset = 0;  ///< of the packed bytes in the file
    std::uint32_t packed_size = 0;
    std::uint32_t size = 0;
  };
  /// What a part of the file holds; connections by the numbers that the file gives them.
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
  void addDamage(const std::string& sentence);

  std::string path_;
  InputFile file_;
  std::vector<Chunk> chunks_;  ///< the compressed ones
  std::vector<std::shared_ptr<const BagConnection>> connections_;
  std::vector<BagEntry> entries_;
  std::string damage_;
  std::vector<Findings> findings_;  ///< while the bag is looked through

  mutable std::mutex cache_mutex_;
  mutable std::list<std::pair<std::int32_t, Bytes>> cache_;  ///< the newest unpacked chunks
};

}  // namespace cbmv
