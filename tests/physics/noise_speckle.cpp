// SPDX-License-Identifier: BSD-3-Clause
// One realisation of many equal paths on one rigid body (physics.md eq. 10.1 to 10.4, case A20).
#include <algorithm>

#include "base/rng.hpp"
#include "noise/speckle.hpp"
#include "noise_support.hpp"

namespace straytrace::testing {
namespace {

struct Realisations {
  std::vector<double> power, quadrature;  // of 200 paths of power 1/200
};

Realisations realise(int count) {
  Realisations out;
  for (int i = 0; i < count; ++i) {
    Rng rng(20, static_cast<std::uint64_t>(i), 0, Stream::source);
    std::complex<double> sum = 0;
    for (int path = 0; path < 200; ++path) sum += std::polar(1 / std::sqrt(200.0), 2 * pi * rng.uniform());
    out.power.push_back(std::norm(sum));
    out.quadrature.push_back(std::pow(sum.imag(), 2));
  }
  std::sort(out.power.begin(), out.power.end());
  std::sort(out.quadrature.begin(), out.quadrature.end());
  return out;
}

TEST(Speckle, PercentilesOfOneRealisation) {  // A20, tolerance 3 %
  EXPECT_NEAR(speckle_percentile(0.95), 2.996, 1e-3);
  EXPECT_NEAR(quadrature_percentile(0.95), 3.841, 1e-3);
  EXPECT_NEAR(quadrature_percentile(0.5), 0.4549, 1e-4);
  Realisations const r = realise(40000);
  double mean = 0;
  for (double p : r.power) mean += p / 40000;
  EXPECT_LT(deviation(mean, 1), 0.03);
  EXPECT_LT(deviation(r.power[38000], speckle_percentile(0.95)), 0.03);
  EXPECT_LT(deviation(r.quadrature[38000], quadrature_percentile(0.95) / 2), 0.03);
  EXPECT_GT(deviation(r.power[38000], quadrature_percentile(0.95) / 2), 0.03);  // twin: one quadrature for both
}

TEST(Speckle, PathsAddInPower) {  // eq. 10.4: a sum of ASDs would be 14.14 times too high
  Spectrum const s = power_law_asd(1e-13, 10, -2, 1, 100);
  std::vector<CouplingClass> routes;
  for (std::uint64_t i = 0; i < 200; ++i) routes.push_back(known_class(i, 1, {record(0, 1, {lever(0, 2, two_k)})}));
  NoiseBudget const b = project_noise(known_table(routes), moving({s}), UnitDetector(), on({10, 10.4}));
  double linear = 0;
  for (NoiseTrace const& t : b.routes) linear += t.asd[0];
  EXPECT_LT(deviation(linear / b.total.asd[0], 14.14), 1e-3);
  EXPECT_LT(deviation(b.total.asd[0], std::sqrt(200) * b.routes[0].asd[0]), 1e-9);
}

}  // namespace
}  // namespace straytrace::testing
