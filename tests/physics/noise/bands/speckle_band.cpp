// SPDX-License-Identifier: BSD-3-Clause
// Percentiles of one realisation of the static phases (docs/theory/spectra.md, eq. 10.1 to 10.5, case A20).
#include "noise/bands/speckle_band.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/gamma.hpp>

#include "base/math/rng.hpp"
#include "noise/bands/speckle_band.hpp"
#include "physics/noise/support.hpp"
#include "spectra/welch.hpp"

namespace straytrace::testing {
namespace {

// Phase and radiation pressure of equal strength, a quarter turn apart: |sum|^2 counts.
class BothQuadratures final : public Interferometer {
 public:
  explicit BothQuadratures(double amplitude = 1) : amplitude_(amplitude) {}
  std::complex<double> strain_per_phase(PortId, double) const override { return 1; }
  std::complex<double> strain_per_amplitude(PortId, double) const override { return {0, amplitude_}; }
  double copies(PortId) const override { return 1; }
  std::string description() const override { return "both"; }

 private:
  double amplitude_;
};

constexpr double weak = 1e-13, strong = 2e-8;  // m/sqrt(Hz) at 10 Hz, falling as f^-2 from 1 Hz

struct Percentiles {
  double p05, p50, p95, coherent;  // of the PSD over its mean; of the ASD over the total
};

Percentiles band_of(std::vector<CouplingClass> const& routes, MotionSet const& motion, Interferometer const& ifo) {
  CouplingTable const table = known_table(routes);
  NoiseBudget b = project_noise(table, motion, ifo, on({10, 10.4}));
  add_speckle_band(b, table, motion, ifo);
  auto const over = [&](std::vector<double> const& asd) { return std::pow(asd.at(0) / b.total.asd.at(0), 2); };
  return {over(b.bands.speckle_05), over(b.bands.speckle_50), over(b.bands.speckle_95),
          b.bands.coherent.at(0) / b.total.asd.at(0)};
}

MotionSet one_body(double asd) { return moving({power_law_asd(asd, 10, -2, 1, 100)}); }

std::vector<PathRecord> equal_paths(int count, std::uint32_t body = 0) {
  std::vector<PathRecord> all;
  for (int i = 0; i < count; ++i)
    all.push_back(record(std::uint64_t(i), 1.0 / count, {phase_sensitivity(body, 2, two_k)}));
  return all;
}

TEST(SpeckleBand, OneRigidBodyIsOneSpeckle) {  // A20: 200 equal paths, tolerance 3 %
  Percentiles const field = band_of({known_class(1, 1, equal_paths(200))}, one_body(weak), BothQuadratures());
  EXPECT_LT(deviation(field.p95, 2.996), 0.03);
  EXPECT_LT(deviation(field.p50, speckle_percentile(0.5)), 0.03);
  EXPECT_LT(deviation(field.p05, speckle_percentile(0.05)), 0.05);
  Percentiles const phase = band_of({known_class(1, 1, equal_paths(200))}, one_body(weak), UnitDetector());
  EXPECT_LT(deviation(phase.p95, 2 * 1.921), 0.03);
  EXPECT_LT(deviation(phase.p50, boost::math::quantile(boost::math::chi_squared(1), 0.5)), 0.03);
  EXPECT_GT(deviation(phase.p95, field.p95), 0.2);  // control: one law for both
}

TEST(SpeckleBand, RoutesOfOneBodyAreStillOneSpeckle) {  // one motion, not one route, makes a speckle
  std::vector<CouplingClass> routes;
  for (std::uint64_t i = 0; i < 200; ++i)
    routes.push_back(known_class(i, 1.0 / 200, {record(0, 1.0 / 200, {phase_sensitivity(0, 2, two_k)})}));
  Percentiles const p = band_of(routes, one_body(weak), BothQuadratures());
  EXPECT_LT(deviation(p.p95, 2.996), 0.03);
  EXPECT_LT(deviation(p.coherent, 14.14), 1e-3);  // A20, eq. 10.4: linear sum of ASDs
}

TEST(SpeckleBand, IndependentBodiesAverage) {  // sum of N exponentials of equal mean
  for (int const n : {2, 5}) {
    std::vector<CouplingClass> routes;
    std::vector<Spectrum> spectra;
    for (int i = 0; i < n; ++i) {
      spectra.push_back(power_law_asd(weak, 10, -2, 1, 100));
      routes.push_back(known_class(std::uint64_t(i), 1, equal_paths(50, std::uint32_t(i))));
    }
    Percentiles const p = band_of(routes, moving(spectra), BothQuadratures());
    boost::math::gamma_distribution<> const law(n, 1.0 / n);
    EXPECT_LT(deviation(p.p95, boost::math::quantile(law, 0.95)), 0.03) << n;
    EXPECT_LT(deviation(p.p05, boost::math::quantile(law, 0.05)), 0.05) << n;
    EXPECT_GT(deviation(p.p95, 2.996), 0.1) << n;  // control: bodies taken for one
  }
}

TEST(SpeckleBand, ABodyInEveryRouteTiesThem) {  // eq. 10.2; nearly at rest it leaves them apart
  auto const with_mirror = [](bool in_routes, double asd) {
    std::vector<CouplingClass> routes;
    std::vector<Spectrum> spectra{power_law_asd(asd, 10, -2, 1, 100)};
    for (std::uint32_t i = 1; i <= 12; ++i) {
      std::vector<PhaseSensitivity> phase_sensitivities{phase_sensitivity(i, 2, two_k)};
      if (in_routes) phase_sensitivities.push_back(phase_sensitivity(0, 2, -two_k));
      routes.push_back(known_class(i, 1, {record(0, 1, phase_sensitivities)}));
      spectra.push_back(power_law_asd(weak, 10, -2, 1, 100));
    }
    return band_of(routes, moving(spectra), BothQuadratures());
  };
  Percentiles const apart = with_mirror(false, weak), at_rest = with_mirror(true, 1e-6 * weak);
  EXPECT_LT(deviation(at_rest.p95, apart.p95), 1e-4);
  EXPECT_LT(deviation(at_rest.p50, apart.p50), 1e-4);
  EXPECT_LT(deviation(at_rest.p05, apart.p05), 1e-4);
  EXPECT_LT(deviation(with_mirror(true, 1e3 * weak).p95, 2.996), 0.03);  // it alone moves: one speckle
}

TEST(SpeckleBand, ManyBodiesWithOneThatIsInEveryRoute) {
  // N equal routes, each moved by a body of its own and by a mirror, all of one spectrum: sum |z_i|^2 + |sum z_i|^2 has
  // one eigenvalue 1 + N and N - 1 of 1 (eq. 10.2 for the first; the others are their mean within 1/sqrt(N)).
  constexpr int n = 400;
  auto const with = [](bool mirror) {
    std::vector<CouplingClass> routes;
    for (std::uint32_t i = 1; i <= n; ++i) {
      std::vector<PhaseSensitivity> levers{phase_sensitivity(i, 2, two_k)};
      if (mirror) levers.push_back(phase_sensitivity(0, 2, -two_k));
      routes.push_back(known_class(i, 1, {record(0, 1, levers)}));
    }
    return band_of(routes, moving(std::vector<Spectrum>(n + 1, power_law_asd(weak, 10, -2, 1, 100))),
                   BothQuadratures());
  };
  auto const expected = [](double below) { return ((1 + n) * speckle_percentile(below) + n - 1) / (2 * n); };
  Percentiles const tied = with(true);
  EXPECT_LT(deviation(tied.p95, expected(0.95)), 0.02);
  EXPECT_LT(deviation(tied.p50, expected(0.50)), 0.02);
  EXPECT_LT(deviation(tied.p05, expected(0.05)), 0.02);
  EXPECT_LT(with(false).p95, 1.2);  // control: without it they average
}

TEST(SpeckleBand, PhaseSensitivitiesInOneDirectionAreOneMotion) {  // linear: amplitudes add, whatever the strength of
                                                                   // the phase sensitivities
  std::vector<PathRecord> paths;
  for (int i = 0; i < 100; ++i)
    paths.push_back(record(std::uint64_t(i), 0.01, {phase_sensitivity(0, 2, two_k * (1 + 0.02 * i))}));
  EXPECT_LT(deviation(band_of({known_class(1, 1, paths)}, one_body(weak), BothQuadratures()).p95, 2.996), 0.03);
}

TEST(SpeckleBand, TransferFunctionsWeighTheQuadratures) {  // weights 1 and 0.25 of two chi-squares
  Percentiles const p = band_of({known_class(1, 1, equal_paths(50))}, one_body(weak), BothQuadratures(0.5));
  std::vector<double> draws;
  Rng rng(7, 0, 0, Stream::source);
  for (int i = 0; i < 200000; ++i) {
    double const radius = -std::log(rng.uniform()), turn = 2 * pi * rng.uniform();
    draws.push_back(2 * radius * (std::pow(std::cos(turn), 2) + 0.25 * std::pow(std::sin(turn), 2)) / 1.25);
  }
  std::sort(draws.begin(), draws.end());
  EXPECT_LT(deviation(p.p95, draws[190000]), 0.03);
  EXPECT_LT(deviation(p.p05, draws[10000]), 0.05);
}

TEST(SpeckleBand, AGhostHasAKnownModulus) {  // |a|^2 (1 + cos beta): its largest is twice the mean
  CouplingClass ghost = known_class(1, 1, {record(0, 1, {phase_sensitivity(0, 2, two_k)})});
  ghost.kind = ClassKind::ghost;
  Percentiles const p = band_of({ghost}, one_body(weak), UnitDetector());
  EXPECT_LT(deviation(p.p95, 1 + std::cos(pi * 0.05)), 0.01);
  EXPECT_LT(deviation(p.p50, 1), 0.01);
  Percentiles const field = band_of({ghost}, one_body(weak), BothQuadratures());
  EXPECT_LT(deviation(field.p95, 1), 1e-6);  // both quadratures: nothing is unknown
}

// One-sided PSD near 10 Hz of Im(e^{i phi0 + i phi(t)}) for Gaussian motion of rms phase `rms` around 0.4 Hz with a
// weak line of phase at 10 Hz: 20 minutes at 64 Hz.
double realised(double phi0, double rms, std::uint64_t seed) {
  constexpr double rate = 64;
  std::vector<double> y;
  std::vector<std::array<double, 3>> slow;  // frequency, amplitude, phase
  Rng rng(seed, 0, 0, Stream::source);
  for (int k = 0; k < 60; ++k)
    slow.push_back({0.3 + 0.2 * (k + rng.uniform()) / 60, rms * std::sqrt(2.0 / 60), 2 * pi * rng.uniform()});
  for (int i = 0; i < 1200 * rate; ++i) {
    double const t = i / rate;
    double phase = phi0 + 1e-2 * std::sin(2 * pi * 10 * t);
    for (auto const& [f, a, p] : slow) phase += a * std::cos(2 * pi * f * t + p);
    y.push_back(std::sin(phase));
  }
  double power = 0;  // of the line and its sidebands, 8 to 12 Hz
  auto const psd = welch(y, rate, {.segment = 640});
  for (std::size_t i = 0; i < psd.hz.size(); ++i)
    if (psd.hz[i] > 8 && psd.hz[i] < 12) power += psd.psd[i];
  return power;
}

TEST(SpeckleBand, SlowWrappingForgetsTheStaticPhase) {  // time series as reference
  // Still but for the line: the quadrature decides. Slow phase of 1.5 rad rms: it does not.
  EXPECT_LT(realised(pi / 2, 0, 1), 0.05 * realised(0, 0, 1));
  EXPECT_LT(deviation(realised(pi / 2, 1.5, 1), realised(0, 1.5, 1)), 0.15);
  EXPECT_DOUBLE_EQ(surviving_phase(0, 0, false), 1);
  EXPECT_LT(surviving_phase(1.5 * 1.5, 0, false), 0.02);
  EXPECT_EQ(surviving_phase(0, 1, false), 1);  // lines of a tone keep their phase
  EXPECT_EQ(surviving_phase(0, 0, true), 0);
  Percentiles const p = band_of({known_class(1, 1, equal_paths(50))}, one_body(strong), UnitDetector());
  EXPECT_LT(deviation(p.p95, 2.996), 0.03);  // one quadrature, both of them in time
}

}  // namespace
}  // namespace straytrace::testing
