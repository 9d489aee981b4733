#include "training/cross_validation.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/image_file.h"
#include "io/pfm.h"
#include "support/error_text.h"
#include "support/rendered_stereo_scene.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

/// A data set of rendered scenes with names from Middlebury.
class FoldSource : public testing::Test {
 protected:
  std::vector<SceneReference> write(const std::vector<std::string>& names) const {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const StereoScene scene = makeScene(static_cast<int>(i));
      const std::string base = folder_.file(names[i]) + "/";
      std::filesystem::create_directory(base);
      writeImage(base + "im0.png", scene.left);
      writeImage(base + "im1.png", scene.right);
      writePfm(base + "disp0GT.pfm", scene.truth);
      writeMiddleburyCalibration(base + "calib.txt", {500, 32, 32, 16, 0.1, 64, 32, 20});
    }
    return chooseScenes({DataSet::open("middlebury_v3:" + folder_.file(""))}, {});
  }

  const TemporaryFolder folder_;
};

TEST_F(FoldSource, MatchesWithAForestThatSawTheOtherFoldsOnly) {
  const std::vector<SceneReference> scenes = write({"Teddy", "Recycle", "ArtL", "Piano"});
  TrainingOptions training;
  training.boosting.trees = 3;
  training.boosting.depth = 3;
  training.pixels_per_scene = 500;
  training.second.enabled = false;  // its messages are not checked here
  std::string log;
  const DisparitySource source =
      foldSource(scenes, training, std::vector<StereoOptions>(1),
                 [&](const std::string& line) { log += line.substr(0, line.find(',')) + "\n"; });
  const std::string trained = "tree 3 of 3\n";
  const auto run = [&](const SceneReference& scene) {
    log.clear();
    const SceneMaps maps = source(scene.read());
    EXPECT_EQ(maps.disparity.size(), cv::Size(64, 32));
    return log;
  };
  EXPECT_EQ(run(scenes[2]),
            "training the forest of fold 1\nsampled ArtL\nsampled Piano\n" + trained);
  EXPECT_EQ(run(scenes[3]), "");  // Teddy, same fold as Recycle
  EXPECT_EQ(run(scenes[0]),
            "training the forest of fold 2\nsampled Piano\nsampled Recycle\n"
            "sampled Teddy\n" +
                trained);
  const auto forest = std::make_shared<Forest>(
      trainOnScenes({scenes[0], scenes[2], scenes[3]}, training, [](const std::string&) {}));
  EXPECT_TRUE(same(source(scenes[1].read()).disparity,
                   matchingSource(forest, {})(scenes[1].read()).disparity));
}

TEST_F(FoldSource, NeedsScenesOfOtherFolds) {
  const std::vector<SceneReference> scenes = write({"Teddy", "Recycle"});
  const std::vector<StereoOptions> options(1);
  const DisparitySource source = foldSource(scenes, {}, options, [](const std::string&) {});
  EXPECT_TRUE(mentions(errorText([&] { source(scenes[0].read()); }), {"fold 1", "no scene"}));
  EXPECT_TRUE(mentions(errorText([&] { foldSource(write({"Other"}), {}, options, nullptr); }),
                       {"scene Other"}));
  EXPECT_TRUE(
      mentions(errorText([&] { foldSource(scenes, {}, std::vector<StereoOptions>(2), nullptr); }),
               {"2 presets", "three"}));
}

}  // namespace
}  // namespace cbmv
