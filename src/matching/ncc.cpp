#include "matching/ncc.h"

#include "matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/ncc.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;

// All sums and products are integers below 2²⁴, exact in single precision. So a fused multiply-add
// gives the same result.
constexpr float kPixels = NccMatcher::kWindowPx * NccMatcher::kWindowPx;

/// Sum of columns x − 1, x, x + 1.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V sumOfThree(D tag, const float* columns) {
  return hn::Add(hn::Add(hn::LoadU(tag, columns - 1), hn::LoadU(tag, columns)),
                 hn::LoadU(tag, columns + 1));
}

/// Products left · right, summed down the columns of the windows, from one column before `span` to
/// one column after it.
HWY_INLINE void sumProducts(const NccMatcher::Rows& left, const NccMatcher::Rows& right, int d,
                            const ColumnSpan& span, float* columns) {
  const NccMatcher::Rows l = left;
  const NccMatcher::Rows r = right;
  forLanes(Floats(), span.begin - 1, span.end + 1, [=](auto tag, int x, int) HWY_ATTR {
    auto sum = hn::Mul(hn::LoadU(tag, l[0] + x), hn::LoadU(tag, r[0] + x - d));
    sum = hn::MulAdd(hn::LoadU(tag, l[1] + x), hn::LoadU(tag, r[1] + x - d), sum);
    sum = hn::MulAdd(hn::LoadU(tag, l[2] + x), hn::LoadU(tag, r[2] + x - d), sum);
    hn::StoreU(sum, tag, columns + x);
  });
}

HWY_INLINE void sumWindows(const NccMatcher::Rows& rows, int width, float* columns, float* sums,
                           float* inverse_deviations) {
  const NccMatcher::Rows r = rows;
  forLanes(Floats(), -1, width + 1, [=](auto tag, int x, int) HWY_ATTR {
    const auto sum = hn::Add(hn::Add(hn::LoadU(tag, r[0] + x), hn::LoadU(tag, r[1] + x)),
                             hn::LoadU(tag, r[2] + x));
    hn::StoreU(sum, tag, columns + x);
  });
  forLanes(Floats(), 0, width, [=](auto tag, int x, int) HWY_ATTR {
    hn::StoreU(sumOfThree(tag, columns + x), tag, sums + x);
  });
  const ColumnSpan span{0, width};
  sumProducts(rows, rows, 0, span, columns);
  forLanes(Floats(), 0, width, [=](auto tag, int x, int) HWY_ATTR {
    const auto sum = hn::LoadU(tag, sums + x);
    const auto variance =
        hn::Sub(hn::Mul(hn::Set(tag, kPixels), sumOfThree(tag, columns + x)), hn::Mul(sum, sum));
    const auto inverse = hn::Div(hn::Set(tag, 1.0F), hn::Sqrt(variance));
    hn::StoreU(hn::IfThenElseZero(hn::Gt(variance, hn::Zero(tag)), inverse), tag,
               inverse_deviations + x);
  });
}

/// `columns` has the sums of products down the columns of the windows.
HWY_INLINE void correlateRun(const NccMatcher::Windows& left, const NccMatcher::Windows& right,
                             int d, const ColumnSpan& span, const float* columns, float* line) {
  const NccMatcher::Windows l = left;
  const NccMatcher::Windows r = right;
  forLanes(Floats(), span.begin, span.end, [=](auto tag, int x, int) HWY_ATTR {
    const auto negative_covariance =
        hn::Sub(hn::Mul(hn::LoadU(tag, l.sums + x), hn::LoadU(tag, r.sums + x - d)),
                hn::Mul(hn::Set(tag, kPixels), sumOfThree(tag, columns + x)));
    const auto inverse = hn::Mul(hn::LoadU(tag, l.inverse_deviations + x),
                                 hn::LoadU(tag, r.inverse_deviations + x - d));
    const auto cost = hn::Mul(negative_covariance, inverse);
    const auto textured = hn::Gt(inverse, hn::Zero(tag));
    hn::StoreU(hn::IfThenElse(textured, cost, hn::Set(tag, 1.0F)), tag, line + x);
  });
}

/// Prepares the data of a row of one view from the pixels of the window rows.
NccMatcher::Windows prepareWindows(const NccMatcher::Pixels& pixels, int width, float* columns,
                                   NccMatcher::View& view) {
  NccMatcher::Windows windows{{}, view.sums.data(), view.inverse_deviations.data()};
  for (int r = 0; r < NccMatcher::kWindowPx; ++r) {
    float* row = view.rows[r].data() + 1;
    windows.rows[r] = row;
    forLanes(Floats(), -1, width + 1, [=, from = pixels[r]](auto tag, int x, int) HWY_ATTR {
      const hn::RebindToSigned<decltype(tag)> integer;
      const auto bytes = hn::LoadU(hn::Rebind<std::uint8_t, decltype(tag)>(), from + x);
      hn::StoreU(hn::ConvertTo(tag, hn::PromoteTo(integer, bytes)), tag, row + x);
    });
  }
  sumWindows(windows.rows, width, columns, view.sums.data(), view.inverse_deviations.data());
  return windows;
}

/// Calls fill(run, shift) and then use(run, shift) for all runs. Between the two calls, a line has
/// the values of the run's columns and of `radius` columns on either side: column x is at shift +
/// x. The line has room for `width` + 2 · `radius` values. As many runs as fit are filled before
/// the first is used, because a vector load that spans two recent stores has to wait for them.
template <class Fill, class Use>
HWY_INLINE void forBatches(const RowEntries& entries, int width, int radius, const Fill& fill,
                           const Use& use) {
  const int capacity = width + 2 * radius;
  const auto length = [radius](const RowEntries::Run& run) {
    return run.span.end - run.span.begin + 2 * radius;
  };
  const RowEntries::Run* run = entries.runs().data();
  const RowEntries::Run* const end = run + entries.runs().size();
  while (run != end) {
    const RowEntries::Run* const first = run;
    int filled = 0;
    for (; run != end && filled + length(*run) <= capacity; ++run) {
      fill(*run, filled + radius - run->span.begin);
      filled += length(*run);
    }
    filled = 0;
    for (const RowEntries::Run* ready = first; ready != run; ++ready) {
      use(*ready, filled + radius - ready->span.begin);
      filled += length(*ready);
    }
  }
}

void correlate(const NccMatcher::Pixels& left_pixels, const NccMatcher::Pixels& right_pixels,
               int width, const RowEntries& entries, NccMatcher::Scratch& scratch, float* costs) {
  float* columns = scratch.column_sums.data();
  const NccMatcher::Windows left = prepareWindows(left_pixels, width, columns + 1, scratch.left);
  const NccMatcher::Windows right = prepareWindows(right_pixels, width, columns + 1, scratch.right);
  forBatches(
      entries, width, NccMatcher::kWindowPx / 2,
      [&](const RowEntries::Run& run, int shift)
          HWY_ATTR { sumProducts(left.rows, right.rows, run.d, run.span, columns + shift); },
      [&](const RowEntries::Run& run, int shift) HWY_ATTR {
        correlateRun(left, right, run.d, run.span, columns + shift, costs + run.offset);
      });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(correlate);

NccMatcher::Pixels windowRows(const cv::Mat& padded, int y) {
  return {paddedRow<std::uint8_t>(padded, y - 1), paddedRow<std::uint8_t>(padded, y),
          paddedRow<std::uint8_t>(padded, y + 1)};
}

}  // namespace

void NccMatcher::View::resize(int width) {
  for (std::vector<float>& row : rows) {
    row.resize(static_cast<std::size_t>(width) + 2);
  }
  sums.resize(width);
  inverse_deviations.resize(width);
}

void NccMatcher::Scratch::resize(int width) {
  left.resize(width);
  right.resize(width);
  column_sums.resize(static_cast<std::size_t>(width) + 2);
}

void NccMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  padded_left_ = padded_left;
  padded_right_ = padded_right;
}

void NccMatcher::computeRow(int y, const RowEntries& entries, Scratch& scratch,
                            CostRow<float>& costs) const {
  const int width = padded_left_.cols - 2 * kMatchingBorderPx;
  costs.resize(entries.count());
  scratch.resize(width);
  HWY_DYNAMIC_DISPATCH(correlate)
  (windowRows(padded_left_, y), windowRows(padded_right_, y), width, entries, scratch,
   costs.entry(0));
}

}  // namespace cbmv
#endif  // HWY_ONCE
