// SPDX-License-Identifier: BSD-3-Clause
// Linear response of networks against closed forms: eq. 6.10, 8.6, 9.1 to 9.5, 12.5, 12.6 of docs/theory (A14, A23).
#include <gtest/gtest.h>

#include <array>

#include "base/every_module.hpp"
#include "ifo/network.hpp"
#include "physics/ifo/demodulated.hpp"
#include "physics/ifo/exact_arm.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_response {
namespace {

using straytrace::testing::demodulated;

constexpr double wavelength = 1.064e-6, k = 2 * pi / wavelength;

// Michelson with two arm cavities, dark port read by a homodyne detector.
struct Detector {
  Network n{wavelength};
  ComponentId laser, splitter, input[2], end[2], dark, behind[2];
  double length;
  Detector(double input_transmission, double end_transmission, double loss, double arm_length, double mass,
           double splitter_power, double short_arm = 0)
      : length(arm_length) {
    Suspension const free{.mass = mass};
    laser = n.add_laser("laser", splitter_power);
    splitter = n.add_splitter("splitter", {.transmission = 0.5});
    dark = n.add_dump("dark");
    n.link({laser, 0}, {splitter, 0}, 0);
    n.link({splitter, 3}, {dark, 0}, 0);
    for (int a : {0, 1}) {
      std::string const arm = a == 0 ? "x" : "y";
      input[a] = n.add_mirror("input " + arm, {.transmission = input_transmission, .suspension = free});
      end[a] = n.add_mirror("end " + arm, {.transmission = end_transmission, .loss = loss, .suspension = free});
      behind[a] = n.add_dump("behind " + arm);
      n.link({splitter, a == 0 ? 2u : 1u}, {input[a], 0}, short_arm, a == 0 ? 0 : pi / 2);
      n.link({input[a], 1}, {end[a], 0}, length, pi / 2);
      n.link({end[a], 1}, {behind[a], 0}, 0);
    }
  }
  std::uint32_t port(ComponentId c, std::uint32_t number) const { return n.number_of({c, number}); }
  // Angle at which the homodyne detector sees differential length.
  double signal_angle(SteadyField const& f) const {
    Phasor const a = LinearResponse(n, f, Readout::homodyne(port(dark, 0), 0), 1e3).to_displacement(end[0]),
                 b = LinearResponse(n, f, Readout::homodyne(port(dark, 0), pi / 2), 1e3).to_displacement(end[0]);
    return std::atan2(std::real(b / (a + b)), std::real(a / (a + b)));
  }
};
// Per m of DARM: half of it on either arm.
Phasor darm(LinearResponse const& r, Detector const& d) {
  return 0.5 * (r.to_displacement(d.end[0]) - r.to_displacement(d.end[1]));
}

// A23, eq. 12.6: quantum noise of a lossless interferometer without signal recycling.
TEST(Response, QuantumNoiseA23) {
  double const transmission = 0.014, length = 2999.8, mass = 42, arm_power = 650e3;
  double const gain = transmission / std::pow(1 - std::sqrt(1 - transmission), 2);
  Detector const d(transmission, 0, 0, length, mass, 2 * arm_power / gain);
  SteadyField const f(d.n);
  EXPECT_NEAR(f.power_in(d.port(d.end[0], 0)), arm_power, 1e-6 * arm_power);
  double const angle = d.signal_angle(f);
  struct Row {
    double hz, strain;
  };
  for (Row const& row : {Row{10, 3.1093e-22}, {100, 2.3971e-24}, {1000, 1.6101e-23}}) {
    LinearResponse const r(d.n, f, Readout::homodyne(d.port(d.dark, 0), angle), row.hz);
    double const strain = std::sqrt(r.quantum_noise()) / std::abs(darm(r, d)) / length;
    // eq. 12.6 takes gamma = T c/(4L), to first order in T
    EXPECT_NEAR(strain / row.strain, 1, 0.01) << row.hz;
    double const limit = std::sqrt(8 * hbar / (mass * std::pow(2 * pi * row.hz * length, 2)));
    EXPECT_GT(strain, limit) << "below the quantum limit";
    // Control: free of radiation pressure, only shot noise is left.
    Detector const heavy(transmission, 0, 0, length, infinity, 2 * arm_power / gain);
    LinearResponse const q(heavy.n, f, Readout::homodyne(d.port(d.dark, 0), angle), row.hz);
    double const shot = std::sqrt(q.quantum_noise()) / std::abs(darm(q, heavy)) / length;
    if (row.hz < 50) {
      EXPECT_LT(shot, 0.1 * strain);
    }
  }
}

// Squeezed vacuum of 10 dB at the dark port lowers shot noise by it; the wrong quadrature raises it.
TEST(Response, Squeezing) {
  Detector const d(0.014, 0, 0, 3000, infinity, 1000);
  SteadyField const f(d.n);
  double const angle = d.signal_angle(f);
  LinearResponse const r(d.n, f, Readout::homodyne(d.port(d.dark, 0), angle), 100);
  double const plain = r.quantum_noise();
  EXPECT_NEAR(plain, hbar * 2 * pi * speed_of_light / wavelength / 2, 1e-6 * plain);  // of a vacuum: 2 (h nu/4)
  double least = infinity, most = 0;
  for (int i = 0; i < 64; ++i) {
    Squeezing const injected{d.port(d.dark, 0), squeezed_vacuum(0.1, 10), pi * i / 64};
    double const ratio = r.quantum_noise(std::array{injected}) / plain;
    least = std::fmin(least, ratio);
    most = std::fmax(most, ratio);
  }
  // Losses of the end mirrors are none here, but the cavities turn the quadrature: the best of 64 angles.
  EXPECT_NEAR(least, 0.1, 0.03);
  EXPECT_NEAR(most, 10, 0.3);
}

// The value of a homodyne detector is the quadrature of the carrier of which it gives the response: their squares sum
// to the power, and a step of a mirror changes it as the response at low frequency says.
TEST(Response, HomodyneValueAndResponseAreOneQuadrature) {
  Network n(1064e-9);
  ComponentId const laser = n.add_laser("laser", 4), one = n.add_mirror("one", {.transmission = 0.25}),
                    two = n.add_mirror("two", {.transmission = 0.25});
  n.link({laser, 0}, {one, 0}, 0);
  n.link({one, 1}, {two, 0}, 1, 0.3);
  std::uint32_t const out = n.number_of({two, 1});
  auto const value = [&](double angle) { return value_of(Readout::homodyne(out, angle).of_leaving(), SteadyField(n)); };
  SteadyField const f(n);
  EXPECT_NEAR(std::hypot(value(0.2), value(0.2 + pi / 2)) / std::sqrt(f.power_out(out)), 1, 1e-12);
  double const step = 1e-13;
  LinearResponse const r(n, f, Readout::homodyne(out, 0.2).of_leaving(), 1e-3);
  n.move(two, step);
  double const moved = value(0.2);
  n.move(two, -step);
  EXPECT_NEAR((moved - value(0.2)) / (2 * step) / std::real(r.to_displacement(two)), 1, 1e-5);
}

// Eq. 9.1 to 9.4, A14: stray light inside an arm and behind its end mirror, as arm length, through the dark port.
TEST(Response, InjectionPointsA14) {
  double const length = 3000, te = 4.4e-6, hz = 1;
  ArmCavity const arm{length, 0.014, te, 75e-6};
  Detector const d(0.014, te, 75e-6, length, infinity, 1000);
  SteadyField const f(d.n);
  LinearResponse const r(d.n, f, Readout::homodyne(d.port(d.dark, 0), d.signal_angle(f)), hz);
  Phasor const per_metre = r.to_displacement(d.end[0]);
  // Light that joins on its way from the end to the input mirror: 1/(r1 r2) times eq. 9.1 for the round trip.
  double const inside = std::abs(r.to_phase(d.port(d.input[0], 1)) / per_metre);
  EXPECT_NEAR(inside * 2 * k, 1, 1e-3);
  EXPECT_NEAR(inside * 1e-9, equivalent_length(arm, wavelength, {0, 1e-9 * arm.r1() * arm.r2()}, 0),
              1e-3 * inside * 1e-9);
  // One short arm, eq. 9.5.
  double const before = std::abs(r.to_phase(d.port(d.input[0], 0)) / per_metre);
  EXPECT_NEAR(before * 2 * k / (pi / (2 * finesse(arm))), 1, 0.01);
  EXPECT_NEAR(before * 1e-9, equivalent_length(arm, wavelength, 0, {0, 1e-9}), 2e-3 * before * 1e-9);
}

// Eq. 9.2 and 8.6: radiation pressure of stray light in an arm, without and with signal recycling, against its
// closed form with the gain Gamma.
TEST(Response, RadiationPressureEq9_2) {
  double const length = 3000, mass = 42;
  for (double const hz : {10.0, 50.0, 200.0}) {
    ArmCavity const arm{length, 0.014, 0, 0};
    Detector const d(0.014, 0, 0, length, mass, 1000);
    SteadyField const f(d.n);
    double const power = f.power_in(d.port(d.end[0], 0));
    LinearResponse const r(d.n, f, Readout::homodyne(d.port(d.dark, 0), d.signal_angle(f)), hz);
    Phasor const strain = r.to_amplitude(d.port(d.input[0], 1)) / r.to_displacement(d.end[0]) / length;
    Phasor const closed = strain_per_amplitude_in_arm(hz, power, mass, length, differential_mode(arm, 1));
    EXPECT_NEAR(std::abs(strain) / std::abs(closed), 1, 0.02) << hz;
  }
}

// R2.12, eq. 6.10 and Pound-Drever-Hall: on resonance the error signal is zero, and its slope is that of the cavity.
TEST(Response, PoundDreverHallR2_12) {
  Network n(wavelength);
  ComponentId const laser = n.add_laser("laser", 1), modulator = n.add_modulator("eom", 0.2, 9e6),
                    isolator = n.add_splitter("pick-off", {.transmission = 0.99}),
                    input = n.add_mirror("input", {.transmission = 0.02}),
                    end = n.add_mirror("end", {.transmission = 1e-4}), diode = n.add_dump("diode"),
                    dump = n.add_dump("dump"), other = n.add_dump("other");
  n.link({laser, 0}, {modulator, 0}, 0);
  n.link({modulator, 1}, {isolator, 0}, 0);
  n.link({isolator, 2}, {input, 0}, 0);
  n.link({isolator, 3}, {diode, 0}, 0);
  n.link({isolator, 1}, {other, 0}, 0);
  n.link({input, 1}, {end, 0}, 100.3, pi / 2);
  n.link({end, 1}, {dump, 0}, 0);
  std::uint32_t const port = n.number_of({diode, 0});
  auto const error = [&](double x, double phase) {
    n.move(end, x);
    SteadyField const f(n);
    return demodulated(f, port, 9e6, phase);
  };
  for (double const phase : {0.0, pi / 2}) {
    EXPECT_NEAR(error(0, phase), 0, 1e-15 + 1e-9 * std::fabs(error(1e-9, phase)));
    double const slope = (error(1e-14, phase) - error(-1e-14, phase)) / 2e-14;
    n.move(end, 0);
    SteadyField const f(n);
    Phasor const response = LinearResponse(n, f, Readout::demodulated(port, 9e6, phase), 1e-3).to_displacement(end);
    EXPECT_NEAR(std::real(response), slope, 1e-3 * std::fabs(slope) + 1e-3);
  }
}

}  // namespace
}  // namespace straytrace::ifo_response
