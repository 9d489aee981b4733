#include "search/range_finder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "volume/coarse_volume.h"

namespace cbmv {
namespace {

constexpr int kLargestWidthPx = 320;

/// Halves the image `times` times. `halves` keeps the memory.
cv::Mat shrink(cv::Mat image, int times, std::vector<cv::Mat>& halves) {
  halves.resize(std::max(halves.size(), static_cast<std::size_t>(times)));
  for (int i = 0; i < times; ++i) {
    halveImage(image, halves[i]);
    image = halves[i];
  }
  return image;
}

int timesToHalve(cv::Size size) {
  int times = 0;
  for (; size.width > kLargestWidthPx && size.height >= 2; size /= 2) {
    ++times;
  }
  return times;
}

/// The number of disparities with the margin, rounded up.
int countFor(int found) {
  const int wanted = found + found / 4;
  return (wanted + RangeFinder::kStep - 1) / RangeFinder::kStep * RangeFinder::kStep;
}

/// The range, limited to the disparities that fit the images. One disparity if none fits.
DisparityRange rangeOf(int min_disparity, int count, int image_width) {
  return {min_disparity, std::clamp(image_width - min_disparity, 1, count)};
}

}  // namespace

std::optional<DisparityRange> RangeFinder::find(const cv::Mat& left, const cv::Mat& right,
                                                int min_disparity) {
  CV_Assert(left.type() == CV_8UC1 && right.type() == CV_8UC1 && left.size() == right.size());
  const int times = timesToHalve(left.size());
  const cv::Mat coarse_left = shrink(left, times, left_halves_);
  const cv::Mat coarse_right = shrink(right, times, right_halves_);
  const int scale = 1 << times;
  const int coarse_min = static_cast<int>(std::floor(static_cast<double>(min_disparity) / scale));
  const DisparityRange coarse{coarse_min, std::max(1, coarse_left.cols / 2)};
  matcher_.find(coarse_left, coarse_right, coarse, matches_);
  const int nearest = findNearest(coarse.count);
  if (nearest == kNoMatch) {
    return std::nullopt;
  }
  const int end = (coarse.min + nearest + 1) * scale;
  return rangeOf(min_disparity, countFor(end - min_disparity), left.cols);
}

DisparityRange RangeFinder::defaultRange(int min_disparity, int image_width) {
  return rangeOf(min_disparity, kDefaultCount, image_width);
}

int RangeFinder::findNearest(int disparities) {
  sortByDisparity(disparities);
  const auto found = std::find_if(sorted_.rbegin(), sorted_.rend(), [this](const Pixel& pixel) {
    return matches_(pixel.y, pixel.x) != kNoMatch && isObject(pixel);
  });
  return found == sorted_.rend() ? kNoMatch : found->match;
}

void RangeFinder::sortByDisparity(int disparities) {
  places_.assign(disparities + 1, 0);
  for (const std::int16_t match : matches_) {
    places_[match + 1] += match == kNoMatch ? 0 : 1;
  }
  std::partial_sum(places_.begin(), places_.end(), places_.begin());
  sorted_.resize(places_.back());
  for (int y = 0; y < matches_.rows; ++y) {
    for (int x = 0; x < matches_.cols; ++x) {
      if (const std::int16_t match = matches_(y, x); match != kNoMatch) {
        sorted_[places_[match]++] = {x, y, match};
      }
    }
  }
}

bool RangeFinder::isObject(const Pixel& seed) {
  stack_.assign(1, seed);
  matches_(seed.y, seed.x) = kNoMatch;
  for (int pixels = 1; !stack_.empty(); ++pixels) {
    if (pixels == kSmallestObjectPx) {
      return true;
    }
    const Pixel pixel = stack_.back();
    stack_.pop_back();
    const cv::Rect around =
        cv::Rect(pixel.x - 1, pixel.y - 1, 3, 3) & cv::Rect(0, 0, matches_.cols, matches_.rows);
    for (int y = around.y; y < around.br().y; ++y) {
      for (int x = around.x; x < around.br().x; ++x) {
        std::int16_t& match = matches_(y, x);
        if (match != kNoMatch && std::abs(match - pixel.match) <= 1) {
          stack_.push_back({x, y, match});
          match = kNoMatch;
        }
      }
    }
  }
  return false;
}

}  // namespace cbmv
