// SPDX-License-Identifier: BSD-3-Clause
// Places where stray light joins, other than those of docs/theory/interferometer.md: what the network answers there
// against closed forms for carriers and sidebands in two equal arms (docs/theory/interferometer.md,
// eq. 6.4, 6.8, 6.11, 8.6, 9.5, 9.6).
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "physics/ifo/support.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_places {
namespace {

constexpr double wavelength = 1064e-9, k = 2 * pi / wavelength;

// Reflectivity of an arm whose end mirror is `x` off resonance (eq. 6.4).
Phasor returned(ArmCavity const& arm, double x = 0) {
  Phasor const turn = std::polar(arm.r2(), 2 * k * x);
  return -arm.r1() + arm.input_transmission * turn / (1.0 - arm.r1() * turn);
}

// Eq. 8.6 for light in a short arm. In resonant sideband extraction it meets itself behind the signal-recycling mirror
// turned over: 1/(1 + r_s r_arm) of it is left. The power of one arm changes by 2 Re s of that.
TEST(Places, RadiationPressureInTheShortArm) {
  for (double const signal : {1.0, 0.2, 0.05}) {
    DualRecycledParameters p = case_a14();
    p.mirror_mass = 42;
    p.signal_recycling_transmission = signal;
    p.power_recycling_transmission = 0.05;  // no matter: the common part pushes both arms alike
    DualRecycled const d(p);
    double const left = 1 / (1 + std::sqrt(1 - signal) * std::real(returned(arm_of(p))));
    double const reference = std::abs(returned(arm_of(p)));  // light scattered over light joined
    DifferentialMode const mode{left * reference, differential_mode(arm_of(p), signal).pole};
    for (double const hz : {5.0, 20.0, 100.0, 300.0}) {
      double const closed = std::abs(strain_per_amplitude_in_arm(hz, d.arm_power(), 42, 3000, mode)),
                   solved = std::abs(strain(d, InjectionPoint::short_arm, hz).amplitude);
      // The input mirror feels the light outside too, against that inside: T/4.
      EXPECT_NEAR(solved / closed, 1 - p.input_transmission / 4, 1e-3) << signal << " " << hz;
    }
    if (signal < 1) {
      EXPECT_LT(left, 0.6) << "control: without the signal-recycling mirror";
    }
  }
}

// Eq. 9.5 in a whole detector: without an offset of the dark fringe, or with heavy mirrors, it holds to 1 %, with both
// recycling mirrors. With an offset x the two arms are +-x/2 off resonance, and the signal-recycling mirror turns
// some of Im s into power of the arms, which pushes: below 30 Hz of Advanced Virgo that is the larger part.
TEST(Places, PhaseInTheShortArmOfAdvancedVirgo) {
  DualRecycledParameters const adv = dual_recycled_presets()[0].parameters;
  DualRecycledParameters dark = adv, heavy = adv;
  dark.dark_fringe_offset = 0;
  heavy.mirror_mass = infinity;
  auto const phase = [](DualRecycled const& d, double hz) {
    HeldResponse const r(d, hz);
    return r.to_phase(d.injection(InjectionPoint::short_arm)) / r.to_freedom(Freedom::darm) / d.parameters().arm_length;
  };
  DualRecycled const offset(adv), without(dark), held(heavy);
  double const reference = std::abs(returned(arm_of(adv)));  // light scattered over light joined
  for (double const hz : {1.0, 10.0, 100.0}) {
    Phasor const closed = reference * strain_per_phase_in_short_arm(arm_of(adv), wavelength, hz);
    EXPECT_LT(std::abs(phase(without, hz) / closed - 1.0), 0.01) << hz;
    EXPECT_LT(std::abs(phase(held, hz) / closed - 1.0), 0.01) << hz;
  }
  EXPECT_NEAR(std::abs(phase(offset, 10)) / (reference * 4.31e-14), 1, 0.01);
  EXPECT_GT(std::abs(phase(offset, 1)), 50 * std::abs(phase(held, 1))) << "control: an offset and free mirrors";
}

// Power that a stray field in short arm x makes at f = 0, (dPx - dPy)/P: common fields c and differential fields d of
// both short arms, c = in + r_p (R c + D d), d = -r_s (D c + R d), with R and D half the sum and half the difference of
// what the arms return.
double power_difference(DualRecycledParameters const& p, Phasor s) {
  ArmCavity const arm = arm_of(p);
  double const x = p.dark_fringe_offset / 2, rp = std::sqrt(1 - p.power_recycling_transmission),
               rs = std::sqrt(1 - p.signal_recycling_transmission);
  Phasor const sum = 0.5 * (returned(arm, x) + returned(arm, -x)),
               difference = 0.5 * (returned(arm, x) - returned(arm, -x));
  using Pair = std::pair<Phasor, Phasor>;
  auto const fields = [&](Pair const& in) {  // of x and y, for what comes in as common and differential
    Phasor const a = 1.0 - rp * sum, b = -rp * difference, c = rs * difference, e = 1.0 + rs * sum, det = a * e - b * c;
    Phasor const common = (in.first * e - b * in.second) / det, other = (a * in.second - c * in.first) / det;
    return Pair{common + other, common - other};
  };
  Pair const light = fields({1, 0}), stray = fields({0.5 * s * light.first, 0.5 * s * light.first});
  return 2 * std::real(stray.first / light.first - stray.second / light.second);
}

TEST(Places, OffsetTurnsPhaseInTheShortArmIntoPower) {
  DualRecycledParameters p = dual_recycled_presets()[0].parameters;
  p.beam_splitter_loss = 0;
  double const hz = 0.5;
  DualRecycled const d(p);
  HeldResponse const r(d, hz);
  Injection const i = d.injection(InjectionPoint::short_arm);
  Phasor const darm = r.to_freedom(Freedom::darm) * p.arm_length;
  // Eq. 8.6 for one arm: 4 dP/(c M w^2) of its length.
  double const per_power =
      std::abs(returned(arm_of(p), p.dark_fringe_offset / 2)) *  // light scattered over light joined
      4 * d.arm_power() / (speed_of_light * p.mirror_mass * std::pow(2 * pi * hz, 2) * p.arm_length);
  EXPECT_NEAR(std::abs(r.to_amplitude(i) / darm) / (per_power * power_difference(p, 1)), 1, 0.01);
  EXPECT_NEAR(std::abs(r.to_phase(i) / darm) / (per_power * power_difference(p, {0, 1})), 1, 0.01);
  EXPECT_NEAR(std::fabs(power_difference(p, {0, 1})), 3.34e-3, 5e-5);
  p.signal_recycling_transmission = 1;
  EXPECT_LT(std::fabs(power_difference(p, {0, 1})), 1e-12) << "control: no signal-recycling mirror";
}

// On its way out of a dark port with an offset x the light is k x of the arms', and so is the sideband of DARM: Re s is
// x/L with the pole of the arm alone, as in eq. 9.5, and 1/(1 + r_s r_arm) of it is left. Im s is not seen. The light
// that is scattered comes back from the signal-recycling mirror: r_s of the light it joins.
TEST(Places, SignalCavity) {
  for (double const signal : {0.8, 0.2}) {
    DualRecycledParameters p = case_a14();
    p.dark_fringe_offset = 4e-12;
    p.signal_recycling_transmission = signal;
    DualRecycled const d(p);
    double const left = 1 / (1 + std::sqrt(1 - signal) * std::real(returned(arm_of(p))));
    for (double const hz : {0.1, 50.0, 500.0}) {
      Strain const s = strain(d, InjectionPoint::signal_cavity, hz);
      double const closed =
          std::sqrt(1 - signal) * left * p.dark_fringe_offset / 3000 * std::hypot(1, hz / cavity_pole(arm_of(p)));
      EXPECT_NEAR(std::abs(s.amplitude) / closed, 1, 1e-3) << signal << " " << hz;
      EXPECT_LT(std::abs(s.phase), 1e-9 * closed) << signal << " " << hz;
      EXPECT_GT(std::fabs(std::abs(s.amplitude) / (closed / std::sqrt(1 - signal)) - 1), 0.1)
          << "control: relative to the light joined";
    }
  }
}

// Three ways to the same place, the way to the splitter: input light passes the power-recycling mirror, light behind it
// is relative to what the splitter returns, light from outside to what the mirror sends back. The ratios are those of
// the carriers at all frequencies: r_arm/(1 - r_p r_arm) and (r_p - r_arm)/(1 - r_p r_arm), the last one in another
// quadrature.
TEST(Places, RecyclingCavityAndSymmetricPort) {
  DualRecycledParameters p = case_a14();
  p.power_recycling_transmission = 0.05;
  p.dark_fringe_offset = 4e-12;
  DualRecycled const d(p);
  double const arm = std::real(returned(arm_of(p), p.dark_fringe_offset / 2)), rp = std::sqrt(0.95);
  for (double const hz : {1.0, 50.0, 500.0}) {
    double const input = strain(d, InjectionPoint::input_bench, hz).both();
    EXPECT_NEAR(strain(d, InjectionPoint::recycling_cavity, hz).both() / input * (1 - rp * arm) / arm, 1, 1e-3) << hz;
    EXPECT_NEAR(strain(d, InjectionPoint::symmetric_port, hz).both() / input * (1 - rp * arm) / (arm - rp), 1, 5e-3)
        << hz;
  }
  EXPECT_GT(1 / (1 - rp * arm), 20) << "control: as the input bench";
}

}  // namespace
}  // namespace straytrace::ifo_places
