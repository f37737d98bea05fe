// SPDX-License-Identifier: BSD-3-Clause
// Gives the files of the folders named to the entry of a fuzzer, in the ordinary suite and without clang: every input
// that once crashed, hung or took all memory stays a test. Each has 1 s of processor time, all together 4 GB.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "base/process/child_process.hpp"
#include "fuzz.hpp"

namespace {

using straytrace::sanitized;

constexpr double most_seconds = sanitized ? 20 : 1;
constexpr rlim_t most_memory = rlim_t{4} << 30;  // of addresses; sanitizers reserve terabytes

double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

bool replay(std::filesystem::path const& file) {
  std::ifstream in(file, std::ios::binary);
  std::string const bytes(std::istreambuf_iterator<char>(in), {});
  std::printf("%s\n", file.filename().c_str());
  std::fflush(stdout);  // the last line identifies a crash
  double const before = processor_seconds();
  LLVMFuzzerTestOneInput(reinterpret_cast<std::uint8_t const*>(bytes.data()), bytes.size());
  double const taken = processor_seconds() - before;
  if (taken > most_seconds) std::printf("  took %.1f s of processor time, allowed are %.0f s\n", taken, most_seconds);
  return taken <= most_seconds;
}

}  // namespace

int main(int argc, char** argv) {
  rlimit const memory = {most_memory, most_memory};
  if (!sanitized) ::setrlimit(RLIMIT_AS, &memory);
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i)
    for (auto const& entry : std::filesystem::directory_iterator(argv[i]))
      if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) std::printf("no inputs found\n");
  bool good = !files.empty();
  for (auto const& file : files) good = replay(file) && good;
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
