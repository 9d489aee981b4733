#include "cbmv_stereo/io/calibration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <limits>
#include <locale>
#include <map>
#include <sstream>
#include <vector>

#include "binary_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr std::uintmax_t kLargestFile = 1 << 20;

/// The `key=value` lines of one file, and what to say about those that are not as they should be.
class KeyValueFile {
 public:
  explicit KeyValueFile(const std::string& path) : path_(path) {
    std::ifstream in = openForReading(path, kLargestFile);
    std::string line;
    while (std::getline(in, line)) {
      const std::size_t equals = line.find('=');
      if (equals != std::string::npos) {
        values_[trimmed(line.substr(0, equals))] = line.substr(equals + 1);
      }
    }
  }

  bool has(const std::string& key) const { return values_.count(key) > 0; }

  double positive(const std::string& key) const {
    const std::vector<double> read = numbers(key);
    if (read.size() != 1 || !(read[0] > 0.0)) {
      fail(key, "must be one number above 0");
    }
    return read[0];
  }

  int positiveInteger(const std::string& key) const {
    const double read = positive(key);
    if (read != std::floor(read) || read > std::numeric_limits<int>::max()) {
      fail(key, "must be a whole number");
    }
    return static_cast<int>(read);
  }

  /// [f 0 cx; 0 f cy; 0 0 1], row by row.
  std::vector<double> cameraMatrix(const std::string& key) const {
    std::vector<double> read = numbers(key);
    if (read.size() != 9 || !(read[0] > 0.0)) {
      fail(key, "must be a camera matrix [f 0 cx; 0 f cy; 0 0 1] with f above 0");
    }
    return read;
  }

 private:
  static std::string trimmed(const std::string& text) {
    const char* const blanks = " \t\r";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string::npos) {
      return "";
    }
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
  }

  /// The numbers of a value, without brackets and semicolons; none when it holds anything else.
  std::vector<double> numbers(const std::string& key) const {
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

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw Error("Cannot read " + path_ + ": key " + key + " " + what + ".");
  }

  std::string path_;
  std::map<std::string, std::string> values_;
};

}  // namespace

StereoCalibration readMiddleburyCalibration(const std::string& path, int default_disparities) {
  const KeyValueFile file(path);
  const std::vector<double> left = file.cameraMatrix("cam0");
  const std::vector<double> right = file.cameraMatrix("cam1");
  StereoCalibration calibration;
  calibration.focal_length_px = left[0];
  calibration.cx_left = left[2];
  calibration.cx_right = right[2];
  calibration.cy = left[5];
  calibration.baseline_m = file.positive("baseline") / 1000.0;
  calibration.width = file.positiveInteger("width");
  calibration.height = file.positiveInteger("height");
  calibration.disparities = default_disparities > 0 && !file.has("ndisp")
                                ? std::min(default_disparities, calibration.width)
                                : file.positiveInteger("ndisp");
  return calibration;
}

void writeMiddleburyCalibration(const std::string& path, const StereoCalibration& calibration) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(12);
  const auto write_matrix = [&](const char* key, double cx) {
    const double f = calibration.focal_length_px;
    text << key << "=[" << f << " 0 " << cx << "; 0 " << f << ' ' << calibration.cy << "; 0 0 1]\n";
  };
  write_matrix("cam0", calibration.cx_left);
  write_matrix("cam1", calibration.cx_right);
  text << "doffs=" << calibration.doffs() << "\nbaseline=" << calibration.baseline_m * 1000.0
       << "\nwidth=" << calibration.width << "\nheight=" << calibration.height
       << "\nndisp=" << calibration.disparities << '\n';
  writeFile(path, text.str());
}

}  // namespace cbmv
