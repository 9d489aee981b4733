#include "offline/bag_reader.h"

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "recording.h"
#include "support/error_text.h"
#include "support/file_content.h"

namespace cbmv {
namespace {

Content contentByReader(const std::string& path) {
  const BagReader reader(path);
  Content content;
  for (const BagEntry& entry : reader.entries()) {
    const RawMessage raw = reader.read(entry);
    content.emplace_back(raw.connection->topic, entry.time.toSec(),
                         std::string(raw.data, raw.data + raw.size));
  }
  return content;
}

void sortContent(Content& content) { std::sort(content.begin(), content.end()); }

class BagReaderTest : public testing::TestWithParam<rosbag::CompressionType> {
 protected:
  TemporaryFolder folder_;
  std::string path_ = writeRecording(folder_.file("in.bag"), 5, nullptr, GetParam());
};

TEST_P(BagReaderTest, ReadsWhatRosbagReads) {
  Content expected = messagesOf(path_);
  Content content = contentByReader(path_);
  ASSERT_EQ(content.size(), 20U);
  sortContent(expected);
  sortContent(content);
  EXPECT_TRUE(content == expected);
  EXPECT_EQ(BagReader(path_).damage(), "");
}

TEST_P(BagReaderTest, KnowsStampsAndTypes) {
  const BagReader reader(path_);
  for (const BagEntry& entry : reader.entries()) {
    EXPECT_NEAR((entry.time - entry.stamp).toSec(), 0.02, 1e-9);
  }
  ASSERT_EQ(reader.connections().size(), 4U);
  for (const auto& connection : reader.connections()) {
    EXPECT_THAT(connection->type, testing::StartsWith("sensor_msgs/"));
    EXPECT_EQ(connection->md5.size(), 32U);
    EXPECT_FALSE(connection->definition.empty());
  }
}

/// However much is cut off, the messages read are those of the bag in its order. A longer rest
/// yields at least as many messages.
TEST_P(BagReaderTest, ReadsTheBeginningOfTruncatedBags) {
  const Content whole = contentByReader(path_);
  const std::string bytes = contentOf(path_);
  std::size_t known = 0;
  for (std::size_t size = 4200; size < bytes.size(); size += 1777) {
    const std::string cut = folder_.write("cut.bag", bytes.substr(0, size));
    const Content content = contentByReader(cut);
    EXPECT_GE(content.size(), known) << size;
    known = content.size();
    ASSERT_LE(content.size(), whole.size());
    EXPECT_TRUE(std::equal(content.begin(), content.end(), whole.begin())) << size;
    EXPECT_NE(BagReader(cut).damage(), "") << size;
  }
  EXPECT_EQ(known, whole.size());
}

/// Happens if another process rewrites the file or a disk fails.
TEST_P(BagReaderTest, NamesAFileThatBecomesShorter) {
  const BagReader reader(path_);
  std::filesystem::resize_file(path_, 8000);
  std::size_t missing = 0;
  for (const BagEntry& entry : reader.entries()) {
    const std::string error = errorText([&] { reader.read(entry); });
    if (error != "no error") {
      ++missing;
      EXPECT_THAT(error, testing::HasSubstr("in.bag was truncated"));
    }
  }
  EXPECT_GE(missing, 10U);
}

INSTANTIATE_TEST_SUITE_P(Compression, BagReaderTest,
                         testing::Values(rosbag::compression::Uncompressed,
                                         rosbag::compression::LZ4, rosbag::compression::BZ2));

/// A bag that is still being recorded: the data that rosbag has written before it closes the bag.
TEST(BagReader, ReadsBagsThatAreStillBeingRecorded) {
  const TemporaryFolder folder;
  const std::string active = folder.file("in.bag.active");
  rosbag::Bag bag(active, rosbag::bagmode::Write);
  bag.setChunkThreshold(20000);
  for (int frame = 0; frame < 5; ++frame) {
    writeFrame(bag, recordedFrame(frame));
  }
  const BagReader reader(active);
  EXPECT_GE(reader.entries().size(), 12U);
  EXPECT_THAT(reader.damage(), testing::HasSubstr("in.bag.active"));
  EXPECT_THAT(reader.damage(), testing::HasSubstr("rosbag reindex"));
}

TEST(BagReader, RejectsWhatIsNoBag) {
  const TemporaryFolder folder;
  for (const char* content : {"", "#ROSBAG V1.2\nabc", "P5 3 4"}) {
    const std::string path = folder.write("no.bag", content);
    EXPECT_THAT(errorText([&] { BagReader{path}; }), testing::HasSubstr("no.bag is not a bag"));
  }
  EXPECT_THAT(errorText([&] { BagReader{folder.file("none.bag")}; }),
              testing::HasSubstr("none.bag: No such file"));
  EXPECT_THAT(errorText([] { BagReader{"/dev/null"}; }),
              testing::HasSubstr("/dev/null: it is not a regular file"));
  EXPECT_THAT(errorText([] { BagReader{"/"}; }),
              testing::HasSubstr("read /: it is not a regular file"));
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // without a writer
  EXPECT_THAT(errorText([&] { BagReader{pipe}; }),
              testing::HasSubstr("pipe: it is not a regular file"));
}

TEST(BagReader, NamesADamagedChunk) {
  const TemporaryFolder folder;
  const std::string path =
      writeRecording(folder.file("in.bag"), 5, nullptr, rosbag::compression::BZ2);
  std::string bytes = contentOf(path);
  const std::size_t packed = bytes.find("BZh");
  ASSERT_NE(packed, std::string::npos);
  bytes.replace(packed + 40, 8, "damaged!");
  const BagReader reader(folder.write("damaged.bag", bytes));
  EXPECT_THAT(reader.damage(), testing::HasSubstr("cannot be unpacked"));
  EXPECT_GE(reader.entries().size(), 1U);
}

TEST(BagReader, TakesNoMemoryForWhatAChunkClaims) {
  const TemporaryFolder folder;
  for (const auto compression : {rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    std::string bytes = contentOf(writeRecording(folder.file("in.bag"), 5, nullptr, compression));
    for (std::size_t place = 0; (place = bytes.find("size=", place)) != std::string::npos;) {
      place += 5;
      bytes.replace(place, 4, "\xff\xff\xff\xff");
    }
    const BagReader reader(folder.write("hostile.bag", bytes));
    EXPECT_THAT(reader.damage(), testing::HasSubstr("cannot be unpacked"));
    EXPECT_TRUE(reader.entries().empty());
  }
}

/// Peak memory of this process.
long peakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

/// Less than the limit of a chunk, but more than LZ4 can produce from these bytes.
TEST(BagReader, TakesNoMemoryForWhatLz4CannotMean) {
  const TemporaryFolder folder;
  std::string bytes =
      contentOf(writeRecording(folder.file("in.bag"), 5, nullptr, rosbag::compression::LZ4));
  for (std::size_t place = 0; (place = bytes.find("size=", place)) != std::string::npos;) {
    place += 5;
    bytes.replace(place, 4, std::string("\0\0\0\x40", 4));
  }
  const std::string path = folder.write("hostile.bag", bytes);
  const long before_mb = peakMemoryMb();
  EXPECT_TRUE(BagReader(path).entries().empty());
  EXPECT_LT(peakMemoryMb() - before_mb, 500);
}

/// rosbag accepts no time before TIME_MIN, and ROS none after TIME_MAX.
TEST(BagReader, BringsTimesIntoTheRangeOfRos) {
  const TemporaryFolder folder;
  std::string bytes = contentOf(writeRecording(folder.file("in.bag"), 2));
  const std::size_t first = bytes.find("time=") + 5;
  bytes.replace(first, 8, std::string(8, '\xff'));
  const std::size_t second = bytes.find("time=", first) + 5;
  bytes.replace(second, 8, std::string(8, '\0'));
  const BagReader reader(folder.write("hostile.bag", bytes));
  EXPECT_EQ(reader.entries().front().time, ros::TIME_MIN);
  EXPECT_EQ(reader.entries().back().time, ros::TIME_MAX);
}

std::string numberBytes(std::uint32_t number) {
  return {reinterpret_cast<const char*>(&number), sizeof(number)};
}

/// The bytes preceded by their number, as strings in a bag.
std::string sized(const std::string& bytes) {
  return numberBytes(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

/// A record with fields such as "op=x".
std::string recordOf(const std::vector<std::string>& fields, const std::string& data) {
  std::string header;
  for (const std::string& field : fields) {
    header += sized(field);
  }
  return sized(header) + sized(data);
}

const std::string kBagBegin = "#ROSBAG V2.0\n";
const std::string kOpHeader = "op=\x03";
const std::string kOpChunk = "op=\x05";
const std::string kOpConnection = "op=\x07";
const std::string kOpMessage = "op=\x02";
const std::string kNumberZero = "conn=" + numberBytes(0);
const std::string kConnection =
    recordOf({kOpConnection, kNumberZero, "topic=/t"}, sized("type=std_msgs/String"));

/// Result of reading a bag with these records.
struct Outcome {
  explicit Outcome(const std::string& records, std::uint64_t size = 0) {
    const TemporaryFolder folder;
    const std::string path = folder.write("made.bag", kBagBegin + records);
    if (size > 0) {
      std::filesystem::resize_file(path, kBagBegin.size() + size);
    }
    const BagReader reader(path);
    damage = reader.damage();
    connections = reader.connections().size();
    entries = reader.entries();
  }
  std::string damage;
  std::size_t connections = 0;
  std::vector<BagEntry> entries;
};

TEST(BagReader, ReadsMessagesWithoutTimeAndStamp) {
  const Outcome outcome(kConnection + recordOf({kOpMessage, kNumberZero, "time=abc"}, "12"));
  ASSERT_EQ(outcome.entries.size(), 1U);
  EXPECT_EQ(outcome.entries[0].time, ros::TIME_MIN);
  EXPECT_EQ(outcome.entries[0].stamp, ros::TIME_MIN);
  EXPECT_EQ(outcome.entries[0].size, 2U);
}

/// A number field that is too short is read as 0. Bytes behind it are not read.
TEST(BagReader, TakesNumbersThatAreCutOffForZero) {
  const Outcome outcome(recordOf({kOpConnection, "conn=\x05", "topic=/t"}, "") +
                        recordOf({kOpMessage, kNumberZero}, ""));
  EXPECT_EQ(outcome.entries.size(), 1U);
}

TEST(BagReader, LeavesOutMessagesWithoutConnection) {
  const Outcome outcome(kConnection + recordOf({kOpMessage, "conn=" + numberBytes(1)}, "") +
                        recordOf({kOpMessage, kNumberZero}, ""));
  EXPECT_EQ(outcome.connections, 1U);
  ASSERT_EQ(outcome.entries.size(), 1U);
  EXPECT_EQ(outcome.entries[0].connection, 0U);
}

/// The field length exceeds the header.
TEST(BagReader, ReadsNoFieldBehindItsHeader) {
  const std::string op = sized(kOpConnection);
  for (const std::string& rest :
       {numberBytes(0xffffffff) + "a=b", numberBytes(4) + "a=b", std::string("abc")}) {
    EXPECT_EQ(Outcome(sized(op + rest) + sized("")).connections, 0U) << rest;
  }
  EXPECT_EQ(Outcome(sized(op + sized("a=b")) + sized("")).connections, 1U);
}

/// A sparse file: it has the claimed length, and the missing data are zero.
TEST(BagReader, RejectsTextsOfMoreThan64MiB) {
  constexpr std::uint32_t most = 64 << 20;
  for (const std::uint32_t size : {most, most + 1}) {
    const std::string op = sized(kOpConnection);
    const auto rest = static_cast<std::uint32_t>(size - op.size() - 4);
    const Outcome header(numberBytes(size) + op + numberBytes(rest) + "x=", 4 + size + 4);
    EXPECT_EQ(header.connections, size > most ? 0U : 1U);
    const std::string connection = sized(op);
    const Outcome text(connection + numberBytes(size), connection.size() + 4 + size);
    EXPECT_EQ(text.connections, size > most ? 0U : 1U);
  }
}

TEST(BagReader, ReadsWholeMessagesOfAChunkThatIsCutOff) {
  const std::string message = recordOf({kOpMessage, kNumberZero}, "12");
  const std::string chunk =
      recordOf({kOpChunk, "compression=none"}, kConnection + message + message);
  EXPECT_EQ(Outcome(chunk).entries.size(), 2U);
  EXPECT_EQ(Outcome(chunk.substr(0, chunk.size() - 1)).entries.size(), 1U);
}

TEST(BagReader, NamesEncryptedBags) {
  const std::string begin = recordOf({kOpHeader, "encryptor=rosbag/AesCbcEncryptor"}, "");
  EXPECT_THAT(errorText([&] { Outcome{begin}; }), testing::HasSubstr("is encrypted"));
}

}  // namespace
}  // namespace cbmv
