#include "search/mutual_matches.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/per_thread.h"
#include "base/round_up.h"
#include "matching/census_transform.h"
#include "matching/cost_row.h"
#include "matching/padded_image.h"
#include "search/scan_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "search/mutual_matches.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;
using Words = hn::CappedTag<std::uint16_t, 32>;

/// Hamming distances of a vector of left pixels to their matches, at all disparities. Unspecified
/// where the match is outside of the image.
HWY_INLINE void computeDistancesAt(const CensusRows& rows, int x) {
  const Bytes tag;
  const auto loadByte = [&](const std::uint8_t* bits, int k, int column)
                            HWY_ATTR { return hn::LoadU(tag, bits + k * rows.width + column); };
  const auto left0 = loadByte(rows.left, 0, x);
  const auto left1 = loadByte(rows.left, 1, x);
  const auto left2 = loadByte(rows.left, 2, x);
  const auto left3 = loadByte(rows.left, 3, x);
  const auto left4 = loadByte(rows.left, 4, x);
  const auto left5 = loadByte(rows.left, 5, x);
  const auto left6 = loadByte(rows.left, 6, x);
  const auto left7 = loadByte(rows.left, 7, x);
  const int lanes = static_cast<int>(hn::Lanes(tag));
  for (int i = 0; i < rows.range.count; ++i) {
    const int match = x - rows.range.min - i;
    if (match <= -lanes || match >= rows.width) {
      continue;
    }
    const auto differing = [&](auto left, int k) HWY_ATTR {
      return hn::PopulationCount(hn::Xor(left, loadByte(rows.right, k, match)));
    };
    const auto distance01 = hn::Add(differing(left0, 0), differing(left1, 1));
    const auto distance23 = hn::Add(differing(left2, 2), differing(left3, 3));
    const auto distance45 = hn::Add(differing(left4, 4), differing(left5, 5));
    const auto distance67 = hn::Add(differing(left6, 6), differing(left7, 7));
    hn::StoreU(hn::Add(hn::Add(distance01, distance23), hn::Add(distance45, distance67)), tag,
               rows.distances + i * rows.pitch + x);
  }
}

/// Hamming distances of all hypotheses of a row. The first and the last distance of each line are
/// repeated beyond its ends.
void computeDistances(const CensusRows& rows) {
  const int lanes = static_cast<int>(hn::Lanes(Bytes()));
  for (int x = 0; x < rows.width; x += lanes) {
    computeDistancesAt(rows, x);
  }
  for (int i = 0; i < rows.range.count; ++i) {
    const ColumnSpan span = matchedColumns(rows.width, rows.range.min + i);
    std::uint8_t* line = rows.distances + i * rows.pitch;
    if (!span.empty()) {
      line[span.begin - 1] = line[span.begin];
      line[span.end] = line[span.end - 1];
    }
  }
}

void addLines(const std::uint8_t* above, const std::uint8_t* middle, const std::uint8_t* below,
              std::ptrdiff_t count, std::uint8_t* sums) {
  const Bytes tag;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(tag));
  for (std::ptrdiff_t i = 0; i < count; i += lanes) {
    const auto sum = hn::Add(hn::LoadU(tag, above + i), hn::LoadU(tag, middle + i));
    hn::StoreU(hn::Add(sum, hn::LoadU(tag, below + i)), tag, sums + i);
  }
}

/// Lanes whose columns, from `first` on, are inside of the image.
HWY_INLINE hn::Mask<Words> isInside(Words tag, int first, int width) {
  const int lanes = static_cast<int>(hn::Lanes(tag));
  const auto before = [=](int column) {
    return hn::FirstN(tag, static_cast<std::size_t>(std::clamp(column - first, 0, lanes)));
  };
  return hn::AndNot(before(0), before(width));
}

/// Updates the winners of a vector of pixels of `view` with the disparities [begin, end) of a
/// block. Stores their costs, or kNoCost where the match is outside of the image.
HWY_INLINE void scanBlock(const SumRows& sums, View view, int x, int begin, int end,
                          std::uint16_t* costs, hn::Vec<Words>& best, hn::Vec<Words>& index) {
  const Words tag;
  const hn::Rebind<std::uint8_t, Words> bytes;
  const int lanes = static_cast<int>(hn::Lanes(tag));
  const auto none = hn::Set(tag, kNoCost);
  auto lowest = none;
  for (int i = begin; i < end; ++i) {
    const int match = matchingColumn(view, x, sums.range.min + i);
    const int left = view == View::kLeft ? x : match;
    auto cost = none;
    auto key = none;
    if (match > -lanes && match < sums.width) {
      const std::uint8_t* sum = sums.sums + i * sums.pitch + left;
      const auto sumAt = [&](int dx)
                             HWY_ATTR { return hn::PromoteTo(tag, hn::LoadU(bytes, sum + dx)); };
      cost = hn::Add(hn::Add(sumAt(-1), sumAt(0)), sumAt(1));
      key = hn::Or(hn::ShiftLeft<kIndexBits>(cost),
                   hn::Set(tag, static_cast<std::uint16_t>(i - begin)));
      if (match < 0 || match + lanes > sums.width) {
        const auto inside = isInside(tag, match, sums.width);
        cost = hn::IfThenElse(inside, cost, none);
        key = hn::IfThenElse(inside, key, none);
      }
    }
    hn::StoreU(cost, tag, costs + i * lanes);
    lowest = hn::Min(lowest, key);
  }
  const auto cost = hn::ShiftRight<kIndexBits>(lowest);
  const auto here = hn::Add(hn::And(lowest, hn::Set(tag, kBlock - 1)),
                            hn::Set(tag, static_cast<std::uint16_t>(begin)));
  const auto is_lower = hn::And(hn::Ne(lowest, none), hn::Lt(cost, best));
  best = hn::IfThenElse(is_lower, cost, best);
  index = hn::IfThenElse(is_lower, here, index);
}

/// Finds the winners of a vector of pixels. Their costs are in `best`, the costs of all disparities
/// in `costs`.
HWY_INLINE hn::Vec<Words> scanVector(const SumRows& sums, View view, int x, std::uint16_t* costs,
                                     hn::Vec<Words>& best) {
  const Words tag;
  best = hn::Set(tag, kNoCost);
  auto index = hn::Zero(tag);
  for (int begin = 0; begin < sums.range.count; begin += kBlock) {
    const int end = std::min(begin + kBlock, sums.range.count);
    scanBlock(sums, view, x, begin, end, costs, best, index);
  }
  return index;
}

/// Lowest costs of the disparities that are more than 1 away from the winners.
HWY_INLINE hn::Vec<Words> findSecond(const std::uint16_t* costs, int count,
                                     const hn::Vec<Words>& index) {
  const Words tag;
  const int lanes = static_cast<int>(hn::Lanes(tag));
  auto second = hn::Set(tag, kNoCost);
  auto distance = hn::Sub(hn::Set(tag, 1), index);  // i − index + 1
  for (int i = 0; i < count; ++i) {
    const auto is_far = hn::Gt(distance, hn::Set(tag, 2));
    const auto cost = hn::LoadU(tag, costs + i * lanes);
    second = hn::Min(second, hn::IfThenElse(is_far, cost, hn::Set(tag, kNoCost)));
    distance = hn::Add(distance, hn::Set(tag, 1));
  }
  return second;
}

void findWinners(const SumRows& sums, std::uint16_t* costs, const RowWinners& out) {
  const Words tag;
  auto best = hn::Zero(tag);
  for (int x = 0; x < sums.width; x += static_cast<int>(hn::Lanes(tag))) {
    hn::StoreU(scanVector(sums, View::kRight, x, costs, best), tag, out.right_index + x);
    const auto index = scanVector(sums, View::kLeft, x, costs, best);
    hn::StoreU(best, tag, out.cost + x);
    hn::StoreU(index, tag, out.index + x);
    hn::StoreU(findSecond(costs, sums.range.count, index), tag, out.second_cost + x);
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
constexpr int kVector = 64;  // bytes; size of the widest vector
constexpr int kRowsPerTask = 24;

/// Scans rows. One per thread.
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
    left_bits_.resize(static_cast<std::size_t>(width) * CensusRows::kBytes + 2 * kVector);
    right_bits_.resize(left_bits_.size());
    for (auto* line : {&cost_, &second_cost_, &index_, &right_index_}) {
      line->resize(roundUp(width, kVector));
    }
    costs_.resize(static_cast<std::size_t>(range.count) * kVector / sizeof(std::uint16_t));
  }

  /// Scans the rows [begin, end) of the image.
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
    left.computeRow(y, left_bits_.data() + kVector);
    right.computeRow(y, right_bits_.data() + kVector);
    const CensusRows rows{left_bits_.data() + kVector,
                          right_bits_.data() + kVector,
                          width_,
                          range_,
                          pitch_,
                          row(y) + kVector};
    HWY_DYNAMIC_DISPATCH(computeDistances)(rows);
  }

  void findMatches(std::int16_t* matches) {
    const SumRows sums{sums_.data() + kVector, pitch_, width_, range_};
    const RowWinners winners{cost_.data(), second_cost_.data(), index_.data(), right_index_.data()};
    HWY_DYNAMIC_DISPATCH(findWinners)(sums, costs_.data(), winners);
    for (int x = 0; x < width_; ++x) {
      const int index = index_[x];
      const bool is_clear =
          second_cost_[x] != kNoCost && 100U * cost_[x] < clear_percent_ * second_cost_[x];
      // A pixel with a second cost has a winner, whose match is inside of the image.
      const bool is_match = is_clear && std::abs(right_index_[x - range_.min - index] - index) <= 1;
      matches[x] = is_match ? static_cast<std::int16_t>(index) : kNoMatch;
    }
  }

  using Line = std::vector<std::uint16_t>;

  int width_ = 0;
  unsigned clear_percent_ = 0;
  DisparityRange range_;
  int pitch_ = 0;  ///< length of a line with one vector more on both sides
  std::array<std::vector<std::uint8_t>, 3> ring_;  ///< distances of three rows
  std::vector<std::uint8_t> sums_;
  /// Census of a row, with one vector more on both sides.
  std::vector<std::uint8_t> left_bits_, right_bits_;
  Line costs_;  ///< of a vector of pixels
  Line cost_, second_cost_, index_, right_index_;
};

}  // namespace

class MutualMatcher::Impl {
 public:
  explicit Impl(int clear_percent) : clear_percent_(static_cast<unsigned>(clear_percent)) {}

  void find(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
            cv::Mat& matches) {
    CV_Assert(left.type() == CV_8UC1 && right.type() == CV_8UC1 && left.size() == right.size());
    padImage(left, padded_left_);
    padImage(right, padded_right_);
    left_.prepare(padded_left_, kWindow);
    right_.prepare(padded_right_, kWindow);
    matches.create(left.size(), CV_16SC1);
    scanners_.prepare(
        [&](RowScanner& scanner) { scanner.resize(left.cols, range, clear_percent_); });
    const int tasks = (left.rows + kRowsPerTask - 1) / kRowsPerTask;
    tbb::parallel_for(0, tasks, [&](int task) {
      const int begin = task * kRowsPerTask;
      scanners_.local().scan(left_, right_, begin, std::min(begin + kRowsPerTask, left.rows),
                             left.rows, matches);
    });
  }

 private:
  const unsigned clear_percent_;
  cv::Mat padded_left_;
  cv::Mat padded_right_;
  CensusTransform left_;
  CensusTransform right_;
  PerThread<RowScanner> scanners_;
};

MutualMatcher::MutualMatcher(int clear_percent) : impl_(std::make_unique<Impl>(clear_percent)) {}
MutualMatcher::~MutualMatcher() = default;

void MutualMatcher::find(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
                         cv::Mat& matches) {
  impl_->find(left, right, range, matches);
}

}  // namespace cbmv
#endif  // HWY_ONCE
