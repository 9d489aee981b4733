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

/// Computes the input of every stage with the preceding stages, using the parameters and the forest
/// of preset `quality`.
std::shared_ptr<StageData> makeStageData(const Problem& problem);

/// Unit of work of a stage: hypotheses (x, y, d) of the search space at full size, those of one
/// image row, those of the whole disparity range, or pixels.
enum class StageUnit { kHypotheses, kRowHypotheses, kRangeHypotheses, kPixels };

/// One stage of the method, on prepared input.
struct Stage {
  std::string name;
  StageUnit unit;
  /// Bytes per unit that are read from or written to main memory regardless of the caches: volumes
  /// and maps, once per pass over them. 0 if a row stays in the caches.
  double memory_bytes;
  /// Bytes per unit that vector instructions must compute, counted in the code: one per instruction
  /// and byte of its lanes, without loads, stores and address arithmetic. 0: not counted, because
  /// the stage is not vector code or depends on the image.
  double computed_bytes;
  std::function<void(StageData&)> run;
  std::function<void(const StageData&, Checksum&)> add_result;  ///< result of the last run
};

/// Number of units of the stage in this data.
double unitsOf(const Stage& stage, const StageData& data);

/// All stages in the order of the data flow.
const std::vector<Stage>& stages();

}  // namespace cbmv::benchmarks
