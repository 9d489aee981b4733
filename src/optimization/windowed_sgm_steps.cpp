#include "optimization/windowed_sgm_steps.h"

#include <algorithm>
#include <cstdlib>

#include <tbb/parallel_for.h>

#include "optimization/surface_prior.h"

namespace cbmv {
namespace {

/// Readable columns after those of the tiles.
constexpr int kReadableColumns = 16;

/// A neighbor of each pixel: `columns` to the left and `rows` above.
struct Neighbor {
  int columns;
  int rows;
};

/// Sets out[x] = step(value of the neighbor, value) for every column in `columns` that has this
/// neighbor, and 0 for the others.
template <typename Value, typename Step>
void findRow(const cv::Mat& image, int y, const Neighbor& neighbor, const cv::Range& columns,
             std::int8_t* out, const Step& step) {
  const int begin = std::max(columns.start, neighbor.columns);
  const int end = y >= neighbor.rows ? std::max(begin, std::min(columns.end, image.cols)) : begin;
  if (begin >= end) {
    std::fill(out + columns.start, out + columns.end, std::int8_t{0});
    return;
  }
  std::fill(out + columns.start, out + begin, std::int8_t{0});
  std::fill(out + end, out + columns.end, std::int8_t{0});
  const auto* values = image.ptr<Value>(y);
  const auto* neighbors = image.ptr<Value>(y - neighbor.rows) - neighbor.columns;
  for (int x = begin; x < end; ++x) {
    out[x] = step(neighbors[x], values[x]);
  }
}

/// Sets -1 where the gray levels differ by at least `threshold_gray`.
void findEdges(const cv::Mat& gray, float threshold_gray, int y, const Neighbor& neighbor,
               const cv::Range& columns, std::int8_t* out) {
  const int lowest_step = lowestStep(threshold_gray);
  findRow<std::uint8_t>(gray, y, neighbor, columns, out, [=](int previous, int next) {
    return static_cast<std::int8_t>(std::abs(next - previous) >= lowest_step ? -1 : 0);
  });
}

void findRises(const cv::Mat& surface, int y, const Neighbor& neighbor, const cv::Range& columns,
               std::int8_t* out) {
  findRow<std::int16_t>(surface, y, neighbor, columns, out, surfaceRise);
}

}  // namespace

void StepMap::find(const EdgeImages& images, const cv::Mat& surface, View view,
                   const SearchSpace& space, Axis axis) {
  const Neighbor neighbor = axis == Axis::kHorizontal ? Neighbor{1, 0} : Neighbor{0, 1};
  const DisparityRange& range = space.range();
  slope_ = view == View::kLeft ? -1 : 1;
  first_other_ = view == View::kLeft ? range.count - 1 : 0;
  const cv::Range columns(0, space.tiles() * kTileColumns + kReadableColumns);
  const int first_match = matchingColumn(view, 0, view == View::kLeft ? range.max() : range.min);
  const cv::Range matches(first_match, first_match + columns.end + range.count - 1);
  reference_.create(space.height(), columns.end, CV_8SC1);
  other_.create(space.height(), matches.size(), CV_8SC1);
  rises_.create(surface.empty() ? 1 : space.height(), columns.end, CV_8SC1);
  if (surface.empty()) {
    rises_.setTo(0);
  }
  tbb::parallel_for(0, space.height(), [&](int y) {
    findEdges(images.reference, images.reference_threshold_gray, y, neighbor, columns,
              reference_.ptr<std::int8_t>(y));
    findEdges(images.other, images.other_threshold_gray, y, neighbor, matches,
              other_.ptr<std::int8_t>(y) - first_match);
    if (!surface.empty()) {
      findRises(surface, y, neighbor, columns, rises_.ptr<std::int8_t>(y));
    }
  });
}

PathSteps StepMap::row(int y) const {
  return {reference_.ptr<std::int8_t>(y), other_.ptr<std::int8_t>(y) + first_other_, slope_,
          rises_.ptr<std::int8_t>(rises_.rows == 1 ? 0 : y)};
}

}  // namespace cbmv
