#include "evaluation/folds.h"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/error_text.h"

namespace cbmv {
namespace {

TEST(Folds, HoldEachSceneOnce) {
  std::set<std::string> scenes;
  for (const std::vector<std::string>& fold : middleburyFolds()) {
    EXPECT_EQ(fold.size(), 5U);
    scenes.insert(fold.begin(), fold.end());
  }
  EXPECT_EQ(scenes.size(), 15U);
  EXPECT_EQ(foldOf("Teddy"), 0U);
  EXPECT_EQ(foldOf("Piano"), 2U);
  EXPECT_EQ(orderByFold({"Adirondack", "Piano", "Teddy", "Recycle", "ArtL"}),
            (std::vector<std::string>{"Recycle", "Teddy", "Adirondack", "ArtL", "Piano"}));
  EXPECT_TRUE(mentions(errorText([] { orderByFold({"Teddy", "Backpack"}); }), {"Backpack"}));
}

}  // namespace
}  // namespace cbmv
