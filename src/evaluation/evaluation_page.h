#pragma once

#include <string>

namespace cbmv {

/// Runs `program`, which is scripts/evaluation_report, to make the page `page` (HTML) from the
/// report `json` (writeJsonReport) and the folder of pictures `maps` (writePictures). Throws Error
/// with the program's own sentence when it fails, or that says what is missing when it cannot be
/// run.
void writeEvaluationPage(const std::string& program, const std::string& json,
                         const std::string& maps, const std::string& page);

}  // namespace cbmv
