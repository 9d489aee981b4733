#include "tuning/parameter_search.h"

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/error_text.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// A valley with its minimum at P2 = 5, four aggregation iterations and a sigma of 3.
double valley(const StereoOptions& options) {
  return std::abs(std::log(options.sgm.p2 / 5.0)) +
         0.3 * std::abs(options.aggregation.iterations_after - 4) +
         std::abs(options.refinement.bilateral_sigma_px - 3.0);
}

StereoOptions farAway() {
  StereoOptions start;
  start.sgm.p2 = 20;
  start.aggregation.iterations_after = 1;
  start.refinement.bilateral_sigma_px = 9;
  return start;
}

/// Runs a search and records its progress.
struct LoggedSearch {
  explicit LoggedSearch(const SearchSettings& settings, const Objective& objective = valley) {
    const ParameterSpace space({"P2", "cbca_iterations_after", "bilateral_sigma"});
    best = searchParameters(
        space, farAway(), objective, settings,
        [this](int evaluation, const SearchPoint& here, const SearchPoint& so_far) {
          EXPECT_EQ(evaluation, static_cast<int>(tried.size()) + 1);
          EXPECT_LE(so_far.score, here.score);
          tried.push_back(describeOptions(here.options));
        });
  }

  SearchPoint best;
  std::vector<std::string> tried;
};

TEST(ParameterSearch, FindsTheFloorOfAValley) {
  const LoggedSearch run({300, 0, 1});
  EXPECT_NEAR(run.best.options.sgm.p2, 5, 0.3);
  EXPECT_EQ(run.best.options.aggregation.iterations_after, 4);
  EXPECT_NEAR(run.best.options.refinement.bilateral_sigma_px, 3, 0.1);
  EXPECT_EQ(run.best.score, valley(run.best.options));
  EXPECT_LT(run.best.score, 0.15);
}

TEST(ParameterSearch, LooksAllOverTheSpaceFirst) {
  // A hole far from the start; a local search around the start finds no slope towards it.
  const Objective hole = [](const StereoOptions& options) {
    return options.refinement.bilateral_sigma_px < 4 ? 0.0 : 1.0;
  };
  EXPECT_EQ(LoggedSearch({60, 30, 1}, hole).best.score, 0.0);
}

TEST(ParameterSearch, BeginsAtTheStartAndKeepsToTheBudget) {
  for (const SearchSettings& settings : {SearchSettings{1, 0, 1}, SearchSettings{1, 9, 1},
                                         SearchSettings{7, 3, 1}, SearchSettings{40, 20, 1}}) {
    const LoggedSearch run(settings);
    EXPECT_EQ(run.tried.front(), describeOptions(farAway()));
    EXPECT_EQ(static_cast<int>(run.tried.size()), settings.evaluations);
    EXPECT_LE(run.best.score, valley(farAway()));
    EXPECT_EQ(std::set<std::string>(run.tried.begin(), run.tried.end()).size(), run.tried.size())
        << "nothing is tried twice";
  }
}

TEST(ParameterSearch, EndsWhereNothingChanges) {
  const LoggedSearch run({5000, 100, 1}, [](const StereoOptions&) { return 1.0; });
  EXPECT_LT(run.tried.size(), 5000U);
  EXPECT_EQ(describeOptions(run.best.options), describeOptions(farAway()));
}

TEST(ParameterSearch, IsDeterministic) {
  const SearchSettings settings{60, 30, 7};
  EXPECT_EQ(LoggedSearch(settings).tried, LoggedSearch(settings).tried);
}

TEST(ParameterSearch, PassesOnWhatGoesWrong) {
  int calls = 0;
  const Objective failing = [&calls](const StereoOptions&) -> double {
    if (++calls == 5) {
      throw Error("the disk is full");
    }
    return 1.0 / calls;
  };
  EXPECT_EQ(errorText([&] { LoggedSearch({50, 0, 1}, failing); }), "the disk is full");
  EXPECT_EQ(calls, 5);
  EXPECT_TRUE(mentions(errorText([] { LoggedSearch({0, 0, 1}); }), {"one evaluation"}));
}

}  // namespace
}  // namespace cbmv
