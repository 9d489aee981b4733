#pragma once

#include <string>

namespace cbmv {

/// Runs `program` (scripts/evaluation_report) to create the HTML file `page` from the report `json`
/// (writeJsonReport) and the picture folder `maps` (writePictures). Throws Error with the program's
/// error message if it fails, or with the missing file if it cannot be started.
void writeEvaluationPage(const std::string& program, const std::string& json,
                         const std::string& maps, const std::string& page);

}  // namespace cbmv
