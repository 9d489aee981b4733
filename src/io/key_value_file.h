#pragma once

#include <map>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// A small text file with lines `key SEPARATOR value`. Blanks are allowed around key and value.
/// Other lines are ignored. Errors name the file and the key.
class KeyValueFile {
 public:
  /// Throws Error if the file cannot be opened.
  KeyValueFile(const std::string& path, char separator);

  bool has(const std::string& key) const { return values_.count(key) > 0; }

  /// Returns a number above 0. Throws Error otherwise.
  double positive(const std::string& key) const;

  /// Returns an integer above 0. Throws Error otherwise.
  int positiveInteger(const std::string& key) const;

  /// Returns the numbers of a value without brackets and semicolons. Empty if it has other content.
  /// Throws Error if the key is missing.
  std::vector<double> numbers(const std::string& key) const;

  /// Returns a matrix [f 0 cx; 0 f cy; 0 0 1] with f > 0. Throws Error otherwise.
  cv::Matx33d cameraMatrix(const std::string& key) const;

  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  std::string path_;
  std::map<std::string, std::string> values_;
};

}  // namespace cbmv
