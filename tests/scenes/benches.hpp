// SPDX-License-Identifier: BSD-3-Clause
// The benches of examples/benches, run by the program and read back.
#pragma once

#include <cmath>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {

inline std::string const benches = source_folder + "/examples/benches/";

inline Finished expect_done(Words const& words) {
  Finished const f = straytrace(words);
  EXPECT_EQ(f.code, 0) << words[0] << " " << words[1] << "\n" << f.err;
  return f;
}

// Scene and options to the run file `name` of the folder.
inline RunFile traced_in(Folder const& folder, std::string const& name, Words words) {
  words.insert(words.begin(), "trace");
  words.insert(words.end(), {"-o", folder / name, "--quiet"});
  expect_done(words);
  return read_run(folder / name);
}

// The route or received route of that name; none: a failure, and zeros.
inline CouplingClass const& route_of(RunFile const& run, std::string const& name) {
  CouplingTable const& table = run.trace.coupling;
  for (CouplingClass const& c : table.classes)
    if (route_name(table, c) == name) return c;
  for (CouplingClass const& c : table.received)
    if (received_name(table, c) == name) return c;
  ADD_FAILURE() << "no route " << name;
  static CouplingClass const none;
  return none;
}

// Within 5 standard errors, which must be able to see `resolvable` (relative), and the accuracy of a closed form.
inline void expect_coupling(RunFile const& run, std::string const& name, double expected, double resolvable,
                            double accuracy = 0) {
  Estimate const& e = route_of(run, name).coupling;
  bool const agrees = std::fabs(e.mean - expected) <= 5 * e.std_error + accuracy * expected;
  EXPECT_TRUE(agrees) << name << ": " << e.mean << " +- " << e.std_error << ", expected " << expected;
  if (agrees) record_mean(name.c_str(), e.mean, e.std_error, expected);
  EXPECT_TRUE(5 * e.std_error < resolvable * expected) << name << ": cannot see what it must";
  EXPECT_TRUE(e.trusted) << name << ": " << e.why_not;
}

inline NoiseTrace const& noise_of(NoiseBudget const& noise, std::string const& route) {
  for (NoiseTrace const& t : noise.routes)
    if (t.name == route) return t;
  ADD_FAILURE() << "no noise of " << route;
  return noise.total;
}

// Bin that holds a frequency.
inline std::size_t bin_at(FrequencyGrid const& grid, double hz) {
  std::size_t i = 0;
  while (i + 1 < grid.size() && grid.edges[i + 1] < hz) ++i;
  return i;
}

}  // namespace straytrace::testing
