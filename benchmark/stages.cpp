#include "stages.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "confidence/features.h"
#include "forest/forest_evaluator.h"
#include "matching/matcher_set.h"
#include "matching/padded_image.h"
#include "optimization/prepared_image.h"
#include "optimization/semi_global_matching.h"
#include "optimization/sgm_penalties.h"
#include "optimization/support_arms.h"
#include "optimization/surface_prior.h"
#include "optimization/windowed_aggregation.h"
#include "optimization/windowed_sgm.h"
#include "optimization/windowed_winner_maps.h"
#include "optimization/windowed_winners.h"
#include "refinement/bilateral_filter.h"
#include "refinement/interpolation.h"
#include "refinement/left_right_check.h"
#include "refinement/median_filter.h"
#include "search/mutual_matches.h"
#include "search/search_windows.h"
#include "selection/map_selector.h"
#include "volume/coarse_volume.h"
#include "volume/windowed_right_view.h"
#include "volume/windowed_volume_builder.h"

#include "cbmv_stereo/stereo_matcher.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv::benchmarks {

struct StageData {
  explicit StageData(const Problem& problem);

  int middleRow() const { return pair.left.rows / 2; }
  int width() const { return pair.left.cols; }
  void match();
  void optimize();
  void refine();

  StereoOptions options;
  DisparityRange range;
  Pair pair;
  std::shared_ptr<const Forest> forest;
  ForestEvaluator evaluator;

  // Whole images:
  cv::Mat padded_left, padded_right;
  MatcherSet all_matchers;
  CensusMatcher census;
  NccMatcher ncc;
  ZeroMeanSadMatcher zero_mean_sad;
  SobelSadMatcher sobel_sad;
  StereoResult coarse;  ///< result for the pair at half size
  cv::Mat matches;
  SearchSpace space, right_space;
  WindowedMatchingVolume volume, right_volume;
  SupportArms arms;
  EdgeImages edges;
  WindowedAggregatedVolume aggregated, output;
  cv::Mat winners, right_winners, labels, disparity, confidence, margin;
  cv::Mat refined;  ///< disparities after filling and smoothing
  cv::Mat judged_confidence, sigma;
  cv::Mat map;  ///< output of stages that return a map
  VerticalOffset offset;

  // Memory of the stages:
  MutualMatcher mutual;
  SearchWindows windows;
  WindowedVolumeBuilder builder;
  WindowedRightView right_view;
  PerThread<WindowedRightWinnersRow> right_winner_rows;
  WindowedSgm sgm;
  WindowedAggregator aggregator;
  SurfacePrior surface_prior;
  std::unique_ptr<MapSelector> selector;  ///< null: the forest has no second forest
  cv::Mat padded;

  // The middle row:
  MatcherSet::Scratch scratch;
  MatcherCosts costs;
  std::array<RowTerms, kMatcherCount> terms;
  RowEntries entries;
  CodeBlock codes;                      ///< codes of the last places
  std::vector<std::uint8_t> row_costs;  ///< [place][column of the tile]
};

namespace {

void computeArms(const StageData& data, const cv::Mat& gray, cv::Mat& arms) {
  const AggregationOptions& options = data.options.aggregation;
  computeSupportArms(gray, options.arm_length_px, options.intensity_threshold * grayDeviation(gray),
                     arms);
}

void computeTerms(StageData& data) {
  for (int m = 0; m < kMatcherCount; ++m) {
    computeRowTerms(data.costs.rows()[m], data.entries, data.width(), kMatcherConstants[m],
                    data.terms[m]);
  }
}

/// Calls `use(places)` for all blocks of the row.
template <typename Use>
void forBlocks(const StageData& data, const Use& use) {
  for (int place = 0; place < data.entries.count(); place += CodeBlock::kPlaces) {
    use(PlaceSpan{place, std::min(place + CodeBlock::kPlaces, data.entries.count())});
  }
}

void computeAllCodes(StageData& data) {
  forBlocks(data, [&](const PlaceSpan& places) {
    for (int m = 0; m < kMatcherCount; ++m) {
      const int first = featureIndex(m, 0);
      computeCodes(data.costs.rows()[m], data.terms[m], data.entries, places, kMatcherConstants[m],
                   &data.forest->quantizer.maps[first], &data.codes.lines[first]);
    }
  });
}

/// Uses the same codes for every block, because the time does not depend on them.
void evaluateRow(StageData& data) {
  forBlocks(data, [&](const PlaceSpan& places) {
    data.evaluator.evaluate(data.codes, places.count() * kTileColumns,
                            &data.row_costs[static_cast<std::size_t>(places.begin) * kTileColumns]);
  });
}

template <typename Cost>
void addRow(const StageData& data, const CostRow<Cost>& costs, Checksum& sum) {
  for (int place = 0; place < data.entries.count(); ++place) {
    const RowEntries::Entry& entry = data.entries.entries()[place];
    sum.add(costs.entry(place) + entry.begin, (entry.end - entry.begin) * sizeof(Cost));
  }
}

void addTerms(const StageData& data, Checksum& sum) {
  for (const RowTerms& terms : data.terms) {
    for (const PixelTerms* view : {&terms.left, &terms.right}) {
      sum.add(view->log_sum.data() + PixelTerms::kBefore, data.width() * sizeof(float));
    }
  }
}

void addMap(const StageData& data, Checksum& sum) { sum.add(data.map); }

/// Adds the costs of the hypotheses inside both images.
template <typename Cost>
void addVolume(const SearchSpace& space, const WindowedVolume<Cost>& volume, View view,
               Checksum& sum) {
  for (int y = 0; y < space.height(); ++y) {
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      const int end = std::min((t + 1) * kTileColumns, space.width());
      for (int k = 0; k < tile.count; ++k) {
        for (int x = t * kTileColumns; x < end; ++x) {
          const int match = matchingColumn(view, x, space.range().min + tile.indices[k]);
          if (match >= 0 && match < space.width()) {
            sum.add(volume.entry(tile.first_entry + k) + x % kTileColumns, sizeof(Cost));
          }
        }
      }
    }
  }
}

void addOutput(const StageData& data, Checksum& sum) {
  addVolume(data.space, data.output, View::kLeft, sum);
}

void findWinnerMaps(StageData& data) {
  windowedWinnerMaps(data.space, data.aggregated, data.volume, data.options.refinement.subpixel,
                     {data.winners, data.disparity, data.confidence, data.margin});
}

}  // namespace

StageData::StageData(const Problem& problem)
    : options(presetOptions("quality", problem, 1)),
      range(problem.range()),
      pair(loadPair(problem)),
      forest(presetForest("quality")),
      evaluator(*forest) {
  match();
  padImage(pair.left, padded_left);
  padImage(pair.right, padded_right);
  all_matchers.prepare(pair.left, pair.right);
  census.prepare(padded_left, padded_right);
  ncc.prepare(padded_left, padded_right);
  zero_mean_sad.prepare(padded_left, padded_right);
  sobel_sad.prepare(padded_left, padded_right);
  entries.build(space, middleRow());
  all_matchers.computeRow(middleRow(), entries, allMatchers(), scratch, costs);
  computeTerms(*this);
  row_costs.resize(static_cast<std::size_t>(entries.count()) * kTileColumns);
  computeAllCodes(*this);
  optimize();
  refine();
}

/// Computes the search space and the volume at full size.
void StageData::match() {
  StereoOptions half = options;
  half.range = halveRange(range);
  half.search.levels = std::max(options.search.levels - 1, 0);
  Pair small;
  halveImage(pair.left, small.left);
  halveImage(pair.right, small.right);
  StereoMatcher(forest, half).match(small.left, small.right, {}, coarse);
  mutual.find(pair.left, pair.right, range, matches);
  windows.build(coarse.disparity, coarse.range.invalid(), matches, range, options.search, space);
  builder.build(pair.left, pair.right, space, *forest, evaluator, volume);
  right_view.build(space, volume, right_space, right_volume);
}

void StageData::optimize() {
  computeArms(*this, pair.left, arms.reference);
  computeArms(*this, pair.right, arms.other);
  arms.longest_px = options.aggregation.arm_length_px - 1;
  edges = {pair.left, pair.right, options.sgm.edge_threshold * grayDeviation(pair.left),
           options.sgm.edge_threshold * grayDeviation(pair.right)};
  sgm.match(space, volume, edges, {}, View::kLeft, options.sgm, aggregated);
}

void StageData::refine() {
  findWinnerMaps(*this);
  windowedRightWinners(space, aggregated, right_winner_rows, right_winners);
  leftRightCheck(winners, right_winners, range, options.refinement.max_left_right_difference_px,
                 labels);
  cv::Mat without_occlusions = disparity.clone();
  fillOcclusions(labels, range, without_occlusions);
  cv::Mat filled = without_occlusions.clone();
  fillMismatches(labels, range, without_occlusions, filled);
  medianFilter(filled, range, options.refinement.median_size_px, padded, refined);
  if (forest->confidence != nullptr) {
    selector = std::make_unique<MapSelector>(forest);
  }
}

std::shared_ptr<StageData> makeStageData(const Problem& problem) {
  return std::make_shared<StageData>(problem);
}

namespace {

using Unit = StageUnit;

std::vector<Stage> rowStages() {
  return {
      {"census", Unit::kRowHypotheses, 0, 45,
       [](StageData& s) {
         s.census.computeRow(s.middleRow(), s.entries, s.scratch.census, s.costs.census);
       },
       [](const StageData& s, Checksum& sum) { addRow(s, s.costs.census, sum); }},
      {"ncc", Unit::kRowHypotheses, 0, 52,
       [](StageData& s) { s.ncc.computeRow(s.middleRow(), s.entries, s.scratch.ncc, s.costs.ncc); },
       [](const StageData& s, Checksum& sum) { addRow(s, s.costs.ncc, sum); }},
      {"zero_mean_sad", Unit::kRowHypotheses, 0, 162,
       [](StageData& s) {
         s.zero_mean_sad.computeRow(s.middleRow(), s.entries, s.scratch.zero_mean_sad,
                                    s.costs.zero_mean_sad);
       },
       [](const StageData& s, Checksum& sum) { addRow(s, s.costs.zero_mean_sad, sum); }},
      {"sobel_sad", Unit::kRowHypotheses, 0, 40,
       [](StageData& s) {
         s.sobel_sad.computeRow(s.middleRow(), s.entries, s.scratch.sobel_sad, s.costs.sobel_sad);
       },
       [](const StageData& s, Checksum& sum) { addRow(s, s.costs.sobel_sad, sum); }},
      {"confidence_terms", Unit::kRowHypotheses, 0, 640, computeTerms, addTerms},
      {"feature_codes", Unit::kRowHypotheses, 0, 1280, computeAllCodes,
       [](const StageData& s, Checksum& sum) { sum.add(&s.codes, sizeof(s.codes)); }},
      {"forest", Unit::kRowHypotheses, 0, 1024, evaluateRow,
       [](const StageData& s, Checksum& sum) { sum.add(s.row_costs.data(), s.row_costs.size()); }}};
}

std::vector<Stage> searchStages() {
  return {{"rectification_estimate", Unit::kPixels, 2, 0,
           [](StageData& s) {
             s.offset = estimateVerticalOffset(s.pair.left, s.pair.right, s.range,
                                               s.options.rectification);
           },
           [](const StageData& s, Checksum& sum) { sum.add(&s.offset.offset_px, sizeof(double)); }},
          {"mutual_matches", Unit::kRangeHypotheses, 0, 0,
           [](StageData& s) { s.mutual.find(s.pair.left, s.pair.right, s.range, s.matches); },
           [](const StageData& s, Checksum& sum) { sum.add(s.matches); }},
          {"search_windows", Unit::kPixels, 3, 0,
           [](StageData& s) {
             s.windows.build(s.coarse.disparity, s.coarse.range.invalid(), s.matches, s.range,
                             s.options.search, s.space);
           },
           [](const StageData& s, Checksum& sum) {
             const std::size_t entries = s.space.entries();
             sum.add(&entries, sizeof(entries));
           }}};
}

std::vector<Stage> volumeStages() {
  return {
      {"matcher_preparation", Unit::kPixels, 28, 0,
       [](StageData& s) { s.all_matchers.prepare(s.pair.left, s.pair.right); },
       [](const StageData& s, Checksum& sum) { sum.add(s.padded_left); }},
      {"volume", Unit::kHypotheses, 1, 3243,
       [](StageData& s) {
         s.builder.build(s.pair.left, s.pair.right, s.space, *s.forest, s.evaluator, s.volume);
       },
       [](const StageData& s, Checksum& sum) { addVolume(s.space, s.volume, View::kLeft, sum); }},
      {"right_view", Unit::kHypotheses, 2, 0,
       [](StageData& s) { s.right_view.build(s.space, s.volume, s.right_space, s.right_volume); },
       [](const StageData& s, Checksum& sum) {
         addVolume(s.right_space, s.right_volume, View::kRight, sum);
       }}};
}

std::vector<Stage> optimizationStages() {
  return {{"surface_prior", Unit::kPixels, 2.75, 0,
           [](StageData& s) {
             s.surface_prior.estimate(s.coarse.disparity, s.coarse.range.invalid(),
                                      s.options.surface.reach_px, s.pair.left.size(), s.map);
           },
           addMap},
          {"support_arms", Unit::kPixels, 5, 0,
           [](StageData& s) { computeArms(s, s.pair.left, s.map); }, addMap},
          {"sgm_first", Unit::kHypotheses, 3, 0,
           [](StageData& s) {
             s.sgm.match(s.space, s.volume, s.edges, {}, View::kLeft, s.options.sgm, s.output);
           },
           addOutput},
          {"sgm_second", Unit::kHypotheses, 4, 0,
           [](StageData& s) {
             s.sgm.match(s.space, s.aggregated, s.edges, {}, View::kLeft, s.options.sgm, s.output);
           },
           addOutput},
          {"cbca", Unit::kHypotheses, 4, 0,
           [](StageData& s) {
             s.aggregator.aggregate(s.space, s.aggregated, sgmCostBound(s.options.sgm), s.arms,
                                    View::kLeft, s.output);
           },
           addOutput},
          {"winner_maps", Unit::kHypotheses, 3, 0, findWinnerMaps,
           [](const StageData& s, Checksum& sum) {
             sum.add(s.disparity);
             sum.add(s.confidence);
             sum.add(s.margin);
           }},
          {"right_winners", Unit::kHypotheses, 2, 0,
           [](StageData& s) {
             windowedRightWinners(s.space, s.aggregated, s.right_winner_rows, s.map);
           },
           addMap}};
}

std::vector<Stage> refinementStages() {
  return {{"left_right_check", Unit::kPixels, 9, 0,
           [](StageData& s) {
             leftRightCheck(s.winners, s.right_winners, s.range,
                            s.options.refinement.max_left_right_difference_px, s.map);
           },
           addMap},
          {"fill_occlusions", Unit::kPixels, 13, 0,
           [](StageData& s) {
             s.disparity.copyTo(s.map);
             fillOcclusions(s.labels, s.range, s.map);
           },
           addMap},
          {"fill_mismatches", Unit::kPixels, 13, 0,
           [](StageData& s) {
             s.disparity.copyTo(s.map);
             fillMismatches(s.labels, s.range, s.disparity, s.map);
           },
           addMap},
          {"median", Unit::kPixels, 8, 0,
           [](StageData& s) {
             medianFilter(s.disparity, s.range, s.options.refinement.median_size_px, s.padded,
                          s.map);
           },
           addMap},
          {"bilateral", Unit::kPixels, 8, 0,
           [](StageData& s) {
             bilateralFilter(s.disparity, s.range, s.options.refinement.bilateral_sigma_px,
                             s.options.refinement.bilateral_threshold_px, s.padded, s.map);
           },
           addMap}};
}

/// Copies the map if there is no second forest.
void selectMap(StageData& s) {
  s.refined.copyTo(s.map);
  s.confidence.copyTo(s.judged_confidence);
  if (s.selector != nullptr) {
    s.selector->select({s.map, s.right_winners, s.labels, s.judged_confidence, s.margin, s.range},
                       {}, {s.map, s.judged_confidence, s.sigma});
  }
}

std::vector<Stage> selectionStages() {
  return {{"selection", Unit::kPixels, 131, 0, selectMap, [](const StageData& s, Checksum& sum) {
             sum.add(s.map);
             sum.add(s.judged_confidence);
           }}};
}

std::vector<Stage> allStages() {
  std::vector<Stage> all;
  for (const auto& some : {searchStages(), rowStages(), volumeStages(), optimizationStages(),
                           refinementStages(), selectionStages()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace

double unitsOf(const Stage& stage, const StageData& data) {
  const double pixels = static_cast<double>(data.pair.left.total());
  switch (stage.unit) {
    case StageUnit::kPixels:
      return pixels;
    case StageUnit::kRangeHypotheses:
      return pixels * data.range.count;
    case StageUnit::kRowHypotheses:
      return static_cast<double>(data.entries.count()) * kTileColumns;
    case StageUnit::kHypotheses:
      return static_cast<double>(data.space.entries()) * kTileColumns;
  }
  return 0;
}

const std::vector<Stage>& stages() {
  static const std::vector<Stage> kStages = allStages();
  return kStages;
}

}  // namespace cbmv::benchmarks
