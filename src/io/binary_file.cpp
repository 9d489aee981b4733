#include "io/binary_file.h"

#include <array>
#include <filesystem>
#include <locale>

#include "cbmv_stereo/error.h"

namespace cbmv {

std::ifstream openForReading(const std::string& path, std::uintmax_t largest) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw Error("Cannot read " + path + ": no such file. Check the path.");
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    throw Error("Cannot read " + path + ": it is not a regular file. Give the path of a file.");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > largest) {
    throw Error("Cannot read " + path + ": it has " + std::to_string(size) +
                " bytes, expected at most " + std::to_string(largest) +
                ". Check that it is the right file.");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    throw Error("Cannot read " + path + ": it cannot be opened. Check its permissions.");
  }
  in.imbue(std::locale::classic());
  return in;
}

std::ifstream openText(const std::string& path, std::uintmax_t largest) {
  std::ifstream in = openForReading(path, largest);
  std::array<char, 3> begin{};
  in.read(begin.data(), begin.size());
  if (!in || begin != std::array<char, 3>{'\xEF', '\xBB', '\xBF'}) {
    in.clear();
    in.seekg(0);
  }
  return in;
}

std::vector<std::uint8_t> readBytes(const std::string& path, std::uintmax_t largest) {
  std::ifstream in = openForReading(path, largest);
  std::vector<std::uint8_t> bytes(std::filesystem::file_size(path));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

void makeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) {
    throw Error("Cannot create the folder " + path + ": " + error.message() +
                ". Check that its parent is writable.");
  }
}

void writeFile(const std::string& path, const std::string& content) {
  std::ofstream out(path, std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (!out) {
    throw Error("Cannot write " + path +
                ". Check that the folder exists, is writable and has free space.");
  }
}

void replaceFile(const std::string& path, const std::string& content) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, error);
  if (error || (std::filesystem::exists(target, error) &&
                !std::filesystem::is_regular_file(target, error))) {
    writeFile(path, content);  // a device or pipe is written to, never replaced
    return;
  }
  const std::string part = target.string() + ".part";
  writeFile(part, content);
  std::filesystem::rename(part, target, error);
  if (error) {
    throw Error("Cannot write " + path + ": it cannot be replaced (" + error.message() +
                "). Check that the folder is writable.");
  }
}

}  // namespace cbmv
