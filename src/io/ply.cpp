#include "io/ply.h"

#include "io/binary_file.h"

namespace cbmv {

void writePly(const std::string& path, const std::vector<ColoredPoint>& points) {
  std::string content = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                        std::to_string(points.size()) +
                        "\nproperty float x\nproperty float y\nproperty float z\n"
                        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                        "end_header\n";
  constexpr std::size_t bytes_per_point = 15;
  content.reserve(content.size() + bytes_per_point * points.size());
  for (const ColoredPoint& point : points) {
    for (const float coordinate : {point.x, point.y, point.z}) {
      appendLittleEndian(coordinate, content);
    }
    for (const std::uint8_t component : {point.r, point.g, point.b}) {
      content.push_back(static_cast<char>(component));
    }
  }
  writeFile(path, content);
}

}  // namespace cbmv
