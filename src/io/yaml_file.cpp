#include "io/yaml_file.h"

#include <cstdint>
#include <iterator>

#include "io/binary_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr std::uintmax_t kLargestFile = 1 << 20;

}  // namespace

YamlFile::YamlFile(const std::string& path, const std::string& content) : path_(path) {
  std::ifstream in = openText(path, kLargestFile);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (text.rfind("%YAML:", 0) == 0) {
    text.erase(0, text.find('\n'));
  }
  try {
    root_ = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw Error("Cannot read " + path + ": it is not valid YAML: " + error.what() +
                ". Correct the file.");
  }
  if (!root_.IsMap()) {
    throw Error("Cannot read " + path + ": it is not a " + content +
                ". Give the path of such a file.");
  }
}

int YamlFile::wholeNumber(const char* key) const {
  try {
    return root_[key].as<int>();
  } catch (const YAML::Exception&) {
    fail(key, "is not a whole number");
  }
}

std::vector<double> YamlFile::numbers(const char* key) const {
  try {
    const YAML::Node node = root_[key];
    return (node.IsMap() ? node["data"] : node).as<std::vector<double>>();
  } catch (const YAML::Exception&) {
    fail(key, "is not a list of numbers");
  }
}

int YamlFile::wholeNumberIn(const char* map, const char* key) const {
  try {
    return has(map) && root_[map][key].IsDefined() ? root_[map][key].as<int>() : 0;
  } catch (const YAML::Exception&) {
    fail(map, std::string("has no whole number ") + key);
  }
}

void YamlFile::fail(const char* key, const std::string& what) const {
  throw Error("Cannot read " + path_ + ": key " + key + " " + what + ". Correct the file.");
}

}  // namespace cbmv
