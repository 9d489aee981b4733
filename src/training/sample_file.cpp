#include "training/sample_file.h"

#include <fstream>
#include <limits>

#include "confidence/feature_names.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

void writeSamples(const Samples& samples, const std::string& path) {
  std::ofstream file(path);
  file.precision(std::numeric_limits<float>::max_digits10);
  for (const char* name : kFeatureNames) {
    file << name << ',';
  }
  file << "label,held_out\n";
  for (long n = 0; n < samples.count(); ++n) {
    for (const std::vector<float>& column : samples.features) {
      file << column[n] << ',';
    }
    file << static_cast<int>(samples.labels[n]) << ',' << static_cast<int>(samples.held_out[n])
         << '\n';
  }
  file.close();
  if (!file) {
    throw Error(
        "samples " + path +
        ": cannot be written. Check that the folder exists, is writable and has free space");
  }
}

}  // namespace cbmv
