#include "training/forest_training.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "forest/forest_file.h"
#include "support/error_text.h"
#include "support/rendered_data_set.h"
#include "support/temporary_folder.h"

namespace cbmv::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Three rendered scenes.
class ForestTraining : public testing::Test {
 protected:
  ForestTraining() {
    for (int s = 0; s < 3; ++s) {
      writeScene(folder_.file("S" + std::to_string(s)), renderScene(100, 80, s));
    }
    scenes_ = chooseScenes({DataSet::open("middlebury_v3:" + folder_.file(""))}, {});
    options_.boosting.trees = 9;
    options_.boosting.depth = 3;
    options_.second.confidence.trees = 3;
    options_.second.selection.trees = 3;
    options_.random_forest.trees = 3;
    options_.random_forest.samples_per_leaf = 100;
  }

  const TemporaryFolder folder_;
  std::vector<SceneReference> scenes_;
  TrainingOptions options_;
};

void ignore(const TrainingStep& /*step*/) {}

TEST_F(ForestTraining, SharesTheSamplesAmongTheScenes) {
  options_.search.levels = 3;  // plus full size
  options_.max_samples = 12000;
  EXPECT_EQ(pixelsPerScene(10, options_), 100);
  EXPECT_EQ(pixelsPerScene(1, options_), 1000);
  options_.pixels_per_scene = 50;
  EXPECT_EQ(pixelsPerScene(10, options_), 50);
  EXPECT_TRUE(
      mentions(errorText([&] { pixelsPerScene(1001, options_); }), {"12012", "4 levels", "1001"}));
  options_.pixels_per_scene = 40000;
  options_.search.levels = 0;
  options_.max_samples = 3000;
  const Samples samples = drawSamples(scenes_, options_, ignore);
  EXPECT_LE(samples.count(), 3000);
  EXPECT_GT(samples.count(), 2700);
}

TEST_F(ForestTraining, TellsWhatSamplesTakeMoreThanTheMachineHas) {
  options_.max_samples = 1L << 50;
  options_.pixels_per_scene = 1L << 45;
  EXPECT_TRUE(mentions(errorText([&] { drawSamples(scenes_, options_, ignore); }),
                       {"samples need", "but the machine has", "--max-samples"}));
}

/// Both kinds of forest, from files to the forest.
TEST_F(ForestTraining, DependsOnTheSeedOnly) {
  const auto train = [&](std::size_t threads, std::uint64_t seed) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    options_.seed = seed;
    return forestChecksum(trainOnScenes(scenes_, options_, [](const std::string&) {}));
  };
  for (const ForestKind kind : {ForestKind::kOblivious, ForestKind::kRandomForest}) {
    options_.kind = kind;
    EXPECT_EQ(train(1, 1), train(2, 1));
    EXPECT_NE(train(1, 1), train(1, 2));
  }
}

TEST_F(ForestTraining, TellsEachStep) {
  std::vector<std::string> steps;
  std::vector<std::string> lines;
  const TrainingProgress progress = [&](const TrainingStep& step) {
    steps.push_back(step.phase + " " + std::to_string(step.done) + "/" +
                    std::to_string(step.total));
    if (!step.line.empty()) {
      lines.push_back(step.line);
    }
  };
  options_.search.levels = 0;
  const Samples samples = drawSamples(scenes_, options_, progress);
  EXPECT_THAT(steps, ElementsAre("reading 1/3", "reading 2/3", "reading 3/3", "sampling 1/3",
                                 "sampling 2/3", "sampling 3/3"));
  EXPECT_THAT(lines, ElementsAre(HasSubstr("S0"), HasSubstr("S1"), HasSubstr("S2")));
  steps.clear();
  lines.clear();
  trainOnSamples(samples, scenes_, options_, progress);
  ASSERT_EQ(steps.size(), 9U);
  // cppcheck-suppress containerOutOfBounds  // `progress` fills it
  EXPECT_EQ(steps.back(), "boosting 9/9");
  EXPECT_THAT(lines, ElementsAre(HasSubstr("tree 8 of 9"), HasSubstr("tree 9 of 9")));
}

TEST_F(ForestTraining, WindowsTakeAFirstForest) {
  const auto draw = [&](double windowed_share, std::vector<std::string>& phases) {
    options_.windowed_share = windowed_share;
    return drawSamples(scenes_, options_, [&](const TrainingStep& step) {
      if (phases.empty() || phases.back() != step.phase) {
        phases.push_back(step.phase);
      }
    });
  };
  options_.search.levels = 1;
  std::vector<std::string> phases;
  const Samples windowed = draw(1, phases);
  EXPECT_THAT(phases, ElementsAre("reading", "first sampling", "first forest", "sampling"));
  phases.clear();
  const Samples whole = draw(0, phases);
  EXPECT_THAT(phases, ElementsAre("reading", "sampling"));
  EXPECT_GT(windowed.count(), 0);
  EXPECT_LE(windowed.count(), whole.count()) << "lists do not have every disparity";
  EXPECT_EQ(windowed.held_out.size(), windowed.labels.size());
}

TEST_F(ForestTraining, KeepsWhereTheForestComesFrom) {
  options_.seed = 42;
  for (const ForestKind kind : {ForestKind::kOblivious, ForestKind::kRandomForest}) {
    options_.kind = kind;
    const Forest forest = trainOnScenes(scenes_, options_, [](const std::string&) {});
    const ForestProvenance& provenance = forest.provenance;
    EXPECT_THAT(provenance.scenes, ElementsAre("S0", "S1", "S2"));
    EXPECT_THAT(provenance.program, HasSubstr("cbmv_train "));
    EXPECT_EQ(provenance.options, describe(options_));
    EXPECT_EQ(provenance.seed, 42U);
    EXPECT_GT(provenance.held_out_log_loss, 0);
    EXPECT_LT(provenance.held_out_log_loss, 0.6);
    EXPECT_FALSE(provenance.reliability.empty());
    EXPECT_EQ(provenance.feature_importance.size(), std::size_t{kFeatureCount});
  }
}

}  // namespace
}  // namespace cbmv::test
