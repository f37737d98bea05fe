// SPDX-License-Identifier: BSD-3-Clause
// How bright may the baffles of an arm be? Traces once, then asks the run with other BRDFs.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "straytrace/straytrace.hpp"

using namespace straytrace::api;

namespace {

int show(Run const& run, double hz) {
  std::printf("histories %llu\n", static_cast<unsigned long long>(run.histories()));
  for (char const* factor : {"x1", "x0.5", "x0.1"}) {
    Noise const noise = run.noise({.set = {std::string("baffle=") + factor}});
    Value const h = noise.at(hz);
    std::printf("baffle=%s  h(%g Hz) = %.9g +- %.2g%s\n", factor, hz, h.value, h.sigma,
                noise.lower_bound() ? " (lower bound)" : "");
  }
  for (Path const& path : run.noise().paths({.frequencies = {hz}}).rows) {
    if (path.rank > 3) break;
    std::printf("%zu  %s  h = %.3g +- %.1g%s\n", path.rank, path.sequence.c_str(), path.strain[0].value,
                path.strain[0].sigma, path.resolved ? "" : "  unresolved");
  }
  return EXIT_SUCCESS;
}

}  // namespace

int main(int count, char** words) {
  if (count < 2) {
    std::fprintf(stderr, "usage: baffle_reflectance SCENE [HISTORIES]\n");
    return 2;
  }
  try {
    TraceSettings settings;
    settings.histories = count > 2 ? std::strtoull(words[2], nullptr, 10) : 65536;
    settings.progress = [](Progress const& p) {
      std::fprintf(stderr, "%llu histories, %.0f s\n", static_cast<unsigned long long>(p.histories), p.seconds);
      return true;  // false would end the trace
    };
    return show(Model::read(words[1]).trace(settings), 10);
  } catch (InputError const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
