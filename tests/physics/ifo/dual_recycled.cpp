// SPDX-License-Identifier: BSD-3-Clause
// Dual-recycled interferometers from parameters: docs/theory/interferometer.md and docs/theory/sensitivity.md, B6,
// R2.03, R2.09, R2.13.
#include "ifo/dual_recycled.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/every_module.hpp"
#include "ifo/fabry_perot_michelson.hpp"
#include "physics/ifo/demodulated.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_dual_recycled {
namespace {

using straytrace::testing::demodulated;

DualRecycledParameters preset(std::string_view name) {
  for (DualRecycledPreset const& p : dual_recycled_presets())
    if (p.name == name) return p.parameters;
  throw std::out_of_range("no such preset");
}
ArmCavity arm_of(DualRecycledParameters const& p) {
  return {p.arm_length, p.input_transmission, p.end_transmission, p.round_trip_loss};
}
// Light ends in arms alone: lossless, free of offsets, no radiation pressure.
DualRecycledParameters plain(double input, double signal) {
  DualRecycledParameters p;
  p.arm_length = 3000;
  p.input_transmission = input;
  p.input_power = 1;
  p.signal_recycling_transmission = signal;
  return p;
}

// B6, eq. 6.11: the network loses light at the splitter in each of two passes, half of it before the arms.
TEST(DualRecycled, ArmPowersB6) {
  for (DualRecycledPreset const& each : dual_recycled_presets()) {
    DualRecycled const d(each.parameters);
    DualRecycledParameters const& p = d.parameters();
    double const closed = arm_power(arm_of(p), p.input_power, p.power_recycling_transmission, p.beam_splitter_loss);
    EXPECT_NEAR(d.arm_power() / closed, 1, 2e-3) << each.name;
    EXPECT_NEAR(d.power_at("ETMy", 0) / d.arm_power(), 1, 1e-6) << each.name;
  }
  EXPECT_NEAR(DualRecycled(preset("et-hf")).arm_power() / 3.0593e6, 1, 1e-3);
  EXPECT_NEAR(DualRecycled(preset("et-lf")).arm_power() / 18.188e3, 1, 1e-3);
  EXPECT_NEAR(DualRecycled(preset("adv")).arm_power() / 650e3, 1, 0.03);
  EXPECT_NEAR(DualRecycled(preset("aligo")).arm_power() / 750e3, 1, 0.01);
  EXPECT_NEAR(DualRecycled(preset("kagra")).arm_power() / 340e3, 1, 1e-9);  // given
  DualRecycledParameters control = preset("et-hf");
  control.beam_splitter_loss = 0;
  EXPECT_GT(std::fabs(DualRecycled(control).arm_power() / 3.0593e6 - 1), 0.02) << "control: no loss at the splitter";
}

// R2.03: what leaves equals what enters, through arms, recycling, offsets and modulators.
TEST(DualRecycled, LosslessOnesConservePowerR2_03) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int repeat = 0; repeat < 10; ++repeat) {
    DualRecycledParameters p = plain(0.01 + 0.1 * uniform(generator), 0.05 + 0.9 * uniform(generator));
    p.end_transmission = 1e-3 * uniform(generator);
    p.power_recycling_transmission = 0.05 + 0.9 * uniform(generator);
    p.signal_recycling_tuning = uniform(generator);
    p.splitter_transmission = 0.3 + 0.4 * uniform(generator);
    p.transmission_difference = 0.1 * uniform(generator);
    p.dark_fringe_offset = 1e-10 * uniform(generator);
    p.short_arm = 5;
    p.schnupp_asymmetry = uniform(generator);
    std::vector<Modulation> modulators;
    if (repeat % 2 == 1) modulators.push_back({10e6, 1e-7});  // bands beyond the first: 1e-15 of the power
    DualRecycled const d(p, modulators);
    double leaving = 0;
    for (char const* end : {"dark", "bench_x", "bench_y"}) leaving += d.power_at(end, 0);
    leaving += d.power_at("laser", 0);
    EXPECT_NEAR(leaving, 1, 1e-12) << repeat;
    p.round_trip_loss = 1e-9;
    DualRecycled const control(p, modulators);
    double kept = control.power_at("laser", 0);
    for (char const* end : {"dark", "bench_x", "bench_y"}) kept += control.power_at(end, 0);
    EXPECT_GT(1 - kept, 1e-12) << "control: a part in 1e9 is lost";
  }
}

// R2.03 with modulators of any index: all bands that carry light are kept, and light passes them once.
TEST(DualRecycled, ModulatorsConservePowerR2_03) {
  for (int const order : {12, 2}) {
    Network n(1064e-9);
    ComponentId const laser = n.add_laser("laser", 3), eom = n.add_modulator("eom", 0.8, 7e6, order),
                      input = n.add_mirror("input", {.transmission = 0.1}),
                      end = n.add_mirror("end", {.transmission = 0.05}), dump = n.add_dump("dump"),
                      isolator = n.add_splitter("splitter", {.transmission = 0.5}), left = n.add_dump("left"),
                      right = n.add_dump("right");
    n.link({laser, 0}, {eom, 0}, 0);
    n.link({eom, 1}, {isolator, 0}, 0);
    n.link({isolator, 1}, {left, 0}, 0);
    n.link({isolator, 2}, {input, 0}, 0);
    n.link({isolator, 3}, {right, 0}, 0);
    n.link({input, 1}, {end, 0}, 3.2, pi / 2 + 0.01);
    n.link({end, 1}, {dump, 0}, 0);
    SteadyField const field(n);
    double leaving = 0;
    for (ComponentId c : {left, right, dump}) leaving += field.power_in(n.number_of({c, 0}));
    // The light that the input mirror returns through the splitter to the modulator.
    leaving += field.power_in(n.number_of({eom, 1}));
    if (order == 12)
      EXPECT_NEAR(leaving / 3, 1, 1e-12);
    else
      EXPECT_GT(std::fabs(leaving / 3 - 1), 1e-6) << "control: bands left out";
  }
}

// Eq. 6.8, trap 14.4: the gain of stray light in an arm, and its pole.
TEST(DualRecycled, GainOfStrayLightEq6_8) {
  struct Row {
    double input, signal, gain;
  };
  for (Row const& row : {Row{0.014, 0.325, 14.4},
                         {0.014, 0.35, 15.72},
                         {0.014, 0.2, 8.4},
                         {0.007, 0.05, 4.15},
                         {0.007, 0.2, 16.4},
                         {0.014, 1, 142.36}}) {
    DualRecycledParameters const p = plain(row.input, row.signal);
    DualRecycled const d(p);
    DifferentialMode const closed = differential_mode(arm_of(p), row.signal);
    EXPECT_NEAR(std::abs(d.stray_gain(0.01)) / closed.gain, 1, 1e-6);
    EXPECT_NEAR(closed.gain / row.gain, 1, 5e-3);
    // The closed pole takes sin(x) = x for the half round trip: 3 % at a gain of 4.
    EXPECT_NEAR(d.pole() / closed.pole, 1, 1.2 / (closed.gain * closed.gain) + 1e-3) << row.gain;
  }
  DualRecycledParameters detuned = plain(0.007, 0.05);
  detuned.signal_recycling_tuning = 0.1;
  double const tuned = differential_mode(arm_of(detuned), 0.05).gain;
  EXPECT_GT(std::abs(DualRecycled(detuned).stray_gain(0.01)) / tuned, 1.005) << "control: not tuned";
}

// R2.09: a signal-recycling mirror that transmits all changes nothing, and power recycling only the power.
TEST(DualRecycled, WithoutMirrorsR2_09) {
  DualRecycledParameters p = plain(0.014, 1);
  p.round_trip_loss = 75e-6;
  p.end_transmission = 1e-6;
  p.arm_length = 2999.8;
  DualRecycled const d(p);
  EXPECT_NEAR(d.arm_power(), 280.687 / 2, 1e-3);  // A10
  EXPECT_NEAR(d.pole(), 56.3651, 1e-3);
  p.signal_recycling_tuning = 0.7;
  EXPECT_NEAR(DualRecycled(p).pole(), d.pole(), 1e-6);
  p.signal_recycling_transmission = 0.9;
  EXPECT_GT(std::fabs(DualRecycled(p).pole() / d.pole() - 1), 0.01) << "control: a mirror of 10 %";
}

// Eq. 12.6, A23: 650 kW in the arms, no signal recycling, whatever the power recycling.
TEST(DualRecycled, QuantumNoiseA23) {
  DualRecycledParameters p = plain(0.014, 1);
  p.arm_length = 2999.8;
  p.mirror_mass = 42;
  p.arm_power = 650e3;
  p.power_recycling_transmission = 0.05;
  p.round_trip_loss = 1e-9;
  DualRecycled const d(p);
  EXPECT_NEAR(d.quantum_noise(10) / 3.1093e-22, 1, 0.01);  // eq. 12.6 to first order in the transmission
  EXPECT_NEAR(d.quantum_noise(100) / 2.3971e-24, 1, 0.01);
  EXPECT_NEAR(d.quantum_noise(1000) / 1.6101e-23, 1, 0.01);
  p.squeezing = 0.1;
  double const squeezed = DualRecycled(p).quantum_noise(1000);
  EXPECT_NEAR(squeezed / d.quantum_noise(1000), std::sqrt(0.1), 1e-3);
  EXPECT_NEAR(DualRecycled(p).quantum_noise(10) / d.quantum_noise(10), std::sqrt(0.1), 1e-3);  // angle follows
  p.injection_loss = 0.2;
  EXPECT_NEAR(DualRecycled(p).quantum_noise(1000) / d.quantum_noise(1000), std::sqrt(0.8 * 0.1 + 0.2), 1e-3);
  p.squeezing_angle = pi / 2;
  EXPECT_GT(DualRecycled(p).quantum_noise(1000), 2 * d.quantum_noise(1000)) << "control: the other quadrature";
}

// A23 to 1e-4. Eq. 12.6 has gamma = T c/(4L) and phases of sidebands to first order in T and in f L/c: with T, L and
// the power a hundred times smaller, gamma and K stay, h is a hundred times larger, and the neglected terms fall
// equally.
TEST(DualRecycled, QuantumNoiseInTheLimitOfA23) {
  struct Row {
    double hz, strain;
  };
  for (Row const& row : {Row{10, 3.1093e-22}, {100, 2.3971e-24}, {1000, 1.6101e-23}}) {
    auto const off = [&](double scale, double signal = 1) {
      DualRecycledParameters p = plain(0.014 / scale, signal);
      p.arm_length = 2999.8 / scale;
      p.mirror_mass = 42;
      p.arm_power = 650e3 / scale;
      return DualRecycled(p).quantum_noise(row.hz) / (scale * row.strain) - 1;
    };
    EXPECT_LT(std::fabs(off(100)), 1e-4) << row.hz;
    EXPECT_NEAR((off(10) - off(1000)) / (off(100) - off(1000)), 11, 0.5) << row.hz;  // 0.099 / 0.009: first order
    EXPECT_GT(std::fabs(off(1)), 1e-3) << "control: T as it is";
    EXPECT_GT(std::fabs(off(100, 0.99)), 1e-3) << "control: a signal-recycling mirror of 1 %";
  }
}

// Eq. 6.8: what is lost between splitter and signal-recycling mirror lowers its reflection; one pass of it is read-out
// loss when there is no mirror.
TEST(DualRecycled, LossOfTheSignalCavityEq6_8) {
  DualRecycledParameters p = plain(0.014, 0.2);
  p.signal_cavity_loss = 0.1;
  double const gain = differential_mode(arm_of(p), 1 - 0.8 * 0.9).gain;
  EXPECT_NEAR(std::abs(DualRecycled(p).stray_gain(0.01)) / gain, 1, 1e-6);
  p.signal_cavity_loss = 0;
  EXPECT_GT(std::fabs(std::abs(DualRecycled(p).stray_gain(0.01)) / gain - 1), 0.05) << "control: not lost";
  p.signal_recycling_transmission = 1;
  DualRecycledParameters later = p;
  p.signal_cavity_loss = 0.1;
  later.readout_loss = 1 - std::sqrt(0.9);
  EXPECT_NEAR(DualRecycled(p).quantum_noise(100) / DualRecycled(later).quantum_noise(100), 1, 1e-9);
}

// Kimble et al. 2001: a filter cavity of half width and detuning Omega_SQL/sqrt(2) turns squeezed vacuum so that it
// helps below and above K = 1 (eq. 12.6). It needs the pole of the arm far above: 3 % here.
TEST(DualRecycled, FilterCavityOfKimble) {
  DualRecycledParameters p = plain(0.02, 1);
  p.arm_length = 300;
  p.mirror_mass = 420;
  p.arm_power = 650e3;
  double const width = p.input_transmission * speed_of_light / (4 * p.arm_length),
               standard = std::sqrt(16 * 2 * pi * speed_of_light / p.wavelength * p.arm_power /
                                    (p.mirror_mass * speed_of_light * p.arm_length * width));
  FilterCavity filter{.length = 30, .detuning = -standard / std::sqrt(2) / (2 * pi)};
  filter.input_transmission = 4 * filter.length * standard / std::sqrt(2) / speed_of_light;
  filter.end_transmission = filter.loss = 0;
  DualRecycledParameters turned = p, plainly = p;
  turned.squeezer = Squeezer{.decibels = 10, .cavities = {filter}};
  plainly.squeezer = Squeezer{.decibels = 10};
  DualRecycled const without(p), with(turned), fixed(plainly);
  for (double const share : {0.1, 0.4, 1.0, 1.6}) {
    double const hz = share * standard / (2 * pi);
    EXPECT_NEAR(with.quantum_noise(hz) / without.quantum_noise(hz), std::sqrt(0.1), 0.03 * std::sqrt(0.1)) << hz;
  }
  EXPECT_GT(fixed.quantum_noise(3), 3 * without.quantum_noise(3)) << "control: no cavity";
}

// R2.13: the map is invertible; the sixth direction is what no light sees.
TEST(DualRecycled, DegreesOfFreedomR2_13) {
  EXPECT_LT((freedoms_of_lengths() * lengths_of_freedoms() - LengthMatrix::Identity()).cwiseAbs().maxCoeff(), 1e-14);
  DualRecycledParameters p = preset("adv");
  p.mirror_mass = infinity;
  p.loss_difference = 20e-6;
  DualRecycled const d(p);
  LinearResponse const r = d.response(0.01);
  double const darm = std::abs(d.to_freedom(r, Freedom::darm));
  EXPECT_LT(std::abs(d.to_freedom(r, Freedom::mean_short)), 1e-8 * darm);
  EXPECT_NEAR(std::abs(d.to_freedom(r, Freedom::mich)) * 2 * finesse(arm_of(p)) / pi / darm, 1, 0.01);
  EXPECT_GT(std::abs(d.to_freedom(r, Freedom::srcl)), 1e-6 * std::abs(d.to_freedom(r, Freedom::mean_short)))
      << "control: a length that light sees";
  // The splitter itself, along its normal at 45 degrees, is a change of ly and of -ls by sqrt(2).
  LengthMatrix const m = freedoms_of_lengths();
  Eigen::Matrix<double, 6, 1> moved = Eigen::Matrix<double, 6, 1>::Zero();
  moved[Eigen::Index(Length::short_y)] = std::sqrt(2);
  moved[Eigen::Index(Length::signal)] = -std::sqrt(2);
  Eigen::Matrix<double, 6, 1> const freedoms = m * moved;
  Phasor sum = 0;
  for (Eigen::Index f = 0; f < 6; ++f) sum += freedoms[f] * d.to_freedom(r, Freedom(f));
  Phasor const splitter = r.to_displacement(d.network().find("BS"));
  EXPECT_LT(std::abs(sum - splitter), 1e-6 * std::abs(splitter));
}

// R2.12: error signals of a locked interferometer follow small steps of each length.
TEST(DualRecycled, DemodulatedResponsesAreSlopes) {
  DualRecycledParameters p = preset("adv");
  p.mirror_mass = infinity;
  std::vector<Modulation> const modulators = {{6270777, 0.1}};
  DualRecycled const d(p, modulators);
  std::uint32_t const port = d.network().number_of({d.network().find("laser"), 0});
  for (double const phase : {0.0, pi / 2}) {
    LinearResponse const r = d.response(Readout::demodulated(port, modulators[0].hz, phase), 1e-4);
    for (Freedom const f : {Freedom::carm, Freedom::prcl}) {
      auto const light = [&](double step) {
        Network moved = d.network();
        Eigen::Matrix<double, 6, 1> const length = lengths_of_freedoms().col(Eigen::Index(f)) * step;
        auto const by = [&](char const* name, double x) {
          ComponentId const id = moved.find(name);
          moved.move(id, moved.components()[id.value].displacement + x);
        };
        for (int y : {0, 1}) {
          by(y ? "ITMy" : "ITMx", length[2 + y]);
          by(y ? "ETMy" : "ETMx", length[2 + y] + length[y]);
        }
        by("PRM", -length[4]);
        by("SRM", length[5]);
        return demodulated(SteadyField(moved), port, modulators[0].hz, phase);
      };
      double const step = f == Freedom::carm ? 1e-16 : 1e-13, slope = (light(step) - light(-step)) / (2 * step);
      double const response = std::real(d.to_freedom(r, f));
      EXPECT_NEAR(response, slope, 1e-3 * std::fabs(slope) + 1e-3 * std::abs(d.to_freedom(r, f)))
          << int(f) << " " << phase;
    }
  }
}

}  // namespace
}  // namespace straytrace::ifo_dual_recycled
