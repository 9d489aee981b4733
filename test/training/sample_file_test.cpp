#include "training/sample_file.h"

#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "confidence/feature_names.h"
#include "support/checkerboard_samples.h"
#include "support/temporary_folder.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

TEST(SampleFile, HoldsAllSamplesExactly) {
  const TemporaryFolder folder;
  const Samples samples = checkerboard(50);
  writeSamples(samples, folder.file("samples.csv"));
  std::ifstream file(folder.file("samples.csv"));
  std::string line;
  std::getline(file, line);
  std::string head;
  for (const char* name : kFeatureNames) {
    head += std::string(name) + ",";
  }
  EXPECT_EQ(line, head + "label,held_out");
  for (long n = 0; n < samples.count(); ++n) {
    ASSERT_TRUE(std::getline(file, line));
    std::istringstream cells(line);
    std::string cell;
    for (const std::vector<float>& column : samples.features) {
      std::getline(cells, cell, ',');
      EXPECT_EQ(std::stof(cell), column[n]);
    }
    std::getline(cells, cell);
    EXPECT_EQ(cell, std::to_string(samples.labels[n]) + "," + std::to_string(samples.held_out[n]));
  }
  EXPECT_FALSE(std::getline(file, line));
}

TEST(SampleFile, NamesAFileThatCannotBeWritten) {
  EXPECT_THROW(writeSamples(checkerboard(1), "/nowhere/at/all.csv"), Error);
}

}  // namespace
}  // namespace cbmv::test
