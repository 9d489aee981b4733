#include "cbmv_stereo/volume/windowed_volume_builder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include <tbb/parallel_for.h>

#include "cbmv_stereo/confidence/features.h"
#include "cbmv_stereo/matching/matcher_set.h"
#include "cbmv_stereo/volume/per_thread.h"
#include "cbmv_stereo/volume/volume_builder.h"

namespace cbmv {
namespace {

/// What the rows of a pair have in common.
struct Problem {
  const MatcherSet& matchers;
  const SearchSpace& space;
  const Forest& forest;
  const ForestEvaluator& evaluator;
  MatcherSelection asked;
};

/// Scores the hypotheses of one row at a time. Features stand packed, span behind span, so that the
/// forest gets long lines.
class RowScorer {
 public:
  /// Makes room for rows with so many hypotheses.
  void reserve(const Problem& problem, std::size_t hypotheses) {
    const int width = problem.space.width();
    scratch_.resize(width);
    costs_.resize(width, problem.space.range().count, problem.asked);
    for (RowTerms& terms : terms_) {
      terms.left.reserve(width);
      terms.right.reserve(width);
    }
    pitch_ = std::max(pitch_, hypotheses);
    if (problem.evaluator.wantsValues()) {
      values_.resize(pitch_ * kFeatureCount);
    } else {
      codes_.resize(pitch_ * kFeatureCount);
    }
    packed_.resize(pitch_);
    lines_.resize(static_cast<std::size_t>(width) * problem.space.range().count);
  }

  void score(const Problem& problem, int y, WindowedMatchingVolume& volume) {
    const SearchSpace& space = problem.space;
    findSpans(space, y);
    problem.matchers.computeRow(y, space.range(), problem.asked, scratch_, costs_, &spans_);
    forAsked(problem, [&](int m) {
      computeRowTerms(costs_.rows()[m], space.width(), space.range(), kMatcherConstants[m],
                      terms_[m], &spans_);
    });
    problem.evaluator.wantsValues() ? evaluateValues(problem) : evaluateCodes(problem);
    unpack(space);
    store(space, y, volume);
  }

 private:
  template <typename Use>
  static void forAsked(const Problem& problem, const Use& use) {
    for (int m = 0; m < kMatcherCount; ++m) {
      if (problem.asked[m]) {
        use(m);
      }
    }
  }

  void findSpans(const SearchSpace& space, int y) {
    spans_.reset(space.range().count);
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      const int first = t * kTileColumns;
      for (int k = 0; k < tile.count; ++k) {
        const ColumnSpan inside = matchedColumns(space.width(), space.range().min + tile.indices[k]);
        spans_.add(tile.indices[k], {std::max(first, inside.begin),
                                     std::min(first + kTileColumns, inside.end)});
      }
    }
  }

  /// Calls use(i, span, place) with all spans and where their hypotheses stand packed. Returns the
  /// number of hypotheses.
  template <typename Use>
  int forPacked(const SearchSpace& space, const Use& use) const {
    int place = 0;
    for (int i = 0; i < space.range().count; ++i) {
      for (const ColumnSpan& span : spans_.of(i)) {
        use(i, span, place);
        place += span.end - span.begin;
      }
    }
    return place;
  }

  void evaluateCodes(const Problem& problem) {
    const DisparityRange& range = problem.space.range();
    const int count = forPacked(problem.space, [&](int i, const ColumnSpan& span, int place) {
      forAsked(problem, [&](int m) {
        CodeLines lines{};
        MatcherCodeMaps maps{};
        for (int f = 0; f < kFeaturesPerMatcher; ++f) {
          lines[f] = packedLine(codes_, featureIndex(m, f)) + place - span.begin;
          maps[f] = problem.forest.quantizer.maps[featureIndex(m, f)];
        }
        computeCodesInSpan(costs_.rows()[m], terms_[m], span, range, i, kMatcherConstants[m], maps,
                           lines);
      });
    });
    evaluate<std::uint8_t>(problem, codes_, count);
  }

  void evaluateValues(const Problem& problem) {
    const DisparityRange& range = problem.space.range();
    const int count = forPacked(problem.space, [&](int i, const ColumnSpan& span, int place) {
      forAsked(problem, [&](int m) {
        FeatureLines lines{};
        for (int f = 0; f < kFeaturesPerMatcher; ++f) {
          lines[f] = packedLine(values_, featureIndex(m, f)) + place - span.begin;
        }
        computeFeaturesInSpan(costs_.rows()[m], terms_[m], span, range, i, kMatcherConstants[m],
                              lines);
      });
    });
    evaluate<float>(problem, values_, count);
  }

  template <typename Value>
  Value* packedLine(std::vector<Value>& features, int feature) const {
    return features.data() + static_cast<std::size_t>(feature) * pitch_;
  }

  template <typename Value>
  void evaluate(const Problem& problem, std::vector<Value>& features, int count) {
    std::array<const Value*, kFeatureCount> lines{};
    for (int f = 0; f < kFeatureCount; ++f) {
      lines[f] = packedLine(features, f);
    }
    if (count > 0) {
      problem.evaluator.evaluate(lines, count, packed_.data());
    }
  }

  /// Back to lines of a disparity each.
  void unpack(const SearchSpace& space) {
    forPacked(space, [&](int i, const ColumnSpan& span, int place) {
      std::memcpy(line(space, i) + span.begin, packed_.data() + place,
                  static_cast<std::size_t>(span.end - span.begin));
    });
  }

  std::uint8_t* line(const SearchSpace& space, int i) {
    return lines_.data() + static_cast<std::size_t>(i) * space.width();
  }

  void store(const SearchSpace& space, int y, WindowedMatchingVolume& volume) {
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      const int first = t * kTileColumns;
      for (int k = 0; k < tile.count; ++k) {
        const ColumnSpan inside = matchedColumns(space.width(), space.range().min + tile.indices[k]);
        const int begin = std::clamp(inside.begin - first, 0, kTileColumns);
        const int end = std::clamp(inside.end - first, begin, kTileColumns);
        std::uint8_t* entry = volume.entry(tile.first_entry + k);
        const std::uint8_t* costs = line(space, tile.indices[k]) + first;
        std::fill(entry, entry + begin, kOutsideCost);
        std::copy(costs + begin, costs + end, entry + begin);
        std::fill(entry + end, entry + kTileColumns, kOutsideCost);
      }
    }
  }

  MatcherSet::Scratch scratch_;
  MatcherCosts costs_;
  std::array<RowTerms, kMatcherCount> terms_;
  RowSpans spans_;
  std::size_t pitch_ = 0;  ///< of a feature's line
  std::vector<float> values_;
  std::vector<std::uint8_t> codes_;
  std::vector<std::uint8_t> packed_;  ///< costs
  std::vector<std::uint8_t> lines_;   ///< costs, [d][x]
};

/// Of the row that has most.
std::size_t mostHypotheses(const SearchSpace& space) {
  std::size_t most = 0;
  for (int y = 0; y < space.height(); ++y) {
    const SearchSpace::Tile last = space.tile(y, space.tiles() - 1);
    const std::size_t entries = last.first_entry + last.count - space.tile(y, 0).first_entry;
    most = std::max(most, entries * kTileColumns);
  }
  return most;
}

}  // namespace

class WindowedVolumeBuilder::Impl {
 public:
  MatcherSet matchers;
  PerThread<RowScorer> scorers;
};

WindowedVolumeBuilder::WindowedVolumeBuilder() : impl_(std::make_unique<Impl>()) {}
WindowedVolumeBuilder::~WindowedVolumeBuilder() = default;

void WindowedVolumeBuilder::build(const cv::Mat& left, const cv::Mat& right,
                                  const SearchSpace& space, const Forest& forest,
                                  const ForestEvaluator& evaluator,
                                  WindowedMatchingVolume& volume) {
  volume.resize(space);
  const Problem problem{impl_->matchers, space, forest, evaluator, askedMatchers(forest)};
  impl_->matchers.prepare(left, right, problem.asked);
  const std::size_t most = mostHypotheses(space);
  impl_->scorers.prepare([&](RowScorer& scorer) { scorer.reserve(problem, most); });
  tbb::parallel_for(0, space.height(),
                    [&](int y) { impl_->scorers.local().score(problem, y, volume); });
}

}  // namespace cbmv
