#include "io/key_value_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <locale>
#include <sstream>

#include "io/binary_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr std::uintmax_t kLargestFile = 1 << 20;

std::string trimmed(const std::string& text) {
  const char* const blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string::npos) {
    return "";
  }
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

}  // namespace

KeyValueFile::KeyValueFile(const std::string& path, char separator) : path_(path) {
  std::ifstream in = openText(path, kLargestFile);
  std::string line;
  while (std::getline(in, line)) {
    const std::size_t end = line.find(separator);
    if (end != std::string::npos) {
      values_[trimmed(line.substr(0, end))] = line.substr(end + 1);
    }
  }
}

double KeyValueFile::positive(const std::string& key) const {
  const std::vector<double> read = numbers(key);
  if (read.size() != 1 || !(read[0] > 0.0)) {
    fail(key, "is not a number above 0");
  }
  return read[0];
}

int KeyValueFile::positiveInteger(const std::string& key) const {
  const double read = positive(key);
  if (read != std::floor(read) || read > std::numeric_limits<int>::max()) {
    fail(key, "is not a whole number");
  }
  return static_cast<int>(read);
}

std::vector<double> KeyValueFile::numbers(const std::string& key) const {
  const auto found = values_.find(key);
  if (found == values_.end()) {
    fail(key, "is missing");
  }
  std::string text = found->second;
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '[' || c == ']' || c == ';'; }, ' ');
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  std::vector<double> read;
  for (double number = 0.0; in >> number;) {
    read.push_back(number);
  }
  return in.eof() ? read : std::vector<double>();
}

cv::Matx33d KeyValueFile::cameraMatrix(const std::string& key) const {
  const std::vector<double> read = numbers(key);
  if (read.size() != 9 || !(read[0] > 0.0)) {
    fail(key, "is not a camera matrix [f 0 cx; 0 f cy; 0 0 1] with f above 0");
  }
  return cv::Matx33d(read.data());
}

void KeyValueFile::fail(const std::string& key, const std::string& what) const {
  throw Error("Cannot read " + path_ + ": key " + key + " " + what + ". Correct the file.");
}

}  // namespace cbmv
