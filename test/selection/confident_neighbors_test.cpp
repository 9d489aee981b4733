#include "selection/confident_neighbors.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "support/judged_maps.h"
#include "support/selection_reference.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

cv::Mat makePlane(const cv::Size& size) {
  cv::Mat plane(size, CV_16SC1);
  cv::randu(plane, -30000, 30000);
  return plane;
}

void expectSame(const NeighborRow& row, int x, const NaiveNeighbor& expected,
                const char* direction) {
  ASSERT_EQ(row.disparity[x], expected.disparity) << direction << " of x " << x;
  ASSERT_EQ(row.distance[x], expected.distance) << direction << " of x " << x;
}

void expectNaiveNeighbors(const cv::Mat& disparity, const cv::Mat& confidence,
                          ConfidentNeighbors& neighbors) {
  neighbors.find(disparity, confidence);
  ConfidentNeighbors::RowMemory memory;
  memory.resize(disparity.cols);
  for (int y = 0; y < disparity.rows; ++y) {
    SCOPED_TRACE(testing::Message() << "y " << y);
    neighbors.findOnRow(y, memory);
    const NeighborRow left{memory.left.data(), memory.left_distance.data()};
    const NeighborRow right{memory.right.data(), memory.right_distance.data()};
    for (int x = 0; x < disparity.cols; ++x) {
      const auto naive = naiveProposals(disparity, confidence, y, x);
      expectSame(left, x, naive[static_cast<int>(Source::kLeft)], "left");
      expectSame(right, x, naive[static_cast<int>(Source::kRight)], "right");
      expectSame(neighbors.above(y), x, naive[static_cast<int>(Source::kAbove)], "above");
      expectSame(neighbors.below(y), x, naive[static_cast<int>(Source::kBelow)], "below");
    }
  }
}

TEST(ConfidentNeighbors, AreTheNearestOnes) {
  onEverySimdTarget([] {
    ConfidentNeighbors neighbors;
    for (const Shape& shape : awkwardShapes()) {
      SCOPED_TRACE(testing::Message() << shape);
      for (const Content content : {Content::kNoise, Content::kPatches}) {
        expectNaiveNeighbors(makePlane(shape.size()), makeConfidence(shape.size(), content, 3),
                             neighbors);
      }
    }
  });
}

/// Wider than the columns of a task, with one neighbor at a distance that exceeds a byte.
TEST(ConfidentNeighbors, AreFoundFarAway) {
  for (const cv::Size size : {cv::Size(600, 3), {3, 600}}) {
    cv::Mat confidence(size, CV_8UC1, cv::Scalar(ConfidentNeighbors::kConfident - 1));
    confidence.at<std::uint8_t>(0, 0) = ConfidentNeighbors::kConfident;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
    ConfidentNeighbors neighbors;
    expectNaiveNeighbors(makePlane(size), confidence, neighbors);
  }
}

TEST(ConfidentNeighbors, AreNotThereWithoutConfidentPixels) {
  ConfidentNeighbors neighbors;
  const cv::Size size(20, 5);
  neighbors.find(makePlane(size), cv::Mat::zeros(size, CV_8UC1));
  EXPECT_EQ(neighbors.above(4).disparity[7], ConfidentNeighbors::kNoNeighbor);
  EXPECT_EQ(neighbors.below(0).distance[7], 255);
  expectNaiveNeighbors(makePlane(size), cv::Mat::zeros(size, CV_8UC1), neighbors);
}

}  // namespace
}  // namespace cbmv::test
