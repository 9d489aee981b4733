#pragma once

#include <cstdint>

#include "optimization/path_rows.h"

// The steps of the paths of semi-global matching over all hypotheses, on vectors by Highway.
// Matching costs are bytes before the first run and words afterwards.

namespace cbmv {

/// One step of vertical paths: adds their costs to the sums.
void addColumns(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                const PathEnds& ends);
void addColumns(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                const PathEnds& ends);

/// The same for the last of the four paths: the sums become means of the four.
void averageColumns(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                    const PathEnds& ends);
void averageColumns(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                    const PathEnds& ends);

/// Both paths along a row, all their steps: the sums become the sums of the two. Path 0 of the ends
/// is the one from the left, path 1 the one from the right.
void setRow(const PathPixels<std::uint8_t>& pixels, const RowPenalties& from_left,
            const RowPenalties& from_right, const PathEnds& ends);
void setRow(const PathPixels<std::uint16_t>& pixels, const RowPenalties& from_left,
            const RowPenalties& from_right, const PathEnds& ends);

}  // namespace cbmv
