#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace cbmv {

/// A YAML file that holds a map. Its errors name the file and the key.
class YamlFile {
 public:
  /// Skips a byte order mark and OpenCV's first line, %YAML:1.0, which is no YAML. `content` is
  /// what the file should be, for messages. Throws Error when the file cannot be read or is no map.
  YamlFile(const std::string& path, const std::string& content);

  bool has(const char* key) const { return root_[key].IsDefined(); }

  /// Throws Error.
  int wholeNumber(const char* key) const;

  /// Empty where there is none.
  std::string text(const char* key) const { return root_[key].as<std::string>(""); }

  /// The list that the key holds, or that lies under the key as `data`. Throws Error.
  std::vector<double> numbers(const char* key) const;

  /// The same of a length that is known. Throws Error.
  template <std::size_t count>
  std::array<double, count> numbers(const char* key) const {
    const std::vector<double> list = numbers(key);
    if (list.size() != count) {
      fail(key, "must hold " + std::to_string(count) + " numbers");
    }
    std::array<double, count> array{};
    std::copy(list.begin(), list.end(), array.begin());
    return array;
  }

  /// The map of whole numbers under a key; 0 for what it does not have. Throws Error.
  int wholeNumberIn(const char* map, const char* key) const;

  [[noreturn]] void fail(const char* key, const std::string& what) const;

 private:
  std::string path_;
  YAML::Node root_;
};

}  // namespace cbmv
