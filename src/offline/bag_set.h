#pragma once

#include <memory>
#include <string>
#include <vector>

#include "offline/bag_reader.h"

namespace cbmv {

/// One message of several bags.
struct BagMessage {
  const BagReader* bag = nullptr;
  const BagEntry* entry = nullptr;
  std::size_t place = 0;  ///< index among the messages of all bags, by recording time

  const BagConnection& connection() const { return *bag->connections()[entry->connection]; }
  RawMessage read() const { return bag->read(*entry); }
};

/// Several bags read as one, for example a split recording.
class BagSet {
 public:
  /// Throws Error if a bag cannot be read.
  explicit BagSet(const std::vector<std::string>& paths);

  /// All messages, sorted by recording time.
  const std::vector<BagMessage>& messages() const { return messages_; }
  /// The messages of a topic, sorted by recording time.
  std::vector<BagMessage> onTopic(const std::string& topic) const;
  /// Topics with types and numbers of messages, one per line, for messages to the user.
  std::string describeTopics() const;
  /// Type of a topic; empty if the topic does not exist.
  std::string typeOf(const std::string& topic) const;
  std::vector<std::string> topics() const;
  /// One message per damaged bag.
  std::vector<std::string> damages() const;
  const std::vector<std::unique_ptr<BagReader>>& bags() const { return bags_; }
  /// Names of the bags, for messages to the user.
  std::string names() const;

 private:
  std::vector<std::unique_ptr<BagReader>> bags_;
  std::vector<BagMessage> messages_;
};

}  // namespace cbmv
