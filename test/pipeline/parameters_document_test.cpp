// docs/parameters.md says what the code does.

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "cbmv_stereo/pipeline/parameters.h"

namespace cbmv::test {
namespace {

std::string text(const ParameterValue& value) {
  std::ostringstream out;
  out << std::boolalpha;
  std::visit([&](const auto& v) { out << v; }, value);
  return out.str();
}

std::string tableRow(const Parameter& parameter) {
  std::ostringstream row;
  row << "| `" << parameter.name << "` | " << text(parameter.default_value);
  if (std::holds_alternative<bool>(parameter.default_value)) {
    row << " | ";
  } else {
    row << " | " << parameter.lowest << " to " << parameter.highest;
  }
  row << " | " << parameter.unit << " | " << parameter.description << " |";
  return row.str();
}

TEST(ParametersDocument, HasARowForEachParameter) {
  std::ostringstream document;
  document << std::ifstream(CBMV_SOURCE_DIR "/docs/parameters.md").rdbuf();
  for (const Parameter& parameter : stereoParameters()) {
    const std::string row = tableRow(parameter);
    EXPECT_NE(document.str().find(row + "\n"), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace cbmv::test
