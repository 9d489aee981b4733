#pragma once

#include "forest/forest.h"

namespace cbmv {

/// A forest of four trees that needs no training: one tree per matcher. It accepts a hypothesis if
/// its cost is the lowest in both matching directions.
inline Forest makeForestFixture() {
  Forest forest;
  forest.name = "fixture.forest";
  for (int matcher = 0; matcher < kMatcherCount; ++matcher) {
    const int feature = featureIndex(matcher, kRatioLow);
    forest.quantizer.maps[feature] = {60.0F, 255.0F};  // log R = 0 at the lowest cost: code 255
    ObliviousTree tree;
    tree.levels = {{static_cast<std::uint8_t>(feature), 253}};
    tree.leaves = {-40, 40};
    forest.trees.push_back(tree);
  }
  return forest;
}

}  // namespace cbmv
