#include "tuning/tuning_scene.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

#include "evaluation/disparity_source.h"
#include "evaluation/scene_score.h"
#include "support/error_text.h"
#include "support/random_forest.h"
#include "support/rendered_data_set.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

std::shared_ptr<const Forest> forestOf(const std::string& name, const std::string& data_set,
                                       const std::vector<std::string>& scenes) {
  Forest forest = test::makeForest(8, 5, 3);
  forest.name = name;
  forest.provenance.data_set = data_set;
  forest.provenance.scenes = scenes;
  return std::make_shared<Forest>(forest);
}

/// Two rendered scenes; One has a vertical offset.
class TuningSceneTest : public testing::Test {
 protected:
  TuningSceneTest() {
    RenderOptions shifted;
    shifted.vertical_offset = 1.2;
    writeScene(folder_.file("One"), renderScene(160, 101, 1, shifted));
    writeScene(folder_.file("Two"), renderScene(97, 40, 2));
    scenes_ = chooseScenes({DataSet::open("middlebury_v3:" + folder_.file(""))}, {});
  }

  const TemporaryFolder folder_;
  std::vector<SceneReference> scenes_;
  const std::shared_ptr<const Forest> forest_ = forestOf("any", "none", {});
};

TEST_F(TuningSceneTest, ErrorIsThatOfTheWholeMatcher) {
  TuningScorer scorer;
  StereoOptions options;
  options.sgm.p2 = 4;
  for (const char* objective : {"bad_0.5", "bad_1+bad_4", "avg"}) {
    for (const SceneReference& reference : scenes_) {
      TuningScene scene = prepareScene(reference, forest_, options.rectification, 0);
      scene.errors = parseErrorSum(objective);
      const StereoScene pair = reference.read();
      const SceneScore score = scoreScene(pair, matchingSource(forest_, options)(pair));
      const double expected = std::map<std::string, double>{
          {"bad_0.5", score.noc[0]},
          {"bad_1+bad_4", score.noc[1] + score.noc[4]},
          {"avg", score.noc[6]}}.at(objective);
      EXPECT_EQ(scorer.error(scene, options), expected) << reference.scene;
      EXPECT_EQ(scorer.error(scene, options), expected) << "again";
    }
  }
}

TEST_F(TuningSceneTest, KeepsTheMiddleRows) {
  const TuningScene whole = prepareScene(scenes_[0], forest_, {}, 0);
  const TuningScene part = prepareScene(scenes_[0], forest_, {}, 31);
  ASSERT_EQ(part.scene.left.size(), cv::Size(160, 31));
  const auto middle = [](const cv::Mat& map) { return map.rowRange(35, 66); };
  EXPECT_EQ(cv::norm(part.scene.left, middle(whole.scene.left), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(part.scene.right, middle(whole.scene.right), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(part.scene.truth, middle(whole.scene.truth), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(part.scene.visible, middle(whole.scene.visible), cv::NORM_INF), 0);
  EXPECT_EQ(prepareScene(scenes_[0], forest_, {}, 500).scene.left.rows, 101);
}

TEST_F(TuningSceneTest, CountsTheMemoryOfEarlierScenes) {
  const TuningScene scene = prepareScene(scenes_[0], forest_, {}, 0);
  EXPECT_NEAR(scene.heldMb(), 160.0 * 101 * 7 / (1 << 20), 1e-9);
  EXPECT_TRUE(mentions(errorText([&] { prepareScene(scenes_[0], forest_, {}, 0, 1e12); }),
                       {"scene One", "those before it need 1000000000", "but the machine has"}));
}

TEST_F(TuningSceneTest, TakesAForestThatDidNotSeeTheScene) {
  const std::string title = scenes_[0].data_set.title();
  const auto saw_one = forestOf("a", title, {"One", "Three"});
  const auto saw_two = forestOf("b", "another, " + title, {"Two"});
  const auto saw_namesake = forestOf("c", "another", {"Two"});
  EXPECT_EQ(forestForScene({saw_one, saw_two}, scenes_[0]), saw_two);
  EXPECT_EQ(forestForScene({saw_one, saw_two}, scenes_[1]), saw_one);
  EXPECT_EQ(forestForScene({saw_namesake}, scenes_[1]), saw_namesake);
  EXPECT_TRUE(mentions(errorText([&] { forestForScene({saw_two}, scenes_[1]); }),
                       {folder_.file(""), "scene Two", "trained"}));
}

TEST_F(TuningSceneTest, NamesWhatIsWrong) {
  EXPECT_TRUE(
      mentions(errorText([] { parseErrorSum("bad_1+bad_7"); }), {"bad_7", "bad_0.5", "avg"}));
  EXPECT_TRUE(mentions(errorText([] { parseErrorSum("auc"); }), {"auc", "rms"}));
  EXPECT_TRUE(mentions(errorText([] { parseErrorSum("sigma_rms"); }), {"sigma_rms", "a99"}));
  TuningScene scene = prepareScene(scenes_[1], forest_, {}, 0);
  scene.scene.visible.setTo(0);
  EXPECT_TRUE(mentions(errorText([&] { TuningScorer().error(scene, {}); }), {"scene Two"}));
  writeImage(folder_.file("Two/im1.png"), cv::Mat::zeros(3, 3, CV_8UC1));
  EXPECT_TRUE(mentions(errorText([&] { prepareScene(scenes_[1], forest_, {}, 0); }), {"im1.png"}));
}

}  // namespace
}  // namespace cbmv
