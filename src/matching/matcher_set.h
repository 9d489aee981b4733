#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

#include <opencv2/core.hpp>

#include "matching/census.h"
#include "matching/cost_row.h"
#include "matching/ncc.h"
#include "matching/row_entries.h"
#include "matching/sobel_sad.h"
#include "matching/zero_mean_sad.h"

namespace cbmv {

/// The four matchers, in the order of their features.
enum Matcher { kCensus, kNcc, kZeroMeanSad, kSobelSad };
constexpr int kMatcherCount = 4;
constexpr std::array<const char*, kMatcherCount> kMatcherNames = {"census", "ncc", "zero_mean_sad",
                                                                  "sobel_sad"};

/// The matchers that are used, one bit per Matcher.
using MatcherSelection = std::bitset<kMatcherCount>;
inline MatcherSelection allMatchers() { return MatcherSelection().set(); }

/// Matching costs of a row from all matchers.
struct MatcherCosts {
  CostRow<std::uint8_t> census;
  CostRow<float> ncc;
  CostRow<std::uint16_t> zero_mean_sad;
  CostRow<std::uint16_t> sobel_sad;

  /// Makes room for `entries` entries of the matchers `used`.
  void resize(std::size_t entries, const MatcherSelection& used);

  /// In the order of Matcher.
  std::array<CostRowPointer, kMatcherCount> rows() const {
    return {&census, &ncc, &zero_mean_sad, &sobel_sad};
  }
};

/// All matchers on one pair. Call `prepare` once per pair, then compute rows in any order from any
/// thread.
class MatcherSet {
 public:
  /// Memory for both images: the padded image, zero-mean SAD and Sobel SAD of each.
  static constexpr double kBytesPerPixel = 2 * (1 + 4 + 2);

  /// Memory for one row at a time. One per thread.
  struct Scratch {
    CensusMatcher::Scratch census;
    NccMatcher::Scratch ncc;
    ZeroMeanSadMatcher::Scratch zero_mean_sad;
    SobelSadMatcher::Scratch sobel_sad;

    /// Makes room for rows of `width` columns.
    void resize(int width);
  };

  /// Prepares the matchers `used`. Both images are CV_8UC1 and of the same size. Copies the data
  /// that it needs.
  void prepare(const cv::Mat& left, const cv::Mat& right,
               const MatcherSelection& used = allMatchers());

  /// Computes the costs of the entries of row y by the matchers `used`, which must be prepared.
  /// Costs of other matchers do not change.
  void computeRow(int y, const RowEntries& entries, const MatcherSelection& used, Scratch& scratch,
                  MatcherCosts& costs) const;

 private:
  cv::Mat padded_left_;
  cv::Mat padded_right_;
  CensusMatcher census_;
  NccMatcher ncc_;
  ZeroMeanSadMatcher zero_mean_sad_;
  SobelSadMatcher sobel_sad_;
};

}  // namespace cbmv
