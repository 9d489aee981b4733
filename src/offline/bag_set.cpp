#include "offline/bag_set.h"

#include <algorithm>
#include <map>

namespace cbmv {

BagSet::BagSet(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    bags_.push_back(std::make_unique<BagReader>(path));
    for (const BagEntry& entry : bags_.back()->entries()) {
      messages_.push_back({bags_.back().get(), &entry, 0});
    }
  }
  std::stable_sort(
      messages_.begin(), messages_.end(),
      [](const BagMessage& a, const BagMessage& b) { return a.entry->time < b.entry->time; });
  for (std::size_t i = 0; i < messages_.size(); ++i) {
    messages_[i].place = i;
  }
}

std::vector<BagMessage> BagSet::onTopic(const std::string& topic) const {
  std::vector<BagMessage> found;
  std::copy_if(messages_.begin(), messages_.end(), std::back_inserter(found),
               [&](const BagMessage& message) { return message.connection().topic == topic; });
  return found;
}

std::string BagSet::describeTopics() const {
  std::map<std::pair<std::string, std::string>, std::size_t> counts;
  for (const BagMessage& message : messages_) {
    ++counts[{message.connection().topic, message.connection().type}];
  }
  std::string text;
  for (const auto& [topic, count] : counts) {
    text += "  " + topic.first + "  " + topic.second + "  " + std::to_string(count) + "\n";
  }
  return text.empty() ? "  no messages\n" : text;
}

std::string BagSet::typeOf(const std::string& topic) const {
  for (const auto& bag : bags_) {
    for (const auto& connection : bag->connections()) {
      if (connection->topic == topic) {
        return connection->type;
      }
    }
  }
  return {};
}

std::vector<std::string> BagSet::topics() const {
  std::vector<std::string> names;
  for (const auto& bag : bags_) {
    for (const auto& connection : bag->connections()) {
      names.push_back(connection->topic);
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::vector<std::string> BagSet::damages() const {
  std::vector<std::string> messages;
  for (const auto& bag : bags_) {
    if (!bag->damage().empty()) {
      messages.push_back(bag->damage());
    }
  }
  return messages;
}

std::string BagSet::names() const {
  std::string text;
  for (const auto& bag : bags_) {
    text += (text.empty() ? "" : ", ") + bag->path();
  }
  return text;
}

}  // namespace cbmv
