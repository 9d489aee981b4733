// Compares docs/parameters.md with the code.

#include <sstream>

#include <gtest/gtest.h>

#include "support/file_content.h"

#include "cbmv_stereo/parameters.h"

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
  const std::string document = contentOf(CBMV_SOURCE_DIR "/docs/parameters.md");
  for (const Parameter& parameter : stereoParameters()) {
    const std::string row = tableRow(parameter);
    EXPECT_NE(document.find(row + "\n"), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace cbmv::test
