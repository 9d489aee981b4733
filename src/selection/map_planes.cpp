#include "selection/map_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <tbb/parallel_for.h>

#ifndef CBMV_MAP_PLANES_ONCE
#define CBMV_MAP_PLANES_ONCE
namespace cbmv {
namespace {

constexpr int kUnmatchedCode = 250;
constexpr int kRoughnessPerUnit = 8;
constexpr int kHighestStep = 31;  ///< in units of the disparity plane
/// 4094 px. Leaves room for disparities near this one.
constexpr float kHighestUnits = INT16_MAX - kPlaneUnitsPerPx;

/// One row of the maps and of the planes.
struct PlaneRow {
  int width;
  float right_invalid;
  const float* disparity;
  const float* disparity_below;
  const float* right_disparity;  ///< null: unknown
  const std::uint8_t* labels;
  const float* probability;
  const std::uint16_t* margin_in;
  std::uint8_t* unmatched;
  std::uint8_t* probability_out;
  std::uint16_t* margin;
  std::uint8_t* roughness;
  std::int16_t* plane;
  std::uint8_t* left_right;
};

}  // namespace
}  // namespace cbmv
#endif

// Plain loops, which the compiler vectorizes for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "selection/map_planes.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "selection/code_lines-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

/// Adds one half and truncates, because this is vectorizable, unlike std::lround.
HWY_INLINE std::int32_t roundUpHalves(float value) {
  const float moved = value + 0.5F;
  return static_cast<std::int32_t>(moved);
}

HWY_INLINE std::int32_t planeUnits(float disparity) {
  const float units = std::min(disparity * kPlaneUnitsPerPx, kHighestUnits);
  return units < 0 ? -roundUpHalves(-units) : roundUpHalves(units);
}

/// Disparity differences between each pixel and its right and lower neighbors.
void fillRoughness(const float* HWY_RESTRICT disparity, const float* HWY_RESTRICT below, int width,
                   std::uint8_t* HWY_RESTRICT roughness) {
  const auto fill = [=](int x, int right) HWY_ATTR {
    const float step =
        std::abs(disparity[right] - disparity[x]) + std::abs(below[x] - disparity[x]);
    const auto units = static_cast<std::int32_t>(
        std::min(step * kPlaneUnitsPerPx, static_cast<float>(kHighestStep)));
    roughness[x] = static_cast<std::uint8_t>(units * kRoughnessPerUnit);
  };
  for (int x = 0; x + 1 < width; ++x) {
    fill(x, x + 1);
  }
  fill(width - 1, width - 1);
}

void fillLeftRight(const float* HWY_RESTRICT disparity, const float* HWY_RESTRICT right,
                   float right_invalid, int width, std::uint8_t* HWY_RESTRICT left_right) {
  for (int x = 0; x < width; ++x) {
    left_right[x] = static_cast<std::uint8_t>(leftRightUnits(disparity[x] * kPlaneUnitsPerPx,
                                                             matchOf(x, planeUnits(disparity[x])),
                                                             right, right_invalid, width - 1));
  }
}

void fillUnmatched(const std::uint8_t* HWY_RESTRICT labels, int width,
                   std::uint8_t* HWY_RESTRICT unmatched) {
  for (int x = 0; x < width; ++x) {
    unmatched[x] = static_cast<std::uint8_t>(labels[x] != 0 ? kUnmatchedCode : 0);
  }
}

void fillProbability(const float* HWY_RESTRICT probability, int width,
                     std::uint8_t* HWY_RESTRICT bytes) {
  for (int x = 0; x < width; ++x) {
    bytes[x] = static_cast<std::uint8_t>(roundUpHalves(probability[x] * 255.0F));
  }
}

void fillMargin(const std::uint16_t* HWY_RESTRICT margin, int width,
                std::uint16_t* HWY_RESTRICT limited) {
  for (int x = 0; x < width; ++x) {
    limited[x] = std::min<std::uint16_t>(margin[x], kHighestMargin);
  }
}

void fillDisparity(const float* HWY_RESTRICT disparity, int width,
                   std::int16_t* HWY_RESTRICT units) {
  for (int x = 0; x < width; ++x) {
    units[x] = static_cast<std::int16_t>(planeUnits(disparity[x]));
  }
}

void fillPlanes(const PlaneRow& row) {
  fillUnmatched(row.labels, row.width, row.unmatched);
  fillProbability(row.probability, row.width, row.probability_out);
  fillMargin(row.margin_in, row.width, row.margin);
  fillDisparity(row.disparity, row.width, row.plane);
  fillRoughness(row.disparity, row.disparity_below, row.width, row.roughness);
  if (row.right_disparity == nullptr) {
    std::fill_n(row.left_right, row.width, std::uint8_t{kUnknownDifference});
  } else {
    fillLeftRight(row.disparity, row.right_disparity, row.right_invalid, row.width, row.left_right);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(fillPlanes);

}  // namespace

void MapPlanes::prepare(const JudgedMaps& maps) {
  const cv::Size size = maps.disparity.size();
  CV_Assert(maps.disparity.type() == CV_32FC1 && maps.probability.type() == CV_32FC1);
  CV_Assert(maps.labels.type() == CV_8UC1 && maps.margin.type() == CV_16UC1);
  CV_Assert(maps.labels.size() == size && maps.probability.size() == size);
  CV_Assert(maps.margin.size() == size);
  CV_Assert(maps.right_disparity.empty() ||
            (maps.right_disparity.size() == size && maps.right_disparity.type() == CV_32FC1));
  for (cv::Mat* plane : {&unmatched, &probability, &roughness, &left_right}) {
    plane->create(size, CV_8UC1);
  }
  margin.create(size, CV_16UC1);
  disparity.create(size, CV_16SC1);
  no_disparity = static_cast<int>(maps.range.invalid()) * kPlaneUnitsPerPx;
  tbb::parallel_for(0, size.height, [&](int y) { fillRow(maps, y); });
  sumWindows();
}

void MapPlanes::fillRow(const JudgedMaps& maps, int y) {
  const int below = std::min(y + 1, maps.disparity.rows - 1);
  const PlaneRow row{
      maps.disparity.cols,
      maps.range.invalid(),
      maps.disparity.ptr<float>(y),
      maps.disparity.ptr<float>(below),
      maps.right_disparity.empty() ? nullptr : maps.right_disparity.ptr<float>(y),
      maps.labels.ptr<std::uint8_t>(y),
      maps.probability.ptr<float>(y),
      maps.margin.ptr<std::uint16_t>(y),
      unmatched.ptr<std::uint8_t>(y),
      probability.ptr<std::uint8_t>(y),
      margin.ptr<std::uint16_t>(y),
      roughness.ptr<std::uint8_t>(y),
      disparity.ptr<std::int16_t>(y),
      left_right.ptr<std::uint8_t>(y),
  };
  HWY_DYNAMIC_DISPATCH(fillPlanes)(row);
}

void MapPlanes::sumWindows() {
  const auto sum = [&](const cv::Mat& plane, cv::Mat Windows::*means) {
    grid_.sum(plane);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      grid_.windowMeans(kWindowCells[i], windows[i].*means);
    }
  };
  sum(unmatched, &Windows::unmatched);
  sum(probability, &Windows::probability);
  sum(margin, &Windows::margin);
  sum(roughness, &Windows::roughness);
  sum(disparity, &Windows::disparity);
}

}  // namespace cbmv
#endif  // HWY_ONCE
