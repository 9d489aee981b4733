#include "forest/confidence_forest.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/random_forest.h"

namespace cbmv::test {
namespace {

/// The error of requireFeatures for a forest with features f0, f1 and f2.
std::string faultOf(const std::vector<std::string>& names) {
  return errorText([&] {
    requireFeatures(makeConfidenceForest(3, 1, 1, 1), "selection", names, "some.forest");
  });
}

TEST(ConfidenceForest, TakesTheFeaturesItWasTrainedOn) {
  EXPECT_EQ(faultOf({"f0", "f1", "f2"}), "no error");
}

TEST(ConfidenceForest, NamesTheFirstFeatureThatDiffers) {
  EXPECT_TRUE(
      mentions(faultOf({"f0", "x", "f2"}), {"some.forest", "feature 1 of the selection forest",
                                            "\"f1\"", "expected \"x\"", "cbmv_train"}));
  EXPECT_TRUE(mentions(faultOf({"f0", "f2", "f1"}), {"feature 1", "\"f1\"", "expected \"f2\""}));
  EXPECT_TRUE(mentions(faultOf({"f0", "f1"}), {"feature 2", "\"f2\"", "expected 2 features"}));
  EXPECT_TRUE(
      mentions(faultOf({"f0", "f1", "f2", "f3"}), {"feature 3", "is missing", "expected \"f3\""}));
}

}  // namespace
}  // namespace cbmv::test
