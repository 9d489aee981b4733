#include "selection/cell_grid.h"

#include <random>

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/selection_reference.h"

namespace cbmv::test {
namespace {

/// Values in the whole range of the type.
template <typename Value>
cv::Mat makeMap(const cv::Size& size, std::uint32_t seed) {
  std::mt19937 random(seed);
  cv::Mat map(size, cv::DataType<Value>::type);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      map.at<Value>(y, x) = static_cast<Value>(random());
    }
  }
  return map;
}

void expectNaiveMeans(const cv::Mat& map, CellGrid& grid) {
  grid.sum(map);
  EXPECT_EQ(grid.rows(), (map.rows + 3) / 4);
  EXPECT_EQ(grid.columns(), (map.cols + 3) / 4);
  for (const int cells : {1, 3, 5, 9, 31}) {
    SCOPED_TRACE(cells);
    cv::Mat means;
    grid.windowMeans(cells, means);
    expectMap<std::int32_t>(means, {grid.columns(), grid.rows()},
                            [&](int y, int x) { return naiveCellMean(map, cells, 4 * y, 4 * x); });
  }
}

/// All types, and sizes that are not multiples of a cell; one object for all.
TEST(CellGrid, MeansAreThoseOfThePixels) {
  CellGrid grid;
  for (const cv::Size size : {cv::Size(1, 1), {3, 2}, {4, 4}, {5, 9}, {43, 1}, {2, 31}, {30, 23}}) {
    SCOPED_TRACE(testing::Message() << size);
    expectNaiveMeans(makeMap<std::uint8_t>(size, 1), grid);
    expectNaiveMeans(makeMap<std::uint16_t>(size, 2), grid);
    expectNaiveMeans(makeMap<std::int16_t>(size, 3), grid);
  }
}

TEST(CellGrid, RoundsNegativeMeansDown) {
  CellGrid grid;
  cv::Mat map(4, 4, CV_16SC1, cv::Scalar(0));
  map.at<std::int16_t>(1, 2) = -1;
  grid.sum(map);
  cv::Mat means;
  grid.windowMeans(1, means);
  EXPECT_EQ(means.at<std::int32_t>(0, 0), -1);
}

/// The sums are the largest that must fit into 32 bits.
TEST(CellGrid, TakesTheHighestValuesInTheLargestWindow) {
  CellGrid grid;
  grid.sum(cv::Mat(20, 30, CV_16UC1, cv::Scalar(65535)));
  cv::Mat means;
  grid.windowMeans(31, means);
  EXPECT_EQ(cv::countNonZero(means != 65535), 0);
}

}  // namespace
}  // namespace cbmv::test
