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
struct Neighbour {
  int columns;
  int rows;
};

/// Sets out[x] = step(value of the neighbor, value) for every column in `columns` that has this
/// neighbor, and 0 for the others.
template <typename Value, typename Step>
void findRow(const cv::Mat& image, int y, const Neighbour& neighbour, const cv::Range& columns,
             std::int8_t* out, const Step& step) {
  const int begin = std::max(columns.start, neighbour.columns);
  const int end = y >= neighbour.rows ? std::max(begin, std::min(columns.end, image.cols)) : begin;
  if (begin >= end) {
    std::fill(out + columns.start, out + columns.end, std::int8_t{0});
    return;
  }
  std::fill(out + columns.start, out + begin, std::int8_t{0});
  std::fill(out + end, out + columns.end, std::int8_t{0});
  const auto* values = image.ptr<Value>(y);
  const auto* neighbours = image.ptr<Value>(y - neighbour.rows) - neighbour.columns;
  for (int x = begin; x < end; ++x) {
    out[x] = step(neighbours[x], values[x]);
  }
}

/// Sets -1 where the gray levels differ by at least `threshold_grey`.
void findEdges(const cv::Mat& grey, float threshold_grey, int y, const Neighbour& neighbour,
               const cv::Range& columns, std::int8_t* out) {
  const int lowest_step = lowestStep(threshold_grey);
  findRow<std::uint8_t>(grey, y, neighbour, columns, out, [=](int previous, int next) {
    return static_cast<std::int8_t>(std::abs(next - previous) >= lowest_step ? -1 : 0);
  });
}

void findRises(const cv::Mat& surface, int y, const Neighbour& neighbour, const cv::Range& columns,
               std::int8_t* out) {
  findRow<std::int16_t>(surface, y, neighbour, columns, out, surfaceRise);
}

}  // namespace

void StepMap::find(const EdgeImages& images, const cv::Mat& surface, View view,
                   const SearchSpace& space, Axis axis) {
  const Neighbour neighbour = axis == Axis::kHorizontal ? Neighbour{1, 0} : Neighbour{0, 1};
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
    findEdges(images.reference, images.reference_threshold_grey, y, neighbour, columns,
              reference_.ptr<std::int8_t>(y));
    findEdges(images.other, images.other_threshold_grey, y, neighbour, matches,
              other_.ptr<std::int8_t>(y) - first_match);
    if (!surface.empty()) {
      findRises(surface, y, neighbour, columns, rises_.ptr<std::int8_t>(y));
    }
  });
}

PathSteps StepMap::row(int y) const {
  return {reference_.ptr<std::int8_t>(y), other_.ptr<std::int8_t>(y) + first_other_, slope_,
          rises_.ptr<std::int8_t>(rises_.rows == 1 ? 0 : y)};
}

}  // namespace cbmv
