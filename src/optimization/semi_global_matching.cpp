#include "optimization/semi_global_matching.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/per_thread.h"
#include "optimization/dense_sgm_paths.h"

namespace cbmv {
namespace {

/// Number of columns that vertical paths process together. It is large enough to read whole pages,
/// and small enough to keep two rows of path costs in the caches near the core.
constexpr int kColumnsPerBlock = 64;
/// Rows per thread in a band: enough to keep all threads busy between two synchronizations.
constexpr int kRowsPerThread = 4;

}  // namespace

class SemiGlobalMatcher::Impl {
 public:
  template <typename Cost>
  void match(const Volume<Cost>& costs, const EdgeImages& images, const cv::Mat& surface, View view,
             const DisparityRange& range, const SgmOptions& options, AggregatedVolume& mean) {
    const cv::Size size(costs.width(), costs.height());
    CV_Assert(images.reference.type() == CV_8UC1 && images.reference.size() == size);
    CV_Assert(images.other.type() == CV_8UC1 && images.other.size() == size);
    CV_Assert(costs.disparities() == range.count);
    checkSgmOptions(options);

    mean.resize(costs.height(), costs.width(), costs.disparities());
    setup_.view = view;
    setup_.range = range;
    setup_.width = size.width;
    setup_.height = size.height;
    setup_.horizontal = makePenalties(options, 1.0);
    setup_.vertical = makePenalties(options, options.alpha1);
    findEdges(images.reference, images.reference_threshold_gray, setup_.reference);
    findEdges(images.other, images.other_threshold_gray, setup_.other);
    takeSurface(surface, size);
    preparePaths();
    addPaths(costs, mean);
  }

 private:
  void takeSurface(const cv::Mat& surface, const cv::Size& size) {
    if (surface.empty()) {
      setup_.surface.release();
    } else {
      CV_Assert(surface.type() == CV_16SC1 && surface.size() == size);
      setup_.surface.create(size.height + 2, size.width + 2, CV_16SC1);
      tbb::parallel_for(0, size.height + 2, [&](int row) {
        auto* out = setup_.surface.ptr<std::int16_t>(row);
        std::fill_n(out, size.width + 2, kNoSurface);
        if (row >= 1 && row <= size.height) {
          std::copy_n(surface.ptr<std::int16_t>(row - 1), size.width, out + 1);
        }
      });
    }
  }

  void preparePaths() {
    const int width = setup_.width;
    blocks_.resize((width + kColumnsPerBlock - 1) / kColumnsPerBlock);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const int x = static_cast<int>(i) * kColumnsPerBlock;
      blocks_[i].resize(setup_, cv::Range(x, std::min(x + kColumnsPerBlock, width)));
    }
    rows_.prepare([&](DenseRowPaths& paths) { paths.resize(setup_); });
  }

  /// Passes over the volumes twice. Downward in bands of rows: first along the rows, then along the
  /// columns while the band is in the cache. Upward along the columns.
  template <typename Cost>
  void addPaths(const Volume<Cost>& costs, AggregatedVolume& sums) {
    const int height = setup_.height;
    const int band_rows = kRowsPerThread * static_cast<int>(threadCount());
    for (int first = 0; first < height; first += band_rows) {
      const cv::Range band(first, std::min(first + band_rows, height));
      tbb::parallel_for(band.start, band.end, [&](int y) { rows_.local().run(costs, y, sums); });
      tbb::parallel_for(std::size_t{0}, blocks_.size(),
                        [&](std::size_t i) { blocks_[i].runDown(costs, band, sums); });
    }
    tbb::parallel_for(std::size_t{0}, blocks_.size(),
                      [&](std::size_t i) { blocks_[i].runUp(costs, sums); });
  }

  DensePathSetup setup_;
  std::vector<DenseColumnPaths> blocks_;
  PerThread<DenseRowPaths> rows_;
};

SemiGlobalMatcher::SemiGlobalMatcher() : impl_(std::make_unique<Impl>()) {}
SemiGlobalMatcher::~SemiGlobalMatcher() = default;

void SemiGlobalMatcher::match(const AggregatedVolume& costs, const EdgeImages& images,
                              const cv::Mat& surface, View view, const DisparityRange& range,
                              const SgmOptions& options, AggregatedVolume& mean) {
  CV_Assert(&costs != &mean);
  impl_->match(costs, images, surface, view, range, options, mean);
}

void SemiGlobalMatcher::match(const MatchingVolume& costs, const EdgeImages& images,
                              const cv::Mat& surface, View view, const DisparityRange& range,
                              const SgmOptions& options, AggregatedVolume& mean) {
  impl_->match(costs, images, surface, view, range, options, mean);
}

}  // namespace cbmv
