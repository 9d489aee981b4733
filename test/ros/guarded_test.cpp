#include "ros/guarded.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

TEST(Guarded, CallsBackAndLetsNothingThrough) {
  int calls = 0;
  guarded("name", [&calls] { ++calls; });
  EXPECT_NO_THROW(guarded("name", [&calls] {
    ++calls;
    throw std::runtime_error("a cause");
  }));
  EXPECT_EQ(calls, 2);
}

TEST(StartNodelet, StopsWhatCannotStartAndThrowsOn) {
  int stops = 0;
  const auto stop = [&stops] { ++stops; };
  startNodelet(
      "name", [] {}, stop);
  EXPECT_EQ(stops, 0);
  EXPECT_THROW(startNodelet(
                   "name", [] { throw std::runtime_error("a cause"); }, stop),
               std::runtime_error);
  EXPECT_EQ(stops, 1);
}

}  // namespace
}  // namespace cbmv
