#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// Where a proposed disparity is from.
enum class Source : std::uint8_t { kPixel, kLeft, kRight, kAbove, kBelow };
inline constexpr int kSources = 5;

/// Disparities of the nearest confident pixels, per column of a row.
struct NeighborRow {
  const std::int16_t* disparity;  ///< kNoNeighbor if there is none
  const std::uint8_t* distance;   ///< px, at most 255
};

/// Finds the nearest pixels on the left, on the right, above and below whose confidence is at least
/// kConfident. A confident pixel is its own nearest pixel. The object keeps its memory from map to
/// map.
class ConfidentNeighbors {
 public:
  static constexpr std::uint8_t kConfident = 204;  ///< in 1/255: 0.8
  static constexpr std::int16_t kNoNeighbor = INT16_MIN;

  /// Memory for the neighbors of a row.
  struct RowMemory {
    void resize(int width);

    std::vector<std::int16_t> left;
    std::vector<std::int16_t> right;
    std::vector<std::uint8_t> left_distance;
    std::vector<std::uint8_t> right_distance;
  };

  /// `disparity` is CV_16SC1, `confidence` is CV_8UC1. Neither may change afterwards. Parallel
  /// over columns by oneTBB.
  void find(const cv::Mat& disparity, const cv::Mat& confidence);

  NeighborRow above(int y) const { return row(above_, above_distance_, y); }
  NeighborRow below(int y) const { return row(below_, below_distance_, y); }
  /// Finds the left and right neighbors of row `y`. `memory` has the width of the maps.
  void findOnRow(int y, RowMemory& memory) const;

 private:
  static NeighborRow row(const cv::Mat& disparity, const cv::Mat& distance, int y) {
    return {disparity.ptr<std::int16_t>(y), distance.ptr<std::uint8_t>(y)};
  }

  cv::Mat disparity_;
  cv::Mat confidence_;
  cv::Mat above_;
  cv::Mat above_distance_;
  cv::Mat below_;
  cv::Mat below_distance_;
};

}  // namespace cbmv
