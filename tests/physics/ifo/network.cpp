// SPDX-License-Identifier: BSD-3-Clause
// Plane waves in networks against closed forms: R2.02 to R2.09, docs/theory/interferometer.md, eq. 6.4 to 6.11, A10,
// B6.
#include "ifo/network.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/every_module.hpp"
#include "physics/ifo/exact_arm.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_network {
namespace {

// A laser in front of two mirrors; `phase`: one way, beyond resonance.
struct Cavity {
  Network network{1.064e-6};
  ComponentId laser, input, end, dump;
  Cavity(double t1, double t2, double loss, double length, double phase, double power = 1) {
    laser = network.add_laser("laser", power);
    input = network.add_mirror("input", {.transmission = t1});
    end = network.add_mirror("end", {.transmission = t2, .loss = loss});
    dump = network.add_dump("dump");
    network.link({laser, 0}, {input, 0}, 1);
    network.link({input, 1}, {end, 0}, length, pi / 2 + phase);
    network.link({end, 1}, {dump, 0}, 1);
  }
  double circulating() const { return SteadyField(network).power_in(network.number_of({end, 0})); }
  double reflected() const { return SteadyField(network).power_in(network.number_of({laser, 0})); }
  double transmitted() const { return SteadyField(network).power_in(network.number_of({dump, 0})); }
};

// Results of a scan over the length of a cavity. `detuning`: m, of the end mirror.
struct Scan {
  double t1, t2;
  double circulating(double detuning) const { return moved(detuning).circulating(); }
  Cavity moved(double detuning) const {
    Cavity c(t1, t2, 0, 3000, 0);
    c.network.move(c.end, detuning);
    return c;
  }
  // Full width at half of the largest power, m.
  double width() const {
    double inside = 0, outside = 1.064e-6 / 4;  // anti-resonance
    while (outside - inside > 1e-18) {
      double const middle = (inside + outside) / 2;
      (circulating(middle) > circulating(0) / 2 ? inside : outside) = middle;
    }
    return 2 * inside;
  }
};

// R2.05, eq. 6.4 and 6.5: the cavity of the thesis, 3 km, 1 W, reflectivities 0.98 and 0.996.
TEST(Network, FabryPerotR2_05) {
  Scan const scan{0.02, 0.004};
  Cavity const on = scan.moved(0), off = scan.moved(1.064e-6 / 4);
  EXPECT_NEAR(on.circulating(), 138.14, 5e-3);
  EXPECT_NEAR(off.circulating(), 0.00506, 5e-6);
  EXPECT_NEAR(on.reflected(), 0.4474, 5e-5);
  EXPECT_NEAR(on.transmitted(), 0.5526, 5e-5);
  EXPECT_NEAR(scan.circulating(1.064e-6 / 2) / on.circulating(), 1, 1e-9);  // one free spectral range on
  double const width = scan.width(), range = speed_of_light / (2 * 3000);
  EXPECT_NEAR(range, 49965.4, 0.05);
  EXPECT_NEAR(width / 2.050e-9, 1, 3e-4);
  EXPECT_NEAR(1.064e-6 / 2 / width / 259.52, 1, 1e-4);        // finesse
  EXPECT_NEAR(range * width / (1.064e-6 / 2), 192.53, 0.01);  // Hz
  EXPECT_NEAR(range * width / 1.064e-6, 96.27, 0.005);        // pole
  EXPECT_NEAR(finesse({3000, 0.02, 0.004, 0}), 259.52, 5e-3);
  EXPECT_NEAR(cavity_pole({3000, 0.02, 0.004, 0}), 96.27, 5e-3);
  EXPECT_NEAR(finesse({3000, 0.98, 0.004, 0}), 1.37, 5e-3) << "control: 0.98 as a transmission";
}

// R2.05: a cavity of low finesse, where eq. 6.5 is no longer the width of eq. 6.4: the whole scan.
TEST(Network, FabryPerotOfLowFinesseR2_05) {
  Scan const scan{0.1, 0.3};
  double const product = std::sqrt(0.9 * 0.7);
  for (double const share : {0.0, 0.01, 0.05, 0.2, 0.37, 0.5}) {  // of the free spectral range
    Phasor const closed = std::sqrt(0.1) / (1.0 - product * std::polar(1.0, 2 * pi * share));
    Cavity const c = scan.moved(share * 1.064e-6 / 2);
    EXPECT_NEAR(c.circulating() / std::norm(closed), 1, 1e-9) << share;
    EXPECT_NEAR(c.reflected() + c.transmitted(), 1, 1e-12) << share;
    EXPECT_NEAR(c.transmitted() / (0.3 * std::norm(closed)), 1, 1e-9) << share;
  }
  // Half the power: sin(delta/2) = (1 - r1 r2)/(2 sqrt(r1 r2)).
  double const exact = 1.064e-6 / pi * std::asin((1 - product) / (2 * std::sqrt(product)));
  EXPECT_NEAR(scan.width() / exact, 1, 1e-6);
  EXPECT_GT(std::fabs(scan.width() / (1.064e-6 / (2 * finesse({3000, 0.1, 0.3, 0}))) - 1), 1e-3) << "control: eq. 6.5";
}

// A10: Advanced Virgo's arm.
TEST(Network, ArmA10) {
  Cavity const arm(0.014, 1e-6, 75e-6, 2999.8, 0);
  ArmCavity const closed{2999.8, 0.014, 1e-6, 75e-6};
  EXPECT_NEAR(arm.circulating() / power_gain(closed), 1, 1e-6);  // loss as a share of the end mirror's light
  EXPECT_NEAR(arm.circulating(), 280.687, 2e-3);
}

// Eq. 6.6: slope of the phase of reflection, exact and with 8F/lambda, which needs r2 near 1.
TEST(Network, PhaseSlopeR2_06) {
  auto const slope = [](double t2) {  // rad/m
    auto const phase = [&](double x) {
      Cavity const cavity = Scan{0.02, t2}.moved(x);
      return std::arg(SteadyField(cavity.network).in(cavity.network.number_of({cavity.laser, 0}), 0));
    };
    double const dx = 1e-13;
    return std::fabs(std::remainder(phase(dx) - phase(-dx), 2 * pi)) / (2 * dx);
  };
  auto const limit = [](double t2) { return 8 * finesse({3000, 0.02, t2, 0}) / 1.064e-6; };
  EXPECT_NEAR(slope(0.004) / 2.434e9, 1, 3e-4);
  EXPECT_NEAR(limit(0.004) / 1.951e9, 1, 3e-4);
  EXPECT_NEAR(slope(0.004) / limit(0.004), 1.2475, 1e-4);
  EXPECT_NEAR(slope(0) / 2.338e9, 1, 3e-4);
  EXPECT_NEAR(limit(0) / 2.338e9, 1, 3e-4);
  EXPECT_GT(slope(0.004) / limit(0.004), 1.2) << "control: 8F/lambda for an end mirror that transmits";
}

// R2.08, eq. 6.7: a mirror in front of one that reflects 99 % as an arm on resonance does.
TEST(Network, RecyclingGainR2_08) {
  Cavity const recycled(0.05, 0.01, 0, 10, 0);
  EXPECT_NEAR(recycled.circulating(), 54.80, 5e-3);
}

struct Michelson {
  Network network{1.064e-6};
  ComponentId laser, splitter, x, y, dump;
  explicit Michelson(double difference) {  // of the arms, m
    laser = network.add_laser("laser", 1);
    splitter = network.add_splitter("splitter", {.transmission = 0.5, .incidence = pi / 4});
    x = network.add_mirror("x", {.displacement = difference / 2});
    y = network.add_mirror("y", {.displacement = -difference / 2});
    dump = network.add_dump("dark");
    network.link({laser, 0}, {splitter, 0}, 1);
    network.link({splitter, 2}, {x, 0}, 5);
    network.link({splitter, 1}, {y, 0}, 5);
    network.link({splitter, 3}, {dump, 0}, 1);
  }
};

// R2.04, eq. 6.9: power at the two ports; one with a reflection and a transmission of each arm.
TEST(Network, MichelsonR2_04) {
  double const wavelength = 1.064e-6;
  for (double const share : {0.0, 0.125, 0.25, 0.3, 0.5, 1.0}) {
    Michelson const m(share * wavelength);
    SteadyField const field(m.network);
    double const bright = std::pow(std::cos(2 * pi * share), 2);
    EXPECT_NEAR(field.power_in(m.network.number_of({m.dump, 0})), bright, 1e-12) << share;
    EXPECT_NEAR(field.power_in(m.network.number_of({m.laser, 0})), 1 - bright, 1e-12) << share;
  }
}

// R2.03: the powers that leave any lossless network sum to the power that enters.
TEST(Network, LosslessNetworksConservePowerR2_03) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int repeat = 0; repeat < 20; ++repeat) {
    Network n(1.064e-6);
    constexpr int splitters = 8;
    std::vector<NetworkPort> free;
    for (int i = 0; i < splitters; ++i) {
      ComponentId const s = n.add_splitter("s" + std::to_string(i), {.transmission = 0.05 + 0.9 * uniform(generator)});
      for (std::uint32_t p = 0; p < 4; ++p) free.push_back({s, p});
    }
    std::shuffle(free.begin(), free.end(), generator);
    double entering = 0, leaving = 0;
    std::vector<ComponentId> ends;
    for (int i = 0; i < 4; ++i) {
      double const power = i < 2 ? 1 + i : 0;
      ends.push_back(n.add_laser("end" + std::to_string(i), power, uniform(generator)));
      entering += power;
      n.link({ends.back(), 0}, free[std::size_t(i)], 1, 2 * pi * uniform(generator));
    }
    for (std::size_t i = 4; i + 1 < free.size(); i += 2) n.link(free[i], free[i + 1], 1, 2 * pi * uniform(generator));
    SteadyField const field(n);
    for (ComponentId e : ends) leaving += field.power_in(n.number_of({e, 0}));
    EXPECT_NEAR(leaving / entering, 1, 1e-12) << repeat;
  }
}

// Eq. 6.8: with the carrier resonant in the arm and not in the recycling cavity, the arm sees a mirror of T_eff. The
// coupled cavity is a laser behind the signal-recycling mirror.
TEST(Network, SignalRecyclingEq6_8) {
  struct Row {
    double input, recycling, gain;
  };
  for (Row const& row :
       {Row{0.014, 0.325, 14.4}, {0.014, 0.35, 15.72}, {0.014, 0.2, 8.4}, {0.007, 0.05, 4.15}, {0.007, 0.2, 16.4}}) {
    Network n(1.064e-6);
    ComponentId const laser = n.add_laser("laser", 1), srm = n.add_mirror("srm", {.transmission = row.recycling}),
                      itm = n.add_mirror("itm", {.transmission = row.input}),
                      etm = n.add_mirror("etm", {.transmission = 0});
    n.link({laser, 0}, {srm, 0}, 1);
    n.link({srm, 1}, {itm, 0}, 10, pi / 2);  // resonant with the bare input mirror, hence not with the arm
    n.link({itm, 1}, {etm, 0}, 3000, pi / 2);
    SteadyField const field(n);
    double const t_eff = row.input * row.recycling / std::pow(1 - std::sqrt((1 - row.input) * (1 - row.recycling)), 2);
    double const gain = field.power_in(n.number_of({etm, 0}));
    EXPECT_NEAR(gain, t_eff / std::pow(1 - std::sqrt(1 - t_eff), 2), 1e-6 * gain) << row.gain;
    EXPECT_NEAR(1 / (1 - std::sqrt(1 - t_eff)), row.gain, 0.006 * row.gain);
  }
}

}  // namespace
}  // namespace straytrace::ifo_network
