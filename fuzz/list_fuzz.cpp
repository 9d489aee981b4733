// Lists of pairs. The listed files do not exist.

#include "data_sets/data_set.h"
#include "fuzz_target.h"
#include "scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  return cbmv::fuzz::attempt([&] {
    const cbmv::DataSet data_set = cbmv::DataSet::open("list:" + file.path());
    for (const std::string& scene : data_set.scenes()) {
      cbmv::fuzz::attempt([&] { data_set.read(scene); });
    }
  });
}
