// SPDX-License-Identifier: BSD-3-Clause
// Run files behind their checksum, which protects from accidents but not from a writer who seals what he wrote. Bytes
// that begin as HDF5 are the file; others are changes of what HDF5 reads from a good one, five bytes each: place
// (32 bits) and what is added there to the byte modulo 256. Texts end at the file.
#include <filesystem>

#include "base/errors.hpp"
#include "fuzz.hpp"
#include "results/run_file/run_file.hpp"
#include "unit/results/synthetic.hpp"

namespace {

using namespace straytrace;

// The values that HDF5 reads from a run file, as bytes.
std::string good_run() {
  test::Folder const folder;
  TraceResult const trace = test::trace_result();
  NoiseBudget const noise = test::noise_budget(trace.coupling);
  write_run(folder / "run.h5", test::content(trace, &noise));
  return hdf5::packed(hdf5::own_contents(unsealed(read_file(folder / "run.h5"), "run.h5")));
}

std::string changed(std::string run, std::string_view changes) {
  for (std::size_t i = 0; i + 5 <= changes.size(); i += 5) {
    std::size_t place = 0;
    for (std::size_t k = 0; k < 4; ++k) place = place << 8 | static_cast<unsigned char>(changes[i + k]);
    char& byte = run[place % run.size()];
    byte = char(byte + changes[i + 4]);
  }
  return run;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  static std::string const good = good_run();
  std::string_view const text = fuzz::text_of(data, size);
  try {
    bool const file = text.starts_with("\x89HDF");
    (void)run_of(file ? hdf5::contents_of(std::string(text)) : hdf5::unpacked(changed(good, text)), "run.h5");
  } catch (InputError const&) {
  }
  return 0;
}
