#pragma once

#include <cstdint>

#include "optimization/path_rows.h"

// Vectorized steps of SGM paths over all hypotheses, by Highway. Costs are bytes in the first run
// and 16-bit integers in later runs.

namespace cbmv {

/// Processes one step of vertical paths: adds their costs to the sums.
void addColumns(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                const PathEnds& ends);
void addColumns(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                const PathEnds& ends);

/// The same for the last of the four paths: the sums become means of the four paths.
void averageColumns(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                    const PathEnds& ends);
void averageColumns(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                    const PathEnds& ends);

/// Processes all steps of both paths along a row: sets the sums to the sums of the two path costs.
/// Path 0 of `ends` is from the left, path 1 is from the right.
void setRow(const PathPixels<std::uint8_t>& pixels, const RowPenalties& from_left,
            const RowPenalties& from_right, const PathEnds& ends);
void setRow(const PathPixels<std::uint16_t>& pixels, const RowPenalties& from_left,
            const RowPenalties& from_right, const PathEnds& ends);

}  // namespace cbmv
