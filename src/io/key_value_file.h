#pragma once

#include <map>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// A small text file of lines `key SEPARATOR value`, blanks anywhere around key and value; other
/// lines are skipped. Its errors name the file and the key.
class KeyValueFile {
 public:
  /// Throws Error when the file cannot be opened.
  KeyValueFile(const std::string& path, char separator);

  bool has(const std::string& key) const { return values_.count(key) > 0; }

  /// A number above 0. Throws Error.
  double positive(const std::string& key) const;

  /// A whole number above 0. Throws Error.
  int positiveInteger(const std::string& key) const;

  /// The numbers of a value, without brackets and semicolons; none when it holds anything else.
  /// Throws Error when the key is missing.
  std::vector<double> numbers(const std::string& key) const;

  /// [f 0 cx; 0 f cy; 0 0 1] with f above 0. Throws Error.
  cv::Matx33d cameraMatrix(const std::string& key) const;

  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  std::string path_;
  std::map<std::string, std::string> values_;
};

}  // namespace cbmv
