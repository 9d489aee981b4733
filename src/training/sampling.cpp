#include "training/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "confidence/row_features.h"
#include "matching/matcher_set.h"
#include "volume/coarse_volume.h"

namespace cbmv {
namespace {

struct Hypothesis {
  int y, x, i;
  std::uint8_t label;
};

/// Uniform in [0, bound): the same numbers with every standard library.
int drawBelow(std::mt19937_64& random, int bound) {
  return static_cast<int>(random() % static_cast<std::uint64_t>(bound));
}

std::vector<cv::Point> drawPixels(const TrainingPair& pair, const HeldOutBand& band, long pixels,
                                  std::mt19937_64& random) {
  std::vector<cv::Point> candidates;
  for (int y = 0; y < pair.truth.rows; ++y) {
    if (band.isMargin(y)) {
      continue;
    }
    for (int x = 0; x < pair.truth.cols; ++x) {
      if (pair.mask.at<std::uint8_t>(y, x) == 255 && std::isfinite(pair.truth.at<float>(y, x))) {
        candidates.emplace_back(x, y);
      }
    }
  }
  const auto wanted = std::min<std::size_t>(candidates.size(), static_cast<std::size_t>(pixels));
  for (std::size_t k = 0; k < wanted; ++k) {  // partial Fisher-Yates shuffle
    std::swap(candidates[k],
              candidates[k + static_cast<std::size_t>(random() % (candidates.size() - k))]);
  }
  candidates.resize(wanted);
  std::sort(candidates.begin(), candidates.end(), [](const cv::Point& a, const cv::Point& b) {
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  });
  return candidates;
}

/// Disparities of a pixel's list whose match lies inside, as indices, by their place to the truth.
struct Candidates {
  std::vector<int> below;  ///< wrong
  std::vector<int> above;
  bool has_correct = false;
};

void findCandidates(const TrainingPair& pair, const SearchSpace::Tile& tile, int x, float truth,
                    Candidates& found) {
  found.below.clear();
  found.above.clear();
  found.has_correct = false;
  const int correct = static_cast<int>(std::lround(truth));
  for (int k = 0; k < tile.count; ++k) {
    const int d = pair.range.min + tile.indices[k];
    if (x - d < 0 || x - d >= pair.left.cols) {
      continue;
    }
    found.has_correct |= d == correct;
    if (static_cast<float>(d) < truth - 1.0F) {
      found.below.push_back(tile.indices[k]);
    } else if (static_cast<float>(d) > truth + 1.0F) {
      found.above.push_back(tile.indices[k]);
    }
  }
}

/// Whether the true disparity is in the range and its match inside of the right image.
bool canMatch(const TrainingPair& pair, const cv::Point& pixel) {
  const int correct = static_cast<int>(std::lround(pair.truth.at<float>(pixel)));
  return correct >= pair.range.min && correct <= pair.range.max() && pixel.x - correct >= 0 &&
         pixel.x - correct < pair.left.cols;
}

/// Where the correct disparity is not in the list, the wrong ones are drawn all the same: the
/// search asks about them.
std::vector<Hypothesis> drawHypotheses(const TrainingPair& pair, const SearchSpace& space,
                                       const HeldOutBand& band, long pixels, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Hypothesis> hypotheses;
  Candidates candidates;
  for (const cv::Point& pixel : drawPixels(pair, band, pixels, random)) {
    if (!canMatch(pair, pixel)) {
      continue;
    }
    const float truth = pair.truth.at<float>(pixel);
    findCandidates(pair, space.tile(pixel.y, pixel.x / kTileColumns), pixel.x, truth, candidates);
    if (candidates.has_correct) {
      const int correct = static_cast<int>(std::lround(truth)) - pair.range.min;
      hypotheses.push_back({pixel.y, pixel.x, correct, 1});
    }
    for (const std::vector<int>* wrong : {&candidates.below, &candidates.above}) {
      if (!wrong->empty()) {
        const int i = (*wrong)[drawBelow(random, static_cast<int>(wrong->size()))];
        hypotheses.push_back({pixel.y, pixel.x, i, 0});
      }
    }
  }
  return hypotheses;
}

/// What a thread needs for a row.
struct RowBuffers {
  RowEntries entries;
  RowFeatures features;
};

/// Of the places of one disparity, that of the tile of column x.
int placeOf(const RowEntries& entries, const PlaceSpan& places, int x) {
  const RowEntries::Entry* all = entries.entries();
  const RowEntries::Entry* found = std::upper_bound(
      all + places.begin, all + places.end, x,
      [](int column, const RowEntries::Entry& entry) { return column < entry.column; });
  return static_cast<int>(found - all) - 1;
}

/// Writes the features of the hypotheses [begin, end), all of one row, from index `first` on.
void computeRowSamples(const MatcherSet& matchers, const TrainingPair& pair,
                       const SearchSpace& space, const Hypothesis* begin, const Hypothesis* end,
                       std::size_t first, RowBuffers& buffers, Samples& samples) {
  const RowEntries& entries = buffers.entries;
  RowFeatures& features = buffers.features;
  buffers.entries.build(space, begin->y);
  features.prepareRow(matchers, begin->y, pair.left.cols, entries);
  for (int i = 0; i < pair.range.count; ++i) {
    const PlaceSpan places = entries.places(i);
    bool computed = false;
    for (const Hypothesis* hypothesis = begin; hypothesis != end; ++hypothesis) {
      if (hypothesis->i != i) {
        continue;
      }
      if (!computed) {
        features.compute(places);
        computed = true;
      }
      const std::size_t index = first + static_cast<std::size_t>(hypothesis - begin);
      const int place = placeOf(entries, places, hypothesis->x);
      const int column =
          (place - places.begin) * kTileColumns + hypothesis->x - entries.entries()[place].column;
      for (int f = 0; f < kFeatureCount; ++f) {
        samples.features[f][index] = features.line(f)[column];
      }
      samples.labels[index] = hypothesis->label;
    }
  }
}

/// Sets one pixel of the pair at half the size from four of `pair`.
void halveTruth(const TrainingPair& pair, int x, int y, TrainingPair& half) {
  float lowest = std::numeric_limits<float>::infinity();
  float highest = -lowest;
  float sum = 0.0F;
  bool known = true;
  for (const cv::Point& pixel : {cv::Point(2 * x, 2 * y), cv::Point(2 * x + 1, 2 * y),
                                 cv::Point(2 * x, 2 * y + 1), cv::Point(2 * x + 1, 2 * y + 1)}) {
    const float truth = pair.truth.at<float>(pixel);
    known = known && pair.mask.at<std::uint8_t>(pixel) == 255 && std::isfinite(truth);
    lowest = std::min(lowest, truth);
    highest = std::max(highest, truth);
    sum += truth;
  }
  known = known && highest - lowest <= 2.0F;
  half.truth.at<float>(y, x) = known ? sum / 8.0F : std::numeric_limits<float>::infinity();
  half.mask.at<std::uint8_t>(y, x) = known ? 255 : 0;
}

}  // namespace

HeldOutBand::HeldOutBand(int rows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  begin = drawBelow(random, rows - rows / 10 + 1);
  end = begin + rows / 10;
}

TrainingPair halvePair(const TrainingPair& pair) {
  TrainingPair half;
  halveImage(pair.left, half.left);
  halveImage(pair.right, half.right);
  half.range = halveRange(pair.range);
  half.truth.create(half.left.size(), CV_32FC1);
  half.mask.create(half.left.size(), CV_8UC1);
  for (int y = 0; y < half.left.rows; ++y) {
    for (int x = 0; x < half.left.cols; ++x) {
      halveTruth(pair, x, y, half);
    }
  }
  return half;
}

void appendSamples(const TrainingPair& pair, const SearchSpace& space, const HeldOutBand& band,
                   long pixels, std::uint64_t seed, Samples& samples) {
  CV_Assert(space.height() == pair.left.rows && space.width() == pair.left.cols &&
            space.range().min == pair.range.min && space.range().count == pair.range.count);
  const std::vector<Hypothesis> hypotheses = drawHypotheses(pair, space, band, pixels, seed);
  const auto first = static_cast<std::size_t>(samples.count());
  for (std::vector<float>& column : samples.features) {
    column.resize(first + hypotheses.size());
  }
  samples.labels.resize(first + hypotheses.size());
  for (const Hypothesis& hypothesis : hypotheses) {
    samples.held_out.push_back(band.contains(hypothesis.y) ? 1 : 0);
  }

  MatcherSet matchers;
  matchers.prepare(pair.left, pair.right);
  tbb::enumerable_thread_specific<RowBuffers> buffers;
  tbb::parallel_for(0, pair.left.rows, [&](int y) {
    const auto before_row = [](const Hypothesis& h, int row) { return h.y < row; };
    const auto begin = std::lower_bound(hypotheses.begin(), hypotheses.end(), y, before_row);
    const auto end = std::lower_bound(begin, hypotheses.end(), y + 1, before_row);
    if (begin != end) {
      const auto offset = static_cast<std::size_t>(begin - hypotheses.begin());
      computeRowSamples(matchers, pair, space, hypotheses.data() + offset,
                        hypotheses.data() + offset + (end - begin), first + offset, buffers.local(),
                        samples);
    }
  });
}

void appendSamples(const TrainingPair& pair, long pixels, std::uint64_t seed, Samples& samples) {
  SearchSpace space;
  space.buildExhaustive(pair.left.rows, pair.left.cols, pair.range);
  appendSamples(pair, space, HeldOutBand(pair.left.rows, seed), pixels, seed, samples);
}

}  // namespace cbmv
