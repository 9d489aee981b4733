#pragma once

#include <algorithm>
#include <functional>
#include <iterator>
#include <list>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

namespace cbmv {

/// The map type of a JSON object that keeps its keys in insertion order. A key is found by linear
/// search. nlohmann::ordered_json does the same, but nlohmann-json 3.7 (Ubuntu 20.04) does not have
/// it.
template <typename Key, typename Value, typename /*Less*/, typename Allocator>
class OrderedMap : public std::list<std::pair<const Key, Value>, Allocator> {
  using Base = std::list<std::pair<const Key, Value>, Allocator>;

 public:
  using key_type = Key;
  using mapped_type = Value;
  using key_compare = std::equal_to<>;
  using typename Base::const_iterator;
  using typename Base::iterator;
  using typename Base::size_type;

  OrderedMap() = default;
  template <typename Iterator>
  OrderedMap(Iterator first, Iterator last, const Allocator& allocator = Allocator())
      : Base(allocator) {
    for (; first != last; ++first) {
      emplace(first->first, first->second);
    }
  }

  /// If the key exists, its value is kept.
  template <typename K, typename V>
  std::pair<iterator, bool> emplace(K&& key, V&& value) {
    if (const iterator found = find(key); found != this->end()) {
      return {found, false};
    }
    Base::emplace_back(std::forward<K>(key), std::forward<V>(value));
    return {std::prev(this->end()), true};
  }
  std::pair<iterator, bool> insert(const std::pair<const Key, Value>& entry) {
    return emplace(entry.first, entry.second);
  }
  template <typename K>
  Value& operator[](K&& key) {
    return emplace(std::forward<K>(key), Value{}).first->second;
  }
  template <typename K>
  iterator find(const K& key) {
    return findIn(*this, key);
  }
  template <typename K>
  const_iterator find(const K& key) const {
    return findIn(*this, key);
  }
  template <typename K>
  size_type count(const K& key) const {
    return find(key) == this->end() ? 0 : 1;
  }
  template <typename K>
  Value& at(const K& key) {
    return valueIn(*this, key);
  }
  template <typename K>
  const Value& at(const K& key) const {
    return valueIn(*this, key);
  }
  using Base::erase;
  size_type erase(const Key& key) {
    const iterator found = find(key);
    if (found == this->end()) {
      return 0;
    }
    Base::erase(found);
    return 1;
  }

 private:
  template <typename Map, typename K>
  static auto findIn(Map& map, const K& key) {
    return std::find_if(map.begin(), map.end(),
                        [&key](const auto& entry) { return entry.first == key; });
  }
  template <typename Map, typename K>
  static auto& valueIn(Map& map, const K& key) {
    const auto found = map.find(key);
    if (found == map.end()) {
      throw std::out_of_range("missing key");
    }
    return found->second;
  }
};

using OrderedJson = nlohmann::basic_json<OrderedMap>;

}  // namespace cbmv
