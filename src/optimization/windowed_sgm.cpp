#include "optimization/windowed_sgm.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/per_thread.h"
#include "optimization/sgm_penalties.h"
#include "optimization/windowed_sgm_columns.h"
#include "optimization/windowed_sgm_paths.h"
#include "optimization/windowed_sgm_rows.h"

namespace cbmv {
namespace {

/// Smallest number of tiles that vertical paths process together. The number is larger if there are
/// still enough blocks for all threads and two rows of path costs stay in the caches near the core.
constexpr int kTilesPerBlock = 4;
constexpr int kBlocksPerThread = 2;
constexpr std::size_t kFrontBytes = std::size_t{1} << 15;
/// Bands have at least one group of rows per thread. They are larger if the costs and sums of the
/// band stay in the caches.
constexpr std::size_t kBandBytesPerThread = std::size_t{1} << 18;

}  // namespace

class WindowedSgm::Impl {
 public:
  template <typename Cost>
  void match(const SearchSpace& space, const WindowedVolume<Cost>& costs, const EdgeImages& images,
             const cv::Mat& surface, View view, const SgmOptions& options,
             WindowedAggregatedVolume& mean) {
    const cv::Size size(space.width(), space.height());
    CV_Assert(images.reference.type() == CV_8UC1 && images.reference.size() == size);
    CV_Assert(images.other.type() == CV_8UC1 && images.other.size() == size);
    CV_Assert(surface.empty() || (surface.type() == CV_16SC1 && surface.size() == size));
    CV_Assert(costs.entries() == space.entries());
    checkSgmOptions(options);

    mean.resize(space);
    horizontal_.space = vertical_.space = &space;
    horizontal_.penalties = makePenalties(options, 1.0);
    vertical_.penalties = makePenalties(options, options.alpha1);
    horizontal_.steps.find(images, surface, view, space, StepMap::Axis::kHorizontal);
    vertical_.steps.find(images, surface, view, space, StepMap::Axis::kVertical);
    preparePaths(space);
    addPaths(space, costs, mean);
  }

 private:
  void preparePaths(const SearchSpace& space) {
    const int tiles = space.tiles();
    const int block_tiles = blockTiles(space);
    used_blocks_ = static_cast<std::size_t>((tiles + block_tiles - 1) / block_tiles);
    blocks_.resize(std::max(blocks_.size(), used_blocks_));
    tbb::parallel_for(std::size_t{0}, used_blocks_, [&](std::size_t i) {
      const int first = static_cast<int>(i) * block_tiles;
      blocks_[i].resize(vertical_, cv::Range(first, std::min(first + block_tiles, tiles)));
    });
    rows_.prepare([&](RowPaths& paths) { paths.resize(horizontal_); });
  }

  /// Passes over the volumes twice. Downward in bands of rows: first along the rows, then along the
  /// columns while the band is in the cache. Upward along the columns.
  template <typename Cost>
  void addPaths(const SearchSpace& space, const WindowedVolume<Cost>& costs,
                WindowedAggregatedVolume& sums) {
    const int height = space.height();
    const int band_rows = bandRows(space, sizeof(Cost) + sizeof(std::uint16_t));
    for (int first = 0; first < height; first += band_rows) {
      const cv::Range band(first, std::min(first + band_rows, height));
      tbb::parallel_for(band.start, band.end, RowPaths::kRowsAtOnce, [&](int y) {
        rows_.local().run(costs, {y, std::min(y + RowPaths::kRowsAtOnce, band.end)}, sums);
      });
      tbb::parallel_for(std::size_t{0}, used_blocks_,
                        [&](std::size_t i) { blocks_[i].runDown(costs, band, sums); });
    }
    tbb::parallel_for(std::size_t{0}, used_blocks_,
                      [&](std::size_t i) { blocks_[i].runUp(costs, sums); });
  }

  static int blockTiles(const SearchSpace& space) {
    const std::size_t tiles = static_cast<std::size_t>(space.tiles()) * space.height();
    const std::size_t bytes = 2 * space.entries() * kTileColumns * sizeof(std::uint16_t);
    const auto fitting = kFrontBytes * tiles / std::max<std::size_t>(1, bytes);
    const auto sharing = space.tiles() / (kBlocksPerThread * threadCount());
    return std::max(kTilesPerBlock, static_cast<int>(std::min(fitting, sharing)));
  }

  static int bandRows(const SearchSpace& space, std::size_t hypothesis_bytes) {
    const std::size_t row_bytes =
        space.entries() * kTileColumns * hypothesis_bytes / std::max(1, space.height());
    const std::size_t most_rows = std::max(1, space.height());
    const auto fitting = static_cast<int>(
        std::min(most_rows, kBandBytesPerThread / std::max<std::size_t>(1, row_bytes)));
    const int groups = std::max(1, fitting / RowPaths::kRowsAtOnce);
    return groups * RowPaths::kRowsAtOnce * static_cast<int>(threadCount());
  }

  PathSetup horizontal_;
  PathSetup vertical_;
  std::vector<ColumnPaths> blocks_;
  std::size_t used_blocks_ = 0;  ///< blocks used for the current volume
  PerThread<RowPaths> rows_;
};

WindowedSgm::WindowedSgm() : impl_(std::make_unique<Impl>()) {}
WindowedSgm::~WindowedSgm() = default;

void WindowedSgm::match(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                        const EdgeImages& images, const cv::Mat& surface, View view,
                        const SgmOptions& options, WindowedAggregatedVolume& mean) {
  CV_Assert(&costs != &mean);
  impl_->match(space, costs, images, surface, view, options, mean);
}

void WindowedSgm::match(const SearchSpace& space, const WindowedMatchingVolume& costs,
                        const EdgeImages& images, const cv::Mat& surface, View view,
                        const SgmOptions& options, WindowedAggregatedVolume& mean) {
  impl_->match(space, costs, images, surface, view, options, mean);
}

}  // namespace cbmv
