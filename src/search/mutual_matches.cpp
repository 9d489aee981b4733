#include "cbmv_stereo/search/mutual_matches.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "search/scan_rows.h"

#include "cbmv_stereo/matching/census_transform.h"
#include "cbmv_stereo/matching/cost_row.h"
#include "cbmv_stereo/matching/padded_image.h"
#include "cbmv_stereo/volume/per_thread.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "search/mutual_matches.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;
using Words = hn::CappedTag<std::uint16_t, 32>;

/// Hamming distances of all hypotheses of a row, and one repeated at both ends of each line.
void computeDistances(const CensusRows& rows) {
  for (int i = 0; i < rows.range.count; ++i) {
    const int d = rows.range.min + i;
    const ColumnSpan span = matchedColumns(rows.width, d);
    std::uint8_t* line = rows.distances + i * rows.pitch;
    forLanes(Bytes(), span.begin, span.end, [&](auto tag, int x, int) HWY_ATTR {
      auto distance = hn::Zero(tag);
      for (std::size_t k = 0; k < rows.left.size(); ++k) {
        const auto difference =
            hn::Xor(hn::LoadU(tag, rows.left[k] + x), hn::LoadU(tag, rows.right[k] + x - d));
        distance = hn::Add(distance, hn::PopulationCount(difference));
      }
      hn::StoreU(distance, tag, line + x);
    });
    if (!span.empty()) {
      line[span.begin - 1] = line[span.begin];
      line[span.end] = line[span.end - 1];
    }
  }
}

/// Sums of three lines.
void addLines(const std::uint8_t* above, const std::uint8_t* middle, const std::uint8_t* below,
              std::ptrdiff_t count, std::uint8_t* sums) {
  const Bytes tag;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(tag));
  for (std::ptrdiff_t i = 0; i < count; i += lanes) {
    const auto sum = hn::Add(hn::LoadU(tag, above + i), hn::LoadU(tag, middle + i));
    hn::StoreU(hn::Add(sum, hn::LoadU(tag, below + i)), tag, sums + i);
  }
}

/// Lanes of the columns from `x` on whose match lies inside of the right image.
HWY_INLINE hn::Mask<Words> isInside(Words tag, int x, int width, int d) {
  const int lanes = static_cast<int>(hn::Lanes(tag));
  const ColumnSpan span = matchedColumns(width, d);
  const auto first = [=](int column) {
    return hn::FirstN(tag, static_cast<std::size_t>(std::clamp(column - x, 0, lanes)));
  };
  return hn::AndNot(first(span.begin), first(span.end));
}

/// Finds the winners of a vector of left pixels, and lowers those of the right pixels that match
/// them. `columns` points to the sums of three rows of distances at column x.
HWY_INLINE void scanColumns(const std::uint8_t* columns, std::ptrdiff_t pitch, int x, int width,
                            const DisparityRange& range, const RowWinners& winners) {
  const Words tag;
  const hn::Rebind<std::uint8_t, Words> bytes;
  const int lanes = static_cast<int>(hn::Lanes(tag));
  auto best = hn::Set(tag, kNoCost);
  auto index = hn::Zero(tag);
  auto second = best;
  // Least costs of all disparities but the last, and but the last two.
  auto before = best;
  auto before_last = best;
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const std::uint8_t* sums = columns + i * pitch;
    const auto sum = [&](int dx) HWY_ATTR {
      return hn::PromoteTo(tag, hn::LoadU(bytes, sums + dx));
    };
    auto cost = hn::Add(hn::Add(sum(-1), sum(0)), sum(1));
    if (x < d || x + lanes > std::min(width, width + d)) {
      cost = hn::IfThenElse(isInside(tag, x, width, d), cost, hn::Set(tag, kNoCost));
    }
    const auto here = hn::Set(tag, static_cast<std::uint16_t>(i));
    const auto is_best = hn::Lt(cost, best);
    const auto is_far = hn::Lt(hn::Add(index, hn::Set(tag, 1)), here);
    const auto other = hn::IfThenElse(is_far, hn::Min(second, cost), second);
    second = hn::IfThenElse(is_best, before_last, other);
    index = hn::IfThenElse(is_best, here, index);
    best = hn::Min(best, cost);
    before_last = before;
    before = best;

    std::uint16_t* right_cost = winners.right_cost + x - d;
    std::uint16_t* right_index = winners.right_index + x - d;
    const auto right_best = hn::LoadU(tag, right_cost);
    const auto is_right_best = hn::Lt(cost, right_best);
    hn::StoreU(hn::Min(cost, right_best), tag, right_cost);
    hn::StoreU(hn::IfThenElse(is_right_best, here, hn::LoadU(tag, right_index)), tag, right_index);
  }
  hn::StoreU(best, tag, winners.cost + x);
  hn::StoreU(second, tag, winners.second_cost + x);
  hn::StoreU(index, tag, winners.index + x);
}

void findWinners(const std::uint8_t* sums, std::ptrdiff_t pitch, int width,
                 const DisparityRange& range, const RowWinners& winners) {
  const int lanes = static_cast<int>(hn::Lanes(Words()));
  for (int x = 0; x < width; x += lanes) {
    scanColumns(sums + x, pitch, x, width, range, winners);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(computeDistances);
HWY_EXPORT(addLines);
HWY_EXPORT(findWinners);

const cv::Size kWindow(9, 7);
constexpr int kVector = 64;  // bytes; the widest
constexpr int kRowsPerTask = 24;

int roundUp(int value, int multiple) { return (value + multiple - 1) / multiple * multiple; }

/// Memory of one thread.
class RowScanner {
 public:
  void resize(int width, const DisparityRange& range, unsigned clear_percent) {
    width_ = width;
    clear_percent_ = clear_percent;
    range_ = range;
    pitch_ = kVector + roundUp(width, kVector) + kVector;
    const std::size_t size = static_cast<std::size_t>(pitch_) * range.count;
    for (auto& row : ring_) {
      row.resize(size);
    }
    sums_.resize(size);
    for (auto* line : {&cost_, &second_cost_, &index_}) {
      line->resize(roundUp(width, kVector));
    }
    right_pad_ = std::max(std::abs(range.min), std::abs(range.max())) + kVector;
    right_cost_.resize(width + 2 * right_pad_);
    right_index_.resize(right_cost_.size());
  }

  /// The rows [begin, end) of the image.
  void scan(const CensusTransform& left, const CensusTransform& right, int begin, int end,
            int height, cv::Mat& matches) {
    for (int y = begin; y < end; ++y) {
      const int above = std::max(y - 1, 0);
      const int below = std::min(y + 1, height - 1);
      if (y == begin) {
        fill(left, right, above);
        fill(left, right, y);
      }
      if (below != y) {
        fill(left, right, below);
      }
      HWY_DYNAMIC_DISPATCH(addLines)
      (row(above), row(y), row(below), pitch_ * range_.count, sums_.data());
      findMatches(matches.ptr<std::int16_t>(y));
    }
  }

 private:
  std::uint8_t* row(int y) { return ring_[y % ring_.size()].data(); }

  void fill(const CensusTransform& left, const CensusTransform& right, int y) {
    CensusRows rows{{}, {}, width_, range_, pitch_, row(y) + kVector};
    for (int k = 0; k < left.bytes(); ++k) {
      rows.left[k] = left.row(y, k);
      rows.right[k] = right.row(y, k);
    }
    HWY_DYNAMIC_DISPATCH(computeDistances)(rows);
  }

  void findMatches(std::int16_t* matches) {
    std::fill(right_cost_.begin(), right_cost_.end(), kNoCost);
    std::fill(right_index_.begin(), right_index_.end(), std::uint16_t{0});
    const RowWinners winners{cost_.data(), second_cost_.data(), index_.data(),
                             right_cost_.data() + right_pad_, right_index_.data() + right_pad_};
    HWY_DYNAMIC_DISPATCH(findWinners)(sums_.data() + kVector, pitch_, width_, range_, winners);
    for (int x = 0; x < width_; ++x) {
      const int index = winners.index[x];
      const bool is_clear = winners.second_cost[x] != kNoCost &&
                            100U * winners.cost[x] < clear_percent_ * winners.second_cost[x];
      const bool is_mutual =
          std::abs(winners.right_index[x - range_.min - index] - index) <= 1;
      matches[x] = is_clear && is_mutual ? static_cast<std::int16_t>(index) : kNoMatch;
    }
  }

  using Line = std::vector<std::uint16_t>;

  int width_ = 0;
  unsigned clear_percent_ = 0;
  DisparityRange range_;
  int pitch_ = 0;      ///< of lines with a vector more on both sides
  int right_pad_ = 0;  ///< columns before and behind the right image that matches may fall on
  std::array<std::vector<std::uint8_t>, 3> ring_;  ///< distances of three rows
  std::vector<std::uint8_t> sums_;
  Line cost_, second_cost_, index_, right_cost_, right_index_;
};

}  // namespace

class MutualMatcher::Impl {
 public:
  explicit Impl(int clear_percent) : clear_percent_(static_cast<unsigned>(clear_percent)) {}

  void find(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
            cv::Mat& matches) {
    CV_Assert(left.type() == CV_8UC1 && right.type() == CV_8UC1 && left.size() == right.size());
    transform(left, left_);
    transform(right, right_);
    matches.create(left.size(), CV_16SC1);
    scanners_.prepare([&](RowScanner& scanner) { scanner.resize(left.cols, range, clear_percent_); });
    const int tasks = (left.rows + kRowsPerTask - 1) / kRowsPerTask;
    tbb::parallel_for(0, tasks, [&](int task) {
      const int begin = task * kRowsPerTask;
      scanners_.local().scan(left_, right_, begin, std::min(begin + kRowsPerTask, left.rows),
                             left.rows, matches);
    });
  }

 private:
  void transform(const cv::Mat& image, CensusTransform& census) {
    padImage(image, padded_);
    census.compute(padded_, kWindow);
  }

  const unsigned clear_percent_;
  cv::Mat padded_;
  CensusTransform left_;
  CensusTransform right_;
  PerThread<RowScanner> scanners_;
};

MutualMatcher::MutualMatcher(int clear_percent)
    : impl_(std::make_unique<Impl>(clear_percent)) {}
MutualMatcher::~MutualMatcher() = default;

void MutualMatcher::find(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
                         cv::Mat& matches) {
  impl_->find(left, right, range, matches);
}

}  // namespace cbmv
#endif  // HWY_ONCE
