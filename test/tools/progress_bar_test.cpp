#include "tools/progress_bar.h"

#include <array>
#include <cstdio>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cbmv::test {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

/// Output of a progress bar, with a clock controlled by the test.
class ProgressBarTest : public testing::Test {
 protected:
  ProgressBarTest() : file_(std::tmpfile()) {}
  ~ProgressBarTest() override { std::fclose(file_); }

  ProgressBar bar(bool terminal) {
    return {file_, terminal, [this] { return seconds_; }};
  }

  std::string written() const {
    std::rewind(file_);
    std::string text;
    std::array<char, 256> part{};
    while (std::fgets(part.data(), part.size(), file_) != nullptr) {
      text += part.data();
    }
    return text;
  }

  std::FILE* file_;
  double seconds_ = 100;
};

TEST_F(ProgressBarTest, WritesPlainLinesToAFile) {
  {
    ProgressBar bar = this->bar(false);
    bar.show("sampling", 1, 2, "sampled One");
    bar.show("sampling", 2, 2, "");
    bar.show("boosting", 1, 1, "tree 1");
  }
  EXPECT_EQ(written(), "sampled One\ntree 1\n");
}

TEST_F(ProgressBarTest, RedrawsOneLineWithRateAndTimeLeft) {
  {
    ProgressBar bar = this->bar(true);
    bar.show("sampling", 1, 30, "not shown");
    seconds_ += 10;
    bar.show("sampling", 6, 30, "");  // five steps in ten seconds
    EXPECT_EQ(written(),
              "\rsampling [#                             ] 1/30\x1b[K"
              "\rsampling [######                        ] 6/30, 0.5/s, 0:48 left\x1b[K");
    seconds_ += 1e4;
    bar.show("sampling", 7, 30, "");
    EXPECT_THAT(written(), EndsWith("7/30, 0.000599/s, 10:39:32 left\x1b[K"));
  }
  EXPECT_THAT(written(), EndsWith("left\x1b[K\n"));
}

TEST_F(ProgressBarTest, EachPhaseHasALineAndAClockOfItsOwn) {
  ProgressBar bar = this->bar(true);
  bar.show("one", 1, 2, "");
  bar.show("two", 1, 3, "");
  seconds_ += 2;
  bar.show("two", 2, 3, "");
  bar.show("two", 3, 3, "");
  const std::string text = written();
  EXPECT_THAT(text, HasSubstr("1/2\x1b[K\n\rtwo [##########"));
  EXPECT_THAT(text, HasSubstr("2/3, 0.5/s, 0:02 left"));
  EXPECT_THAT(text, EndsWith("[##############################] 3/3, 1/s, 0:00 left\x1b[K\n"));
}

TEST_F(ProgressBarTest, AFileIsNoTerminal) { EXPECT_FALSE(isTerminal(file_)); }

}  // namespace
}  // namespace cbmv::test
