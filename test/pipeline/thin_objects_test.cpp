#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/rendered_poles.h"
#include "forest/forest_file.h"

#include "cbmv_stereo/parameters.h"
#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {
namespace {

/// Objects that the coarse levels do not see, with the preset's forest. Checks every width; mean
/// over several depths.
TEST(ThinObjects, AreFoundAsByTheExhaustiveSearch) {
  const auto forest =
      std::make_shared<const Forest>(readForest(CBMV_SOURCE_DIR "/models/middlebury_small.forest"));
  std::map<int, double> full_recall;
  std::map<int, double> recall;
  const std::vector<std::pair<int, int>> depths = {{4, 24}, {4, 48}, {10, 20}};
  for (const auto& [far_px, near_px] : depths) {
    const RenderedPoles poles = renderPoles(far_px, near_px, 1);
    const auto disparityOf = [&](int levels) {
      StereoOptions options;
      readPreset(CBMV_SOURCE_DIR "/config/realtime.yaml", options);
      options.range = {0, 64};
      options.rectification.enabled = false;
      options.search.levels = levels;
      StereoMatcher matcher(forest, options);
      return matcher.match(poles.left, poles.right).disparity;
    };
    const cv::Mat full = disparityOf(0);
    const cv::Mat found = disparityOf(3);
    for (const int width : poleWidths()) {
      full_recall[width] += poleRecall(poles, width, full) / static_cast<double>(depths.size());
      recall[width] += poleRecall(poles, width, found) / static_cast<double>(depths.size());
    }
  }
  for (const int width : poleWidths()) {
    EXPECT_GT(recall[width], full_recall[width] - 0.03) << width << " px wide";
  }
  EXPECT_GT(full_recall[3], 0.8);
}

}  // namespace
}  // namespace cbmv
