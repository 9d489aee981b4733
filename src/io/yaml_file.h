#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace cbmv {

/// A YAML file that contains a map. Errors name the file and the key.
class YamlFile {
 public:
  /// Skips a byte order mark and OpenCV's first line, %YAML:1.0, which is not valid YAML. `content`
  /// is the expected kind of file, for messages. Throws Error if the file cannot be read or is not
  /// a map.
  YamlFile(const std::string& path, const std::string& content);

  bool has(const char* key) const { return root_[key].IsDefined(); }

  /// Throws Error if the key has no integer.
  int wholeNumber(const char* key) const;

  /// Empty if the key is missing.
  std::string text(const char* key) const { return root_[key].as<std::string>(""); }

  /// Returns the list at the key, or the list `data` in the map at the key. Throws Error.
  std::vector<double> numbers(const char* key) const;

  /// The same for a list of fixed length. Throws Error.
  template <std::size_t count>
  std::array<double, count> numbers(const char* key) const {
    const std::vector<double> list = numbers(key);
    if (list.size() != count) {
      fail(key, "does not have " + std::to_string(count) + " numbers");
    }
    std::array<double, count> array{};
    std::copy(list.begin(), list.end(), array.begin());
    return array;
  }

  /// Returns an integer of the map at a key, or 0 if the map does not have it. Throws Error.
  int wholeNumberIn(const char* map, const char* key) const;

  [[noreturn]] void fail(const char* key, const std::string& what) const;

 private:
  std::string path_;
  YAML::Node root_;
};

}  // namespace cbmv
