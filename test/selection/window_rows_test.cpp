#include "selection/window_rows.h"

#include <random>

#include <gtest/gtest.h>

#include "support/selection_reference.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

template <typename Value>
void expectNaiveSums(const cv::Size& size) {
  std::mt19937 random(3);
  cv::Mat map(size, cv::DataType<Value>::type);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      map.at<Value>(y, x) = static_cast<Value>(random());
    }
  }
  onEverySimdTarget([&] {
    WindowRow row;
    row.resize(size.width);
    for (int y = 0; y < size.height; ++y) {
      const std::int32_t* sums = row.sums(map, y);
      for (int x = 0; x < size.width; ++x) {
        ASSERT_EQ(sums[x], naiveSum25(map, y, x)) << "y " << y << " x " << x;
      }
    }
  });
}

TEST(WindowRow, SumsAreThoseOfThePixels) {
  for (const cv::Size size : {cv::Size(1, 1), {2, 3}, {3, 7}, {64, 2}, {67, 9}}) {
    SCOPED_TRACE(testing::Message() << size);
    expectNaiveSums<std::uint8_t>(size);
    expectNaiveSums<std::uint16_t>(size);
    expectNaiveSums<std::int16_t>(size);
  }
}

}  // namespace
}  // namespace cbmv::test
