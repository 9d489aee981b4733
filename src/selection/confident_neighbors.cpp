#include "selection/confident_neighbors.h"

#include <algorithm>
#include <cstddef>

#include <tbb/parallel_for.h>

#ifndef CBMV_CONFIDENT_NEIGHBORS_ONCE
#define CBMV_CONFIDENT_NEIGHBORS_ONCE
namespace cbmv {
namespace {

constexpr int kColumnsPerTask = 64;

/// Some columns of a row, with the nearest neighbors in the previous row and in this row.
struct Step {
  const std::int16_t* disparity;
  const std::uint8_t* confidence;
  const std::int16_t* nearest_before;
  const std::uint8_t* distance_before;
  std::int16_t* nearest;
  std::uint8_t* distance;
  int count;
};

}  // namespace
}  // namespace cbmv
#endif

// Plain loops, which the compiler vectorizes for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "selection/confident_neighbors.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

void advance(const Step& step) {
  for (int x = 0; x < step.count; ++x) {
    const bool is_confident = step.confidence[x] >= ConfidentNeighbors::kConfident;
    const std::uint8_t before = step.distance_before[x];
    step.nearest[x] = is_confident ? step.disparity[x] : step.nearest_before[x];
    step.distance[x] =
        is_confident ? std::uint8_t{0} : static_cast<std::uint8_t>(before + (before < 255 ? 1 : 0));
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(advance);

/// Processes all rows from row `first` on in steps of `step` (1 or −1), for the columns
/// [x, x + count).
void advanceColumns(const cv::Mat& disparity, const cv::Mat& confidence, int first, int step, int x,
                    int count, cv::Mat& nearest, cv::Mat& distance) {
  alignas(64) std::int16_t none[kColumnsPerTask];
  alignas(64) std::uint8_t far[kColumnsPerTask];
  std::fill_n(none, kColumnsPerTask, ConfidentNeighbors::kNoNeighbor);
  std::fill_n(far, kColumnsPerTask, std::uint8_t{255});
  const std::int16_t* nearest_before = none;
  const std::uint8_t* distance_before = far;
  for (int i = 0, y = first; i < disparity.rows; ++i, y += step) {
    auto* nearest_here = nearest.ptr<std::int16_t>(y, x);
    auto* distance_here = distance.ptr<std::uint8_t>(y, x);
    HWY_DYNAMIC_DISPATCH(advance)
    ({disparity.ptr<std::int16_t>(y, x), confidence.ptr<std::uint8_t>(y, x), nearest_before,
      distance_before, nearest_here, distance_here, count});
    nearest_before = nearest_here;
    distance_before = distance_here;
  }
}

/// The same along a row, from column `first` on.
void advanceRow(const std::int16_t* disparity, const std::uint8_t* confidence, int width, int first,
                int step, std::int16_t* nearest, std::uint8_t* distance) {
  std::int16_t last = ConfidentNeighbors::kNoNeighbor;
  int last_distance = 255;
  for (int i = 0, x = first; i < width; ++i, x += step) {
    if (confidence[x] >= ConfidentNeighbors::kConfident) {
      last = disparity[x];
      last_distance = 0;
    } else {
      last_distance = std::min(last_distance + 1, 255);
    }
    nearest[x] = last;
    distance[x] = static_cast<std::uint8_t>(last_distance);
  }
}

}  // namespace

void ConfidentNeighbors::RowMemory::resize(int width) {
  left.resize(width);
  right.resize(width);
  left_distance.resize(width);
  right_distance.resize(width);
}

void ConfidentNeighbors::find(const cv::Mat& disparity, const cv::Mat& confidence) {
  CV_Assert(disparity.type() == CV_16SC1 && confidence.type() == CV_8UC1);
  CV_Assert(disparity.size() == confidence.size() && !disparity.empty());
  disparity_ = disparity;
  confidence_ = confidence;
  for (cv::Mat* map : {&above_, &below_}) {
    map->create(disparity.size(), CV_16SC1);
  }
  for (cv::Mat* map : {&above_distance_, &below_distance_}) {
    map->create(disparity.size(), CV_8UC1);
  }
  const int tasks = (disparity.cols + kColumnsPerTask - 1) / kColumnsPerTask;
  tbb::parallel_for(0, tasks, [&](int task) {
    const int x = task * kColumnsPerTask;
    const int count = std::min(kColumnsPerTask, disparity.cols - x);
    advanceColumns(disparity, confidence, 0, 1, x, count, above_, above_distance_);
    advanceColumns(disparity, confidence, disparity.rows - 1, -1, x, count, below_,
                   below_distance_);
  });
}

void ConfidentNeighbors::findOnRow(int y, RowMemory& memory) const {
  const int width = disparity_.cols;
  CV_Assert(memory.left.size() == static_cast<std::size_t>(width));
  const auto* disparity = disparity_.ptr<std::int16_t>(y);
  const auto* confidence = confidence_.ptr<std::uint8_t>(y);
  advanceRow(disparity, confidence, width, 0, 1, memory.left.data(), memory.left_distance.data());
  advanceRow(disparity, confidence, width, width - 1, -1, memory.right.data(),
             memory.right_distance.data());
}

}  // namespace cbmv
#endif  // HWY_ONCE
