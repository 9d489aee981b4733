#include "offline/bag_reader.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <string_view>
#include <tuple>

#include <rosbag/chunked_file.h>
#include <rosbag/constants.h>
#include <rosbag/exceptions.h>
#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::size_t kCachedChunks = 8;
constexpr std::uint64_t kWindowBytes = 1 << 16;  // part of the file in memory during the scan
constexpr std::uint32_t kLargestText = 64
                                       << 20;  // limit for a record header or a connection, bytes
constexpr std::uint32_t kStampOffset = 4;      // a header begins with seq
constexpr std::uint32_t kLargestChunk = 1U << 30;  // unpacked bytes; rosbag writes 768 kB
constexpr std::uint64_t kLargestLz4Ratio = 255;    // LZ4 expands a byte to at most this many

template <typename Value>
Value readValue(const std::uint8_t* bytes) {
  Value value;
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

/// Clamps times that ros::Time cannot express to the range that rosbag can write.
ros::Time readTime(const std::uint8_t* bytes) {
  constexpr std::uint64_t second_ns = 1000000000;
  const std::uint64_t time =
      readValue<std::uint32_t>(bytes) * second_ns + readValue<std::uint32_t>(bytes + 4);
  ros::Time clamped;
  clamped.fromNSec(std::min(time, ros::TIME_MAX.toNSec()));
  return std::max(clamped, ros::TIME_MIN);
}

using Fields = std::map<std::string, std::string>;

/// Reads from a file through a window in memory.
BytesAt bytesOf(const InputFile& file) {
  return [&file, window = std::vector<std::uint8_t>(), first = std::uint64_t{0}](
             std::uint64_t offset, std::uint64_t size) mutable {
    if (offset < first || offset + size > first + window.size()) {
      window.resize(std::max(size, std::min(kWindowBytes, file.size() - offset)));
      first = offset;
      file.read(offset, window.data(), window.size());
    }
    return static_cast<const std::uint8_t*>(window.data() + (offset - first));
  };
}

BytesAt bytesOf(const std::vector<std::uint8_t>& memory) {
  return [&memory](std::uint64_t offset, std::uint64_t) { return memory.data() + offset; };
}

/// A completely available record.
struct Record {
  Fields fields;
  std::uint64_t data_offset = 0;
  std::uint32_t data_size = 0;
  std::uint8_t op = 0;

  std::uint64_t end() const { return data_offset + data_size; }
};

bool readFields(const std::uint8_t* data, std::uint32_t data_size, Fields& fields) {
  std::string_view rest(reinterpret_cast<const char*>(data), data_size);
  while (!rest.empty()) {
    if (rest.size() < 4) {
      return false;
    }
    const auto size = readValue<std::uint32_t>(reinterpret_cast<const std::uint8_t*>(rest.data()));
    rest.remove_prefix(4);
    const std::string_view field = rest.substr(0, size);
    const std::size_t delimiter = field.find('=');
    if (size > rest.size() || delimiter == std::string_view::npos) {
      return false;
    }
    fields[std::string(field.substr(0, delimiter))] = field.substr(delimiter + 1);
    rest.remove_prefix(size);
  }
  return true;
}

/// Returns false if there is no complete record between `begin` and `end`.
bool readRecord(const BytesAt& bytes, std::uint64_t begin, std::uint64_t end, Record& record) {
  record.fields.clear();
  record.op = 0;
  if (begin > end || end - begin < 4) {
    return false;
  }
  const auto header_size = readValue<std::uint32_t>(bytes(begin, 4));
  begin += 4;
  if (header_size > kLargestText || end - begin < std::uint64_t{header_size} + 4) {
    return false;
  }
  const std::uint8_t* header = bytes(begin, std::uint64_t{header_size} + 4);
  record.data_size = readValue<std::uint32_t>(header + header_size);
  record.data_offset = begin + header_size + 4;
  if (!readFields(header, header_size, record.fields)) {
    return false;
  }
  const auto op = record.fields.find(rosbag::OP_FIELD_NAME);
  if (op == record.fields.end() || op->second.size() != 1) {
    return false;
  }
  record.op = static_cast<std::uint8_t>(op->second[0]);
  return record.end() <= end &&
         (record.op != rosbag::OP_CONNECTION || record.data_size <= kLargestText);
}

std::string textField(const Fields& fields, const std::string& name) {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string() : found->second;
}

/// The number in a field; 0 if the field is missing.
std::uint32_t numberField(const Record& record, const std::string& name) {
  const auto found = record.fields.find(name);
  return found == record.fields.end() || found->second.size() < 4
             ? 0
             : readValue<std::uint32_t>(
                   reinterpret_cast<const std::uint8_t*>(found->second.data()));
}

std::shared_ptr<const BagConnection> readConnection(const BytesAt& bytes, const Record& record) {
  Fields fields;
  readFields(bytes(record.data_offset, record.data_size), record.data_size, fields);
  auto connection = std::make_shared<BagConnection>();
  connection->header = boost::make_shared<ros::M_string>(fields);
  connection->topic = textField(record.fields, rosbag::TOPIC_FIELD_NAME);
  connection->type = textField(fields, "type");
  connection->md5 = textField(fields, "md5sum");
  connection->definition = textField(fields, "message_definition");
  return connection;
}

}  // namespace

BagReader::BagReader(const std::string& path) : path_(path), file_(path) {
  std::string begin(std::min<std::uint64_t>(kMagic.size(), file_.size()), '\0');
  file_.read(0, reinterpret_cast<std::uint8_t*>(begin.data()), begin.size());
  if (begin != kMagic) {
    throw Error(path +
                " is not a bag of version 2.0, expected a file that begins with '#ROSBAG V2.0'. "
                "Give a ROS 1 bag of version 2.0");
  }
  walkFile();
  walkCompressedChunks();
  collect(std::move(findings_));
  findings_.clear();
}

void BagReader::walkFile() {
  const BytesAt bytes = bytesOf(file_);
  std::uint64_t begin = kMagic.size();
  Record record;
  findings_.resize(1);
  bool indexed = false;
  while (readRecord(bytes, begin, file_.size(), record)) {
    if (record.op == rosbag::OP_FILE_HEADER) {
      if (!textField(record.fields, rosbag::ENCRYPTOR_FIELD_NAME).empty()) {
        throw Error(path_ +
                    " is encrypted, expected a bag without encryption. Decrypt it with `rosbag "
                    "decrypt` on a machine that has the key.");
      }
      indexed = numberField(record, rosbag::INDEX_POS_FIELD_NAME) != 0;
    } else if (record.op == rosbag::OP_CHUNK) {
      const std::string compression = textField(record.fields, rosbag::COMPRESSION_FIELD_NAME);
      if (compression == rosbag::COMPRESSION_NONE) {
        walkRecords(bytes, record.data_offset, record.end(), -1, findings_[0]);
      } else {
        chunks_.push_back({compression, record.data_offset, record.data_size,
                           numberField(record, rosbag::SIZE_FIELD_NAME)});
      }
    } else {
      walkRecords(bytes, begin, record.end(), -1, findings_[0]);
    }
    begin = record.end();
  }
  if (begin != file_.size()) {
    // A truncated uncompressed chunk still has complete messages at its beginning.
    if (record.op == rosbag::OP_CHUNK &&
        textField(record.fields, rosbag::COMPRESSION_FIELD_NAME) == rosbag::COMPRESSION_NONE) {
      walkRecords(bytes, record.data_offset, file_.size(), -1, findings_[0]);
    }
    addDamage("ends, or is unreadable, in the middle of a record at byte " + std::to_string(begin) +
              " of " + std::to_string(file_.size()));
  } else if (!indexed) {
    addDamage("has no index, because the recording was interrupted");
  }
}

void BagReader::walkRecords(const BytesAt& bytes, std::uint64_t begin, std::uint64_t end,
                            std::int32_t chunk, Findings& findings) {
  Record record;
  while (readRecord(bytes, begin, end, record)) {
    const std::uint32_t connection = numberField(record, rosbag::CONNECTION_FIELD_NAME);
    if (record.op == rosbag::OP_CONNECTION) {
      findings.connections[connection] = readConnection(bytes, record);
    } else if (record.op == rosbag::OP_MSG_DATA) {
      BagEntry entry;
      entry.time = entry.stamp = ros::TIME_MIN;
      const std::string& time = record.fields[rosbag::TIME_FIELD_NAME];
      if (time.size() == 8) {
        entry.time = readTime(reinterpret_cast<const std::uint8_t*>(time.data()));
      }
      if (record.data_size >= kStampOffset + 8) {
        entry.stamp = readTime(bytes(record.data_offset + kStampOffset, 8));
      }
      entry.connection = connection;
      entry.chunk = chunk;
      entry.offset = record.data_offset;
      entry.size = record.data_size;
      findings.entries.push_back(entry);
    }
    begin = record.end();
  }
  if (begin != end && findings.damage.empty()) {
    findings.damage = "has a damaged chunk";
  }
}

void BagReader::walkCompressedChunks() {
  findings_.resize(1 + chunks_.size());
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [this](std::size_t i) {
    Findings& findings = findings_[1 + i];
    try {
      const Bytes unpacked = unpack(chunks_[i]);
      walkRecords(bytesOf(*unpacked), 0, unpacked->size(), static_cast<std::int32_t>(i), findings);
    } catch (const Error&) {
      findings.damage = "has a chunk that cannot be unpacked";
    }
  });
}

void BagReader::collect(std::vector<Findings> findings) {
  std::map<std::uint32_t, std::uint32_t> indices;
  for (const Findings& part : findings) {
    for (const auto& [number, connection] : part.connections) {
      if (indices.emplace(number, static_cast<std::uint32_t>(connections_.size())).second) {
        connections_.push_back(connection);
      }
    }
  }
  for (Findings& part : findings) {
    for (BagEntry& entry : part.entries) {
      const auto index = indices.find(entry.connection);
      if (index == indices.end()) {
        part.damage = "has messages without connection record";
        continue;
      }
      entry.connection = index->second;
      entries_.push_back(entry);
    }
    if (!part.damage.empty()) {
      addDamage(part.damage);
    }
  }
  std::stable_sort(entries_.begin(), entries_.end(), [](const BagEntry& a, const BagEntry& b) {
    return std::tie(a.time, a.chunk, a.offset) < std::tie(b.time, b.chunk, b.offset);
  });
}

void BagReader::addDamage(const std::string& message) {
  if (damage_.empty()) {
    damage_ =
        path_ + " " + message + ". The readable part is used. `rosbag reindex` can repair the bag";
  }
}

BagReader::Bytes BagReader::unpack(const Chunk& chunk) const {
  const bool lz4 = chunk.compression == rosbag::COMPRESSION_LZ4;
  if (!lz4 && chunk.compression != rosbag::COMPRESSION_BZ2) {
    throw Error(path_ + " has a chunk with unknown compression '" + chunk.compression +
                "', expected lz4 or bz2. Compress the bag again with `rosbag compress`");
  }
  if (chunk.size > kLargestChunk ||
      (lz4 && chunk.size > kLargestLz4Ratio * (std::uint64_t{chunk.packed_size} + 1))) {
    throw Error(path_ + " has a chunk of " + std::to_string(chunk.packed_size) +
                " bytes with an uncompressed size of " + std::to_string(chunk.size) +
                " bytes, which is not possible. The bag is damaged; copy it again");
  }
  const std::shared_ptr<std::uint8_t> packed = newBytes(chunk.packed_size);
  file_.read(chunk.offset, packed.get(), chunk.packed_size);
  auto bytes = std::make_shared<std::vector<std::uint8_t>>(chunk.size);
  try {
    rosbag::ChunkedFile unpacker;
    unpacker.decompress(lz4 ? rosbag::compression::LZ4 : rosbag::compression::BZ2, bytes->data(),
                        chunk.size, packed.get(), chunk.packed_size);
  } catch (const rosbag::BagException& error) {
    throw Error(path_ + " has a chunk that cannot be unpacked: " + error.what() +
                ". The bag is damaged; copy it again, or try `rosbag reindex`");
  }
  return bytes;
}

BagReader::Bytes BagReader::unpacked(std::int32_t chunk) const {
  {
    const std::lock_guard<std::mutex> lock(cache_mutex_);
    for (const auto& [index, bytes] : cache_) {
      if (index == chunk) {
        return bytes;
      }
    }
  }
  Bytes bytes = unpack(chunks_[static_cast<std::size_t>(chunk)]);
  const std::lock_guard<std::mutex> lock(cache_mutex_);
  cache_.emplace_front(chunk, bytes);
  if (cache_.size() > kCachedChunks) {
    cache_.pop_back();
  }
  return bytes;
}

RawMessage BagReader::read(const BagEntry& entry) const {
  const auto& connection = connections_[entry.connection];
  if (entry.chunk < 0) {
    const std::shared_ptr<std::uint8_t> bytes = newBytes(entry.size);
    file_.read(entry.offset, bytes.get(), entry.size);
    return {connection, bytes, bytes.get(), entry.size};
  }
  const Bytes bytes = unpacked(entry.chunk);
  return {connection, bytes, bytes->data() + entry.offset, entry.size};
}

}  // namespace cbmv
