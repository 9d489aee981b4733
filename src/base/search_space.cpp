#include "base/search_space.h"

namespace cbmv {

void SearchSpace::buildExhaustive(int height, int width, const DisparityRange& range) {
  build(height, width, range, [&](int /*y*/, Row& row) {
    for (int t = 0; t < tiles(); ++t) {
      for (int i = 0; i < range.count; ++i) {
        row.push(i);
      }
      row.endTile();
    }
  });
}

void SearchSpace::reset(int height, int width, const DisparityRange& range) {
  height_ = height;
  width_ = width;
  range_ = range;
  rows_.resize(height);
  first_entries_.resize(height);
}

void SearchSpace::numberEntries() {
  entries_ = 0;
  for (int y = 0; y < height_; ++y) {
    first_entries_[y] = entries_;
    entries_ += rows_[y].indices_.size();
  }
}

}  // namespace cbmv
