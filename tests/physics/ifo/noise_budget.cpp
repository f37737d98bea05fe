// SPDX-License-Identifier: BSD-3-Clause
// Noise of read-outs: docs/theory/interferometer.md, eq. N.32, and closed forms of shot and laser noise.
#include <gtest/gtest.h>

#include <cmath>

#include "ifo/layout/operating_point.hpp"
#include "ifo/layout/signals.hpp"
#include "physics/ifo/network_support.hpp"

namespace straytrace::ifo_noise_budget {
namespace {

using straytrace::testing::light_wavelength;
using straytrace::testing::ModulatedCavity;
using straytrace::testing::slow_hz;

double photon(Network const& n) { return hbar * n.wavenumber() * speed_of_light; }  // J

// A laser through a modulator and an attenuator, behind which the vacuum is whole, onto a detector.
struct Bench {
  Network network{light_wavelength};
  std::uint32_t detector = 0;
  Bench(double index, double transmission) {
    NetworkPort light{network.add_laser("laser", 1), 0};
    ComponentId const attenuator = network.add_mirror("M", {.transmission = transmission}),
                      diode = network.add_dump("diode");
    if (index > 0) {
      ComponentId const eom = network.add_modulator("EOM", index, slow_hz);
      network.link(light, {eom, 0}, 0);
      light = {eom, 1};
    }
    network.link(light, {attenuator, 0}, 0);
    network.link({attenuator, 1}, {diode, 0}, 0);
    detector = network.number_of({diode, 0});
  }
};

// Power P: 2 h nu P. Demodulated with a cosine and averaged: half of it.
TEST(NoiseBudget, ShotNoiseN32) {
  Bench const b(0, 0.3);
  SteadyField const f(b.network);
  double const power = f.power_in(b.detector), whole = 2 * photon(b.network) * power;
  EXPECT_NEAR(vacuum_noise(b.network, f, Readout::power(b.detector), 100) / whole, 1, 1e-9);
  Readout const demodulated = Readout::demodulated(b.detector, slow_hz, 0.4);
  EXPECT_NEAR(vacuum_noise(b.network, f, demodulated, 100) / (whole / 2), 1, 1e-9);
  EXPECT_LT(LinearResponse(b.network, f, demodulated, 100).quantum_noise(), 0.7 * whole / 2)
      << "control: the vacuum at the carriers alone";
}

// Two sidebands without a carrier beat with the vacuum between them in one phase: h nu P (1/2 + cos^2), three times as
// much in phase as in quadrature.
TEST(NoiseBudget, SidebandsAloneN32) {
  constexpr double no_carrier = 2.404825557695773;  // J_0
  Bench const b(no_carrier, 1e-4);
  SteadyField const f(b.network);
  double const power = f.power_in(b.detector);
  ASSERT_LT(std::norm(f.in(b.detector, f.carrier(0))), 1e-20 * power);
  auto const noise = [&](double phase) {
    return vacuum_noise(b.network, f, Readout::demodulated(b.detector, slow_hz, phase), 100) /
           (photon(b.network) * power);
  };
  double most = 0, least = 10;
  for (int i = 0; i < 8; ++i) most = std::fmax(most, noise(i * pi / 8)), least = std::fmin(least, noise(i * pi / 8));
  EXPECT_NEAR(most, 1.5, 1e-3);
  EXPECT_NEAR(least, 0.5, 1e-3);
}

// A cavity follows the frequency of the laser: dL = L dnu/nu. Displacement noise is itself; amplitude noise of a signal
// at its zero does not appear without radiation pressure.
TEST(NoiseBudget, LaserNoiseAsLength) {
  ModulatedCavity c(0);
  NetworkModel m{.preset = "none", .network = c.network};
  m.readouts = {{"PDH", c.error_signal(pi)}};
  m.freedoms = {{"LENGTH", {{c.end, 1.0}}}};
  auto const stated = [&](char const* name, double level) {
    return NamedNoise{.cause = *find_cause(m, name), .level = level, .exponent = -1};
  };
  m.noises = {stated("laser.frequency", 2), stated("M2", 3e-18), stated("laser.amplitude", 1e-6)};
  ReadoutNoise const n = noise_of(m, m.readouts[0], &m.freedoms[0], {10, 50});
  EXPECT_EQ(n.names[1], "laser.frequency");
  for (std::size_t i = 0; i < 2; ++i) {
    double const slope = 100 / n.hz[i], nu = speed_of_light / light_wavelength;
    EXPECT_NEAR(n.asd[1][i] / (3000 * 2 * slope / nu), 1, 1e-4);
    EXPECT_NEAR(n.asd[2][i] / (3e-18 * slope), 1, 1e-12);
    EXPECT_LT(n.asd[3][i], 1e-6 * n.asd[1][i]);
    EXPECT_NEAR(n.total[i] / std::hypot(n.asd[0][i], n.asd[1][i], std::hypot(n.asd[2][i], n.asd[3][i])), 1, 1e-12);
  }
  m.network.move(c.end, 0.2e-9);
  EXPECT_GT(noise_of(m, m.readouts[0], &m.freedoms[0], {10}).asd[3][0], 1e3 * n.asd[3][0]) << "control: off its zero";
}

// Two quadratures of light in a coherent state share the cosine of the angle between them, demodulated signals too; the
// outputs of a splitter share nothing.
TEST(NoiseBudget, ReadoutsShareTheVacuum) {
  double const hz = 100;
  Bench const b(0.1, 0.3);
  SteadyField const f(b.network);
  auto const shared = [&](Network const& n, SteadyField const& light, Readout const& r, Readout const& other) {
    return LinearResponse(n, light, r, hz).vacuum_correlation(LinearResponse(n, light, other, hz)) +
           vacuum_beside_carriers(n, light, r, other);
  };
  for (double const turn : {0.0, 0.7, pi / 2}) {
    Readout const a = Readout::homodyne(b.detector, 0.2), c = Readout::homodyne(b.detector, 0.2 + turn);
    double const noise = vacuum_noise(b.network, f, a, hz);
    EXPECT_LT(std::abs(shared(b.network, f, a, c) / noise - std::cos(turn)), 1e-9) << turn;
  }
  Bench const plain(0, 0.3);
  SteadyField const carrier(plain.network);
  Readout const q = Readout::demodulated(plain.detector, slow_hz, 0.3);
  for (double const turn : {0.0, 0.7}) {
    Readout const r = Readout::demodulated(plain.detector, slow_hz, 0.3 + turn);
    EXPECT_LT(
        std::abs(shared(plain.network, carrier, q, r) / vacuum_noise(plain.network, carrier, q, hz) - std::cos(turn)),
        1e-9);
  }
  Network n(light_wavelength);
  ComponentId const laser = n.add_laser("laser", 1),
                    splitter = n.add_splitter("BS", {.transmission = 0.4, .incidence = pi / 4});
  n.link({laser, 0}, {splitter, 0}, 1);
  SteadyField const split(n);
  Readout const reflected = Readout::power(n.number_of({splitter, 1})).of_leaving(),
                passed = Readout::power(n.number_of({splitter, 2})).of_leaving();
  double const both = std::sqrt(vacuum_noise(n, split, reflected, hz) * vacuum_noise(n, split, passed, hz));
  EXPECT_LT(std::abs(shared(n, split, reflected, passed)) / both, 1e-9);
  EXPECT_NEAR(std::abs(shared(n, split, passed, passed)) / vacuum_noise(n, split, passed, hz), 1, 1e-9) << "control";
}

}  // namespace
}  // namespace straytrace::ifo_noise_budget
