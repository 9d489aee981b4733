#include "offline/shard.h"

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <std_msgs/String.h>

#include "forest/forest_file.h"
#include "recording.h"
#include "support/error_text.h"
#include "support/run_tool.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;
using test::expectRejection;

/// Connections in the order of their first message; messages with equal recording time in the order
/// of writing.
struct BagContent {
  std::vector<ros::M_string> headers;
  Content messages;

  bool operator==(const BagContent& other) const {
    return headers == other.headers && messages == other.messages;
  }
};

BagContent contentOf(const std::string& path) {
  const BagReader reader(path);
  EXPECT_EQ(reader.damage(), "");
  BagContent content;
  for (const auto& connection : reader.connections()) {
    content.headers.push_back(*connection->header);
    content.headers.back()["topic"] = connection->topic;
  }
  for (const BagEntry& entry : reader.entries()) {
    const RawMessage message = reader.read(entry);
    content.messages.emplace_back(message.connection->topic, entry.time.toSec(),
                                  std::string(message.data, message.data + message.size));
  }
  EXPECT_TRUE(content.messages.size() == messagesOf(path).size());
  return content;
}

/// Messages of two publishers, one of them latched, before, at, between and after the times of
/// frames.
void writeWords(rosbag::Bag& bag) {
  for (int publisher = 0; publisher < 2; ++publisher) {
    const auto header = boost::make_shared<ros::M_string>(
        ros::M_string{{"type", "std_msgs/String"},
                      {"md5sum", ros::message_traits::md5sum<std_msgs::String>()},
                      {"message_definition", ros::message_traits::definition<std_msgs::String>()},
                      {"callerid", "/publisher" + std::to_string(publisher)},
                      {"latching", std::to_string(publisher)}});
    for (int i = 0; i < 40; ++i) {
      std_msgs::String word;
      word.data = std::to_string(publisher) + " says " + std::to_string(i);
      bag.write("/words", ros::Time(99.92 + 0.05 * i), word, header);
    }
  }
}

class ShardTest : public testing::Test {
 protected:
  std::string shardFile(std::size_t number, std::size_t count) const {
    return folder_.file("shard" + std::to_string(number) + "of" + std::to_string(count) + ".bag");
  }
  BagProcessingSummary processShard(std::size_t number, std::size_t count,
                                    const BagProcessingEvents& events = {}) {
    BagProcessingOptions options = options_;
    options.shard = Shard{number, count};
    options.output = shardFile(number, count);
    return processBags(options, forest_, events);
  }
  /// The last shard is processed first.
  std::vector<std::string> processShards(std::size_t count) {
    std::vector<std::string> paths;
    for (std::size_t number = count; number > 0; --number) {
      processShard(number, count);
      paths.push_back(shardFile(number, count));
    }
    return paths;
  }
  MergeSummary merge(const std::vector<std::string>& shards) {
    return mergeShards({shards, merged_, "none", true});
  }
  std::string mergeError(const std::vector<std::string>& shards) {
    return errorText([&] { merge(shards); });
  }
  BagContent processWhole() {
    processBags(options_, forest_, {});
    return contentOf(options_.output);
  }

  TemporaryFolder folder_;
  std::string input_ = folder_.file("in.bag");
  std::string merged_ = folder_.file("merged.bag");
  BagProcessingOptions options_ = processingOf(input_, folder_.file("out.bag"));
  std::shared_ptr<const Forest> forest_ = fixtureForest();
};

TEST(ParseShard, RejectsWhatDoesNotExist) {
  EXPECT_EQ(parseShard("2/4").number, 2U);
  EXPECT_EQ(parseShard("100000/100000").count, 100000U);
  for (const char* text : {"0/4", "5/4", "1", "1/0", "/4", "-1/4", "1/4 ", "1/999999"}) {
    EXPECT_TRUE(mentions(errorText([&] { parseShard(text); }), {text, "2/4"})) << text;
  }
}

TEST_F(ShardTest, TogetherAreTheWhole) {
  writeRecording(input_, 14, writeWords);
  options_.copy = true;
  options_.outputs = {"disparity", "depth", "confidence"};
  options_.plan.every = 2;
  options_.plan.start_s = 0.13;
  const BagContent whole = processWhole();
  EXPECT_EQ(whole.headers.size(), 4U + 3U + 2U);
  for (const std::size_t count : {1U, 2U, 4U}) {
    const MergeSummary summary = merge(processShards(count));
    EXPECT_EQ(summary.shards, count);
    EXPECT_EQ(summary.frames, 7U);
    EXPECT_TRUE(summary.isComplete());
    EXPECT_TRUE(contentOf(merged_) == whole) << count;
    EXPECT_TRUE(messagesOf(merged_) == messagesOf(options_.output)) << count;
  }
}

TEST_F(ShardTest, CompressionChangesNothing) {
  writeRecording(input_, 6, writeWords);
  options_.copy = true;
  const BagContent whole = processWhole();
  options_.compression = "lz4";
  mergeShards({processShards(3), merged_, "bz2", false});
  EXPECT_TRUE(contentOf(merged_) == whole);
}

/// The recording order of the images differs from the order of their stamps.
TEST_F(ShardTest, TogetherAreTheWholeOfAnUnsortedRecording) {
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  double recorded_s = 99.95;
  for (const int index : {0, 3, 1, 2, 6, 5, 4, 7}) {
    const PairMessages messages = recordedFrame(index);
    const ros::Time time(recorded_s);
    recorded_s += 0.1;
    bag.write("/stereo/left/image_rect", time, messages.left_image);
    bag.write("/stereo/right/image_rect", time, messages.right_image);
    bag.write("/stereo/left/camera_info", time, messages.left_info);
    bag.write("/stereo/right/camera_info", time, messages.right_info);
  }
  writeWords(bag);
  bag.close();
  options_.copy = true;
  const BagContent whole = processWhole();
  merge(processShards(3));
  EXPECT_TRUE(contentOf(merged_) == whole);
}

/// The rows are shifted differently from frame to frame, so the result shows which pair provides
/// the offset.
TEST_F(ShardTest, VerticalOffsetDoesNotDependOnTheShard) {
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  for (int index = 0; index < 6; ++index) {
    StereoPair pair = renderPair({320, 240}, 5, 11, static_cast<std::uint64_t>(index) + 1);
    pair.right = pair.right(cv::Rect(0, 2 + index % 2, 320, 236)).clone();
    pair.left = pair.left(cv::Rect(0, 0, 320, 236)).clone();
    writeFrame(bag, makeMessages(pair, Rig{}, ros::Time(100 + 0.3 * index)));
  }
  bag.close();
  const BagContent whole = processWhole();
  merge(processShards(4));
  EXPECT_TRUE(contentOf(merged_) == whole);
  options_.matching.stereo.rectification.interval_s = 0;
  options_.earlier = EarlierParts::kOverwrite;
  EXPECT_FALSE(processWhole() == whole) << "nothing depends on offsets";
}

TEST_F(ShardTest, MayBeMoreThanFrames) {
  writeRecording(input_, 2, writeWords);
  options_.copy = true;
  const BagContent whole = processWhole();
  merge(processShards(5));
  EXPECT_TRUE(contentOf(merged_) == whole);
  options_.plan.start_s = 1000;
  EXPECT_TRUE(mentions(errorText([&] { processShard(1, 2); }), {"no pair", "no shards"}));
}

TEST_F(ShardTest, LargeFramesCountMore) {
  writeRecording(input_, 8, [](rosbag::Bag& bag) {
    for (int index = 8; index < 10; ++index) {
      writeFrame(bag, recordedFrame(index, {192, 128}));
    }
  });
  processShard(1, 2);
  processShard(2, 2);
  EXPECT_EQ(readShardLabel(shardFile(1, 2)).end, 8U);
  const ShardLabel second = readShardLabel(shardFile(2, 2));
  EXPECT_EQ(second.first, 8U);
  EXPECT_EQ(second.end, 10U);
}

TEST_F(ShardTest, StopsAndResumes) {
  writeRecording(input_, 9, writeWords);
  options_.copy = true;
  const BagContent whole = processWhole();
  int asked = 0;
  BagProcessingEvents events;
  events.should_stop = [&] { return ++asked > 2; };
  EXPECT_TRUE(processShard(2, 2, events).interrupted);
  options_.earlier = EarlierParts::kResume;
  const BagProcessingSummary resumed = processShard(2, 2);
  EXPECT_EQ(resumed.resumed, 2U);
  EXPECT_EQ(resumed.processed, 2U);
  processShard(1, 2);
  merge({shardFile(1, 2), shardFile(2, 2)});
  EXPECT_TRUE(contentOf(merged_) == whole);
}

TEST_F(ShardTest, ResumeRejectsPartsOfAnotherShard) {
  writeRecording(input_, 9);
  BagProcessingEvents events;
  events.should_stop = [] { return true; };
  processShard(1, 2, events);
  options_.earlier = EarlierParts::kResume;
  options_.shard = Shard{2, 2};
  options_.output = shardFile(1, 2);
  EXPECT_TRUE(mentions(errorText([&] { processBags(options_, forest_, {}); }), {"--overwrite"}));
}

TEST_F(ShardTest, FailedFramesAreCounted) {
  writeRecordingWithABadFrame(input_);
  const BagContent whole = processWhole();
  const MergeSummary summary = merge(processShards(2));
  EXPECT_EQ(summary.failed, 1U);
  EXPECT_FALSE(summary.isComplete());
  EXPECT_TRUE(contentOf(merged_) == whole);
}

TEST_F(ShardTest, MergeNamesWhatIsMissingOrThereTwice) {
  writeRecording(input_, 6);
  processShards(3);
  processShard(1, 2);
  const std::string first = shardFile(1, 3);
  const std::string second = shardFile(2, 3);
  const std::string third = shardFile(3, 3);
  EXPECT_TRUE(mentions(mergeError({second, third}), {"shard 1/3 is missing"}));
  EXPECT_TRUE(mentions(mergeError({third, first}), {"shard 2/3 is missing", "from 2 on"}));
  EXPECT_TRUE(mentions(mergeError({first, second}), {"shard 3/3 is missing", "from 4 on"}));
  EXPECT_TRUE(mentions(mergeError({first, second, second}), {second, "both shard 2/3"}));
  EXPECT_TRUE(
      mentions(mergeError({first, shardFile(1, 2), third}), {"shard 1/2", "shard 1/3", "overlap"}));
  EXPECT_FALSE(fs::exists(merged_));
}

TEST_F(ShardTest, MergeRejectsOtherSettingsAndRecordings) {
  writeRecording(input_, 4);
  processShard(1, 2);
  const auto rejects_second = [&](BagProcessingOptions changed) {
    changed.shard = Shard{2, 2};
    changed.output = shardFile(2, 2);
    changed.earlier = EarlierParts::kOverwrite;
    processBags(changed, forest_, {});
    EXPECT_TRUE(mentions(mergeError({shardFile(1, 2), shardFile(2, 2)}),
                         {"different input bags or settings", shardFile(2, 2)}));
  };
  BagProcessingOptions changed = options_;
  changed.matching.stereo.sgm.p2 += 1;
  rejects_second(changed);
  changed = options_;
  changed.copy = true;
  rejects_second(changed);
  changed = options_;
  changed.outputs = {"depth"};
  rejects_second(changed);
  fs::create_directory(folder_.file("other"));
  changed = options_;
  changed.inputs = {writeRecording(folder_.file("other/in.bag"), 5)};
  rejects_second(changed);

  changed.inputs = {writeRecording(folder_.file("other/in.bag"), 4)};  // simulates another machine
  changed.shard = Shard{2, 2};
  changed.output = shardFile(2, 2);
  changed.earlier = EarlierParts::kOverwrite;
  changed.matching.stereo.threads = 1;
  processBags(changed, forest_, {});
  EXPECT_EQ(merge({shardFile(1, 2), shardFile(2, 2)}).frames, 4U);
}

TEST_F(ShardTest, MergeRejectsWhatIsNoShardOrDamaged) {
  writeRecording(input_, 8);
  processShards(2);
  const std::string second = shardFile(2, 2);
  EXPECT_TRUE(
      mentions(mergeError({shardFile(1, 2), input_}), {"in.bag", "not the bag of a shard"}));
  EXPECT_TRUE(mentions(errorText([&] {
                         mergeShards({{shardFile(1, 2), second}, input_, "none", false});
                       }),
                       {"in.bag exists", "--overwrite"}));
  fs::resize_file(second, fs::file_size(second) / 2);
  EXPECT_TRUE(mentions(mergeError({shardFile(1, 2), second}), {second}));
  EXPECT_FALSE(fs::exists(merged_));
  EXPECT_FALSE(fs::exists(merged_ + ".merge.writing"));
}

/// Runs the program as scripts/cluster does.
TEST_F(ShardTest, ProgramsOfFourShardsDoTheWorkOfOne) {
  writeForest(makeForestFixture(), folder_.file("fixture.forest"));
  writeRecording(input_, 10, writeWords);
  const std::string settings = " --copy --disparities 16 --forest " +
                               folder_.file("fixture.forest") + " --write disparity,cloud ";
  const auto run = [&](const std::string& arguments) {
    return test::run("cbmv_bag", arguments + settings);
  };
  const auto process = [&](const std::string& shard, const std::string& output) {
    return run(input_ + " --shard " + shard + " --output " + output);
  };
  ASSERT_EQ(run(input_ + " --output " + options_.output).status, 0);
  std::string shards;
  for (const std::string number : {"1", "2", "3", "4"}) {
    const std::string shard = folder_.file(number + ".bag");
    EXPECT_EQ(process(number + "/4", shard).status, 0);
    shards.append(shard).append(" ");
  }
  const auto merge_by = [&](const std::string& arguments) {
    return test::run("cbmv_bag", "merge " + arguments + " --output " + merged_);
  };
  expectRejection(merge_by(folder_.file("1.bag")), {"cbmv_bag:", "shard 2/4 is missing"});
  EXPECT_EQ(merge_by(shards + "--compression lz4").status, 0);
  EXPECT_TRUE(contentOf(merged_) == contentOf(options_.output));
  expectRejection(merge_by(shards), {"merged.bag exists"});
  expectRejection(process("5/4", merged_), {"'5/4'"});
}

}  // namespace
}  // namespace cbmv
