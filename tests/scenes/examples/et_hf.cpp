// SPDX-License-Identifier: BSD-3-Clause
// From a scene file to strain: arm back-scatter of the Einstein Telescope as the public code GWINC_ET gives it
// (docs/theory/arm.md, eq. 8.1 to 8.5, 6.11, 9.1, 9.2; cases A11, B5, B6).
#include <cmath>
#include <sstream>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"
#include "support/statistics.hpp"

namespace straytrace::testing::app_et_hf {
namespace {

constexpr double motion = 1e-15;                                                                     // m/sqrt(Hz), flat
constexpr double frequency[] = {3, 10, 100}, published[] = {1.94697e-16, 1.75464e-17, 9.30612e-19};  // Hz; h/X, 1/m

// h/X at a frequency: straight lines in log-log between bins 0.6 % wide, over which f^-2 averages to 1e-5.
SampleMean strain_per_motion(RunFile const& run, double hz) {
  NoiseTrace const& total = run.noise->total;
  FrequencyGrid const& grid = run.noise->grid;
  std::size_t i = 1;
  while (i + 1 < grid.size() && grid.centre(i) < hz) ++i;
  double const x = std::log(hz / grid.centre(i - 1)) / std::log(grid.centre(i) / grid.centre(i - 1));
  double const h = total.asd[i - 1] * std::pow(total.asd[i] / total.asd[i - 1], x);
  return {h / motion, total.sigma[i] / total.asd[i] * h / motion, (long long)run.trace.total.histories};
}

TEST(EinsteinTelescopeScene, BackScatterB5) {
  Folder const folder;
  ASSERT_EQ(straytrace({"run", et_hf, "-o", folder / "off", "--quiet"}).code, 0);
  write_text(folder / "on.yaml", edited(text_of(et_hf), "reverse_routes: off", "reverse_routes: on"));
  ASSERT_EQ(straytrace({"run", folder / "on.yaml", "-o", folder / "on", "--quiet"}).code, 0);
  RunFile const off = read_run(folder / "off/run.h5"), on = read_run(folder / "on/run.h5");
  for (int i = 0; i < 3; ++i) {
    SampleMean const h = strain_per_motion(off, frequency[i]);
    double const form = 1e-4 * published[i];  // small angles, as in A11
    expect_mean("B5", within(h, form), published[i], 1e-2 * published[i]);
    // Negative controls: pairs of reverse routes counted (h grows by sqrt 2, eq. 1.5), and 1 % of strain.
    SampleMean const doubled = strain_per_motion(on, frequency[i]);
    expect_rejected("C_rev applied", doubled, published[i]);
    expect_mean("C_rev = 2", within(doubled, std::sqrt(2) * form), std::sqrt(2) * published[i], 2e-2 * published[i]);
    expect_rejected("1 % more strain", h, 1.01 * published[i]);
  }
}

// B6: the power in the arms, as the program states it. Tolerance: the digits of the statement.
TEST(EinsteinTelescopeScene, ArmPowerB6) {
  Finished const r = straytrace({"check", et_hf});
  EXPECT_THAT(r.out, ::testing::HasSubstr("P 3.0593e+06 W per arm"));
  Folder const folder;
  write_text(folder / "a.yaml", edited(text_of(et_hf), "beam_splitter_loss: 1e-3", "beam_splitter_loss: 0"));
  EXPECT_THAT(straytrace({"check", folder / "a.yaml"}).out, ::testing::Not(::testing::HasSubstr("P 3.0593e+06 W")));
}

}  // namespace
}  // namespace straytrace::testing::app_et_hf
