#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "checks.h"
#include "problem.h"

namespace cbmv::benchmarks {

/// Input and output of every stage for one problem.
struct StageData;

/// Makes the input of every stage by the stages before it, with the parameters and the forest of
/// the preset `quality`.
std::shared_ptr<StageData> makeStageData(const Problem& problem);

/// What a stage is applied to: the hypotheses (x, y, d) of the search space at full size, those of
/// one image row of it, all of the disparity range, or pixels.
enum class StageUnit { kHypotheses, kRowHypotheses, kRangeHypotheses, kPixels };

/// One stage of the method, on prepared input.
struct Stage {
  std::string name;
  StageUnit unit;
  /// Bytes a unit that must come from or go to main memory whatever the caches do: volumes and
  /// maps, once for each pass over them. 0 where a row stays in the caches.
  double memory_bytes;
  /// Bytes that vector instructions must compute for a unit, counted in the code: one for each
  /// instruction and byte of its lanes, without loads, stores and address arithmetic. 0: not
  /// counted, because the stage is no vector code or depends on the picture.
  double computed_bytes;
  std::function<void(StageData&)> run;
  std::function<void(const StageData&, Checksum&)> add_result;  ///< of the last run
};

/// How many units the stage has in this data.
double unitsOf(const Stage& stage, const StageData& data);

/// All stages, in the order of the data flow.
const std::vector<Stage>& stages();

}  // namespace cbmv::benchmarks
