#include "tuning/tuning.h"

#include <cmath>

#include <gtest/gtest.h>

#include "evaluation/folds.h"
#include "forest/forest_file.h"
#include "support/error_text.h"
#include "support/rendered_data_set.h"
#include "support/temporary_folder.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

/// Noisy rendered scenes with names from Middlebury, one in each fold, and a bad preset.
class TuningTest : public testing::Test {
 protected:
  TuningTest() {
    RenderOptions noisy;
    noisy.noise_sigma = 24;
    int seed = 0;
    for (const char* name : {"Teddy", "ArtL", "Piano"}) {
      writeScene(folder_.file("data/") + name, renderScene(96, 48, ++seed, noisy));
    }
    request_.scenes = chooseScenes({DataSet::open("middlebury_v3:" + folder_.file("data"))}, {});
    Forest forest = readForest(CBMV_SOURCE_DIR "/models/middlebury.forest");
    forest.provenance.scenes.clear();  // the rendered scenes are different
    request_.forests = {std::make_shared<Forest>(forest)};
    request_.objectives = {"bad_1"};
    request_.parameters = {"P1", "P2", "cbca_iterations_after"};
    request_.start.sgm.p1 = 0.05F;
    request_.start.sgm.p2 = 0.5F;
    request_.start.aggregation.iterations_after = 0;
    request_.search.evaluations = 25;
    events_.progress = [this](const std::string& line) { lines_.push_back(line); };
    events_.improved = [this](const TuningReport& report) { reports_.push_back(report); };
  }

  TuningReport run() { return tune(request_, events_); }

  const TemporaryFolder folder_;
  TuningRequest request_;
  TuningEvents events_;
  std::vector<std::string> lines_;
  std::vector<TuningReport> reports_;
};

TEST_F(TuningTest, ImprovesABadPreset) {
  const TuningReport report = run();
  ASSERT_EQ(report.data_sets.size(), 1U);
  const TunedDataSet& data_set = report.data_sets[0];
  EXPECT_LT(data_set.after, 0.95 * data_set.before);
  EXPECT_EQ(data_set.scenes, (std::vector<std::string>{"ArtL", "Piano", "Teddy"}));
  EXPECT_TRUE(std::isnan(data_set.cross_validated));
  EXPECT_EQ(report.evaluations, 25);
  EXPECT_EQ(lines_.size(), 3U + 25U);
  ASSERT_GE(reports_.size(), 3U);
  EXPECT_EQ(reports_[0].data_sets[0].after, data_set.before) << "the start at first";
  for (std::size_t i = 1; i < reports_.size(); ++i) {
    EXPECT_LE(reports_[i].data_sets[0].after, reports_[i - 1].data_sets[0].after);
  }
  EXPECT_EQ(presetText(reports_.back()), presetText(report));

  request_.start = report.options;  // the second search starts from the result of the first
  request_.search.evaluations = 1;
  EXPECT_EQ(run().data_sets[0].before, data_set.after);
}

TEST_F(TuningTest, DoesNotDependOnThreads) {
  request_.search = {12, 5, 3};
  request_.start.threads = 1;
  const std::string expected = presetText(run());
  request_.start.threads = 3;
  EXPECT_EQ(presetText(run()), expected);
}

TEST_F(TuningTest, CrossValidationScoresEachFoldWithWhatTheOthersFound) {
  request_.cross_validate = true;
  request_.search.evaluations = 8;
  const TuningReport report = run();
  double sum = 0;
  const std::vector<SceneReference> all = request_.scenes;
  request_.cross_validate = false;
  for (std::size_t held_out = 0; held_out < all.size(); ++held_out) {
    TuningRequest others = request_;
    others.scenes.erase(others.scenes.begin() + static_cast<long>(held_out));
    TuningRequest check = request_;
    check.scenes = {all[held_out]};
    check.start = tune(others, events_).options;
    const HeldOutFold& fold = report.held_out_folds.at(foldOf(all[held_out].scene));
    EXPECT_EQ(fold.fold, foldOf(all[held_out].scene));
    EXPECT_EQ(describeOptions(fold.options), describeOptions(check.start));
    check.search.evaluations = 1;
    sum += tune(check, events_).data_sets[0].before;
  }
  EXPECT_NEAR(report.data_sets[0].cross_validated, sum / 3, 1e-9);
}

TEST_F(TuningTest, WeighsDataSetsByTheErrorAtTheStart) {
  writeScene(folder_.file("other/Mine"), renderScene(80, 40, 9));
  const DataSet other = DataSet::open("eth3d:" + folder_.file("other"));
  request_.scenes.push_back({other, "Mine"});
  request_.objectives = {"bad_1", "avg"};
  request_.search.evaluations = 2;
  const TuningReport report = run();
  ASSERT_EQ(report.data_sets.size(), 2U);
  EXPECT_EQ(report.data_sets[1].objective, "avg");
  EXPECT_EQ(report.data_sets[1].scenes, std::vector<std::string>{"Mine"});
  request_.cross_validate = true;
  EXPECT_TRUE(mentions(errorText([&] { run(); }), {"other", "Middlebury v3"}));
}

TEST_F(TuningTest, NamesWhatIsWrongWithTheRequest) {
  TuningRequest request = request_;
  request.objectives = {"bad_1", "bad_3"};
  EXPECT_TRUE(
      mentions(errorText([&] { tune(request, events_); }), {"2 objectives", "1 data sets"}));
  request = request_;
  request.parameters = {"P7"};
  EXPECT_TRUE(mentions(errorText([&] { tune(request, events_); }), {"P7"}));
  request = request_;
  request.cross_validate = true;
  request.scenes = {request_.scenes.front()};
  EXPECT_TRUE(mentions(errorText([&] { tune(request, events_); }), {"two folds"}));
  EXPECT_TRUE(lines_.empty());
}

}  // namespace
}  // namespace cbmv
