#include "io/pfm.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "io/binary_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr long long kMaxSide = 65535;

struct PfmHeader {
  int width;
  int height;
  bool little_endian;

  std::uintmax_t bytesOfValues() const {
    return std::uintmax_t{4} * static_cast<std::uintmax_t>(width) *
           static_cast<std::uintmax_t>(height);
  }
};

void skipComments(std::ifstream& in) {
  while ((in >> std::ws).peek() == '#') {
    in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
}

/// Reads up to the end of the scale.
PfmHeader readHeader(std::ifstream& in, const std::string& path) {
  std::array<char, 2> magic{};
  in.read(magic.data(), magic.size());
  if (!in || magic[0] != 'P' || magic[1] != 'f') {
    throw Error(
        "Cannot read " + path +
        ": it is not a gray PFM file, expected a file that begins with \"Pf\". Convert it.");
  }
  long long width = 0;
  long long height = 0;
  double scale = 0.0;
  skipComments(in);
  in >> width;
  skipComments(in);
  in >> height;
  skipComments(in);
  in >> scale;
  if (!in || scale == 0.0) {
    throw Error("Cannot read " + path +
                ": its header is invalid, expected width, height and a scale other than 0 after "
                "\"Pf\". Write the file again.");
  }
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    throw Error("Cannot read " + path + ": its header has " + std::to_string(width) + "x" +
                std::to_string(height) +
                " pixels, expected sides from 1 to 65535. Write the file again.");
  }
  return {static_cast<int>(width), static_cast<int>(height), scale < 0.0};
}

/// Reads up to the first value. One white-space character ends the header. Some files have more,
/// for example Windows line ends or trailing blanks. The first values may look like white space, so
/// the size of the file decides.
void skipHeaderEnd(std::ifstream& in, const std::string& path, std::uintmax_t bytes_of_values) {
  const std::uintmax_t file_bytes = std::filesystem::file_size(path);
  const auto behind = [&in] { return static_cast<std::uintmax_t>(in.tellg()); };
  in.get();
  while (behind() + bytes_of_values < file_bytes && std::isspace(in.peek()) != 0) {
    in.get();
  }
}

void checkFileSize(const std::string& path, const PfmHeader& header, std::uintmax_t header_bytes) {
  const std::uintmax_t expected = header_bytes + header.bytesOfValues();
  const std::uintmax_t actual = std::filesystem::file_size(path);
  if (actual != expected) {
    throw Error("Cannot read " + path + ": it has " + std::to_string(actual) + " bytes, expected " +
                std::to_string(expected) + " for a " + std::to_string(header.width) + "x" +
                std::to_string(header.height) + " map. Write or copy the file again.");
  }
}

}  // namespace

bool isPfmName(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".pfm";
}

cv::Mat readPfm(const std::string& path) {
  std::ifstream in = openForReading(path);
  const PfmHeader header = readHeader(in, path);
  skipHeaderEnd(in, path, header.bytesOfValues());
  checkFileSize(path, header, static_cast<std::uintmax_t>(in.tellg()));
  cv::Mat map(header.height, header.width, CV_32FC1);
  std::vector<std::uint8_t> bytes(std::size_t{4} * static_cast<std::size_t>(header.width));
  for (int y = header.height - 1; y >= 0; --y) {
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    for (int x = 0; x < header.width; ++x) {
      map.at<float>(y, x) = floatFromBytes(&bytes[std::size_t{4} * x], header.little_endian);
    }
  }
  if (!in) {
    throw Error("Cannot read " + path + ": its values cannot be read. Copy the file again.");
  }
  return map;
}

void writePfm(const std::string& path, const cv::Mat& map) {
  CV_Assert(map.type() == CV_32FC1);
  std::string content =
      "Pf\n" + std::to_string(map.cols) + " " + std::to_string(map.rows) + "\n-1.0\n";
  content.reserve(content.size() + 4 * map.total());
  for (int y = map.rows - 1; y >= 0; --y) {
    for (int x = 0; x < map.cols; ++x) {
      appendLittleEndian(map.at<float>(y, x), content);
    }
  }
  writeFile(path, content);
}

}  // namespace cbmv
