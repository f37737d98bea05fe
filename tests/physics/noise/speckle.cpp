// SPDX-License-Identifier: BSD-3-Clause
// One realisation of many equal paths on one rigid body (docs/theory/spectra.md, eq. 10.1 to 10.4, case A20).
#include <algorithm>

#include "base/math/rng.hpp"
#include "noise/bands/speckle_band.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

// Powers |sum|^2 of 200 paths of power 1/200 with phases drawn at random, in order.
std::vector<double> realise(int count) {
  std::vector<double> power;
  for (int i = 0; i < count; ++i) {
    Rng rng(20, static_cast<std::uint64_t>(i), 0, Stream::source);
    std::complex<double> sum = 0;
    for (int path = 0; path < 200; ++path) sum += std::polar(1 / std::sqrt(200.0), 2 * pi * rng.uniform());
    power.push_back(std::norm(sum));
  }
  std::sort(power.begin(), power.end());
  return power;
}

TEST(Speckle, PercentilesOfOneRealisation) {  // A20, eq. 10.2, tolerance 3 %
  EXPECT_NEAR(speckle_percentile(0.95), 2.996, 1e-3);
  std::vector<double> const power = realise(40000);
  double mean = 0;
  for (double p : power) mean += p / 40000;
  EXPECT_LT(deviation(mean, 1), 0.03);
  EXPECT_LT(deviation(power[38000], speckle_percentile(0.95)), 0.03);
  EXPECT_GT(deviation(power[38000], 3.841 / 2), 0.03);  // control: one quadrature for both, eq. 10.3
}

TEST(Speckle, PathsAddInPower) {  // eq. 10.4: a sum of ASDs would be 14.14 times too high
  Spectrum const s = power_law_asd(1e-13, 10, -2, 1, 100);
  std::vector<CouplingClass> routes;
  for (std::uint64_t i = 0; i < 200; ++i)
    routes.push_back(known_class(i, 1, {record(0, 1, {phase_sensitivity(0, 2, two_k)})}));
  NoiseBudget const b = project_noise(known_table(routes), moving({s}), UnitDetector(), on({10, 10.4}));
  double linear = 0;
  for (NoiseTrace const& t : b.routes) linear += t.asd[0];
  EXPECT_LT(deviation(linear / b.total.asd[0], 14.14), 1e-3);
  EXPECT_LT(deviation(b.total.asd[0], std::sqrt(200) * b.routes[0].asd[0]), 1e-9);
}

}  // namespace
}  // namespace straytrace::testing
