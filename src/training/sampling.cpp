#include "cbmv_stereo/training/sampling.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/confidence/row_features.h"
#include "cbmv_stereo/matching/matcher_set.h"

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

/// Appends a uniform draw among the disparities [lowest, highest], cut to those whose match lies
/// inside, if there is one.
void drawWrong(const TrainingPair& pair, const cv::Point& pixel, int lowest, int highest,
               std::mt19937_64& random, std::vector<Hypothesis>& hypotheses) {
  lowest = std::max({lowest, pair.range.min, pixel.x - pair.left.cols + 1});
  highest = std::min({highest, pair.range.max(), pixel.x});
  if (lowest <= highest) {
    const int d = lowest + drawBelow(random, highest - lowest + 1);
    hypotheses.push_back({pixel.y, pixel.x, d - pair.range.min, 0});
  }
}

std::vector<Hypothesis> drawHypotheses(const TrainingPair& pair, const HeldOutBand& band,
                                       long pixels, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Hypothesis> hypotheses;
  for (const cv::Point& pixel : drawPixels(pair, band, pixels, random)) {
    const float truth = pair.truth.at<float>(pixel);
    const int correct = static_cast<int>(std::lround(truth));
    if (correct < pair.range.min || correct > pair.range.max() || pixel.x - correct < 0 ||
        pixel.x - correct >= pair.left.cols) {
      continue;
    }
    hypotheses.push_back({pixel.y, pixel.x, correct - pair.range.min, 1});
    drawWrong(pair, pixel, pair.range.min, static_cast<int>(std::ceil(truth - 1.0F)) - 1, random,
              hypotheses);
    drawWrong(pair, pixel, static_cast<int>(std::floor(truth + 1.0F)) + 1, pair.range.max(), random,
              hypotheses);
  }
  return hypotheses;
}

/// Writes the features of the hypotheses [begin, end), all of one row, from index `first` on.
void computeRowSamples(const MatcherSet& matchers, const TrainingPair& pair,
                       const RowEntries& entries, const Hypothesis* begin, const Hypothesis* end,
                       std::size_t first, RowFeatures& features, Samples& samples) {
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
      const int first_column = entries.entries()[places.begin].column;
      for (int f = 0; f < kFeatureCount; ++f) {
        samples.features[f][index] = features.line(f)[hypothesis->x - first_column];
      }
      samples.labels[index] = hypothesis->label;
    }
  }
}

}  // namespace

HeldOutBand::HeldOutBand(int rows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  begin = drawBelow(random, rows - rows / 10 + 1);
  end = begin + rows / 10;
}

void appendSamples(const TrainingPair& pair, long pixels, std::uint64_t seed, Samples& samples) {
  const HeldOutBand band(pair.left.rows, seed);
  const std::vector<Hypothesis> hypotheses = drawHypotheses(pair, band, pixels, seed);
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
  SearchSpace row;  // the same for all rows
  row.buildExhaustive(1, pair.left.cols, pair.range);
  RowEntries entries;
  entries.build(row, 0);
  tbb::enumerable_thread_specific<RowFeatures> features;
  tbb::parallel_for(0, pair.left.rows, [&](int y) {
    const auto before_row = [](const Hypothesis& h, int row) { return h.y < row; };
    const auto begin = std::lower_bound(hypotheses.begin(), hypotheses.end(), y, before_row);
    const auto end = std::lower_bound(begin, hypotheses.end(), y + 1, before_row);
    if (begin != end) {
      const auto offset = static_cast<std::size_t>(begin - hypotheses.begin());
      computeRowSamples(matchers, pair, entries, hypotheses.data() + offset,
                        hypotheses.data() + offset + (end - begin), first + offset,
                        features.local(), samples);
    }
  });
}

}  // namespace cbmv
