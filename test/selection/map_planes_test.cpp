#include "selection/map_planes.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "refinement/left_right_check.h"
#include "support/judged_maps.h"
#include "support/selection_reference.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

/// Roughness from the differences to the adjacent pixels; outside the border there are none.
int naiveRoughness(const cv::Mat& disparity, int y, int x) {
  const auto at = [&](int row, int column) -> double {
    return disparity.at<float>(std::min(row, disparity.rows - 1),
                               std::min(column, disparity.cols - 1));
  };
  const double step = std::fabs(at(y, x + 1) - at(y, x)) + std::fabs(at(y + 1, x) - at(y, x));
  return 8 * roundDown(std::fmin(31, 8 * step));
}

void expectNaivePlanes(const RandomMaps& maps, const MapPlanes& planes) {
  const cv::Size size = maps.disparity.size();
  const auto disparity = [&](int y, int x) {
    return static_cast<int>(std::lround(8.0 * maps.disparity.at<float>(y, x)));
  };
  expectMap<std::int16_t>(planes.disparity, size, disparity);
  expectMap<std::uint8_t>(planes.unmatched, size, [&](int y, int x) {
    return maps.labels.at<std::uint8_t>(y, x) == kMatch ? 0 : 250;
  });
  expectMap<std::uint8_t>(planes.probability, size, [&](int y, int x) {
    return std::lround(255.0 * maps.probability.at<float>(y, x) + 1e-6);
  });
  expectMap<std::uint16_t>(planes.margin, size, [&](int y, int x) {
    return std::min<int>(maps.margin.at<std::uint16_t>(y, x), 2160);
  });
  expectMap<std::uint8_t>(planes.roughness, size,
                          [&](int y, int x) { return naiveRoughness(maps.disparity, y, x); });
  expectMap<std::uint8_t>(planes.left_right, size, [&](int y, int x) {
    const int match = x - roundDown((disparity(y, x) + 4) / 8.0);
    return naiveLeftRight(maps.disparity.at<float>(y, x), match, maps.right_disparity,
                          maps.range.invalid(), y);
  });
}

void expectNaiveWindows(const MapPlanes& planes) {
  for (std::size_t i = 0; i < kWindowCells.size(); ++i) {
    SCOPED_TRACE(kWindowCells[i]);
    const MapPlanes::Windows& windows = planes.windows[i];
    const auto expect_means = [&](const cv::Mat& means, const cv::Mat& plane) {
      expectMap<std::int32_t>(
          means, {(plane.cols + 3) / 4, (plane.rows + 3) / 4},
          [&](int y, int x) { return naiveCellMean(plane, kWindowCells[i], 4 * y, 4 * x); });
    };
    expect_means(windows.unmatched, planes.unmatched);
    expect_means(windows.probability, planes.probability);
    expect_means(windows.margin, planes.margin);
    expect_means(windows.roughness, planes.roughness);
    expect_means(windows.disparity, planes.disparity);
  }
}

class Planes : public testing::TestWithParam<Case> {
 protected:
  RandomMaps maps_ = makeJudgedMaps(std::get<0>(GetParam()), std::get<2>(GetParam()), 5);
};

TEST_P(Planes, AreWhatTheMapsSay) {
  onEverySimdTarget([&] {
    MapPlanes planes;
    planes.prepare(maps_.judged());
    expectNaivePlanes(maps_, planes);
    expectNaiveWindows(planes);
  });
}

TEST_P(Planes, KnowNoDifferenceWithoutTheRightView) {
  maps_.right_disparity.release();
  MapPlanes planes;
  planes.prepare(maps_.judged());
  EXPECT_EQ(cv::countNonZero(planes.left_right != 255), 0);
  expectNaivePlanes(maps_, planes);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Planes,
                         testing::Combine(testing::ValuesIn(awkwardShapes()),
                                          testing::Values(View::kLeft),
                                          testing::Values(Content::kNoise, Content::kPatches)));

/// Values above the range of 16 bits are clamped.
TEST(MapPlanes, CutDisparitiesOff) {
  RandomMaps maps = makeJudgedMaps({6, 9, {2048, 4096}}, Content::kNoise, 6);
  MapPlanes planes;
  planes.prepare(maps.judged());
  expectMap<std::int16_t>(planes.disparity, maps.disparity.size(), [&](int y, int x) {
    return std::min(32759L, std::lround(8.0 * maps.disparity.at<float>(y, x)));
  });
}

TEST(MapPlanes, KeepNothingOfThePairBefore) {
  MapPlanes planes;
  for (const Shape& shape : awkwardShapes()) {
    const RandomMaps maps = makeJudgedMaps(shape, Content::kNoise, 7);
    planes.prepare(maps.judged());
    expectNaivePlanes(maps, planes);
    expectNaiveWindows(planes);
  }
}

}  // namespace
}  // namespace cbmv::test
