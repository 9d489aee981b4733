// Reports of cbmv_eval, which reads those of earlier runs.

#include "evaluation/json_report.h"
#include "fuzz_target.h"
#include "scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  return cbmv::fuzz::attempt([&] { cbmv::formatReport(cbmv::readJsonReport(file.path())); });
}
