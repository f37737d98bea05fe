// SPDX-License-Identifier: BSD-3-Clause
// Answers about networks: resonators, energy, error signals, responses, against closed forms
// (docs/theory/interferometer.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/every_module.hpp"
#include "ifo/dual_recycled.hpp"
#include "ifo/fabry_perot_michelson.hpp"
#include "ifo/layout/operating_point.hpp"
#include "ifo/layout/signals.hpp"
#include "physics/ifo/network_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_layout {
namespace {

using namespace straytrace::testing;

NetworkModel modelled(ModulatedCavity const& c) {
  NetworkModel m{.preset = "none", .network = c.network};
  m.readouts = {{"T", Readout::power(c.network.number_of({c.end, 1})).of_leaving()}, {"PDH", c.error_signal(0)}};
  m.freedoms = {{"LENGTH", {{c.end, 1}}}};
  return m;
}

// Eq. 6.5.
TEST(NetworkCavities, FinesseAndPole) {
  std::vector<NetworkCavity> const found = cavities_of(ModulatedCavity(0).network);
  ASSERT_EQ(found.size(), 1u);
  ArmCavity const closed{3000, 0.02, 0.004, 0};
  EXPECT_EQ(found[0].name, "M1-M2");
  EXPECT_EQ(found[0].length, 6000);
  EXPECT_LT(deviation(found[0].finesse(), finesse(closed)), 1e-12);
  EXPECT_LT(deviation(found[0].pole(), cavity_pole(closed)), 1e-12);
  EXPECT_NEAR(found[0].phase, 0, 1e-12);
  EXPECT_NEAR(cavities_of(ModulatedCavity(1e-9).network)[0].phase, 4 * pi * 1e-9 / light_wavelength, 1e-12);
  EXPECT_GT(relative(finesse({3000, 0.02, 0.008, 0}), found[0].finesse()), 0.1) << "control";
}

TEST(NetworkCavities, RingsAndRecycling) {
  Ring const ring(0);
  std::vector<NetworkCavity> const of_ring = cavities_of(ring.network);
  ASSERT_EQ(of_ring.size(), 1u) << "both directions are one";
  EXPECT_NEAR(of_ring[0].length, 0.4 + 2 * 143.226, 1e-9);
  EXPECT_NEAR(of_ring[0].round_trip, 0.9975 * std::sqrt(1 - 105e-6), 1e-12);
  DualRecycled const adv(dual_recycled_presets()[0].parameters);
  std::vector<std::string> names;
  for (NetworkCavity const& c : cavities_of(adv.network())) names.push_back(c.name);
  for (char const* name : {"ITMx-ETMx", "ITMy-ETMy", "PRM-BS-ITMx", "PRM-BS-ITMy"})
    EXPECT_TRUE(std::ranges::find(names, name) != names.end()) << name;
  EXPECT_EQ(names.size(), 6u);
}

TEST(NetworkEnergy, BalanceCloses) {
  for (double const moved : {0.0, 1e-10}) {
    Ring const ring(moved);
    OperatingPoint const p = operating_point({.preset = "none", .network = ring.network});
    EXPECT_EQ(p.emitted, 1);
    EXPECT_NEAR(p.missing, 0, 1e-12);
    double lost = 0;
    for (EnergyRow const& row : p.energy)
      if (row.kind == EnergyRow::Kind::lost) lost += row.power;
    double const on_third = SteadyField(ring.network).power_in(ring.network.number_of({ring.third, 0}));
    EXPECT_LT(deviation(lost, 100e-6 * on_third), 1e-12);
    EXPECT_GT(lost, 1e-3) << "control: without it the balance would not close";
  }
}

TEST(NetworkEnergy, LightOfALaserWithoutASpaceLeaves) {
  NetworkModel m{.preset = "none", .network = Network(light_wavelength)};
  m.network.add_laser("laser", 3);
  OperatingPoint const p = operating_point(m);
  ASSERT_EQ(p.energy.size(), 3u);
  EXPECT_EQ(p.energy[1].kind, EnergyRow::Kind::leaving);
  EXPECT_NEAR(p.missing, 0, 1e-12);
}

// Case T2 by names, and the linear range: the slope of a Lorentzian's dispersion x/(1 + x^2) is (1 - x^2)/(1 + x^2)^2.
TEST(NetworkSignals, ErrorSignalOfACavity) {
  NetworkModel const m = modelled(ModulatedCavity(0));
  std::vector<ErrorSignal> const all = error_signals(m);
  ASSERT_EQ(all.size(), 1u) << "power has no slope on resonance";
  EXPECT_EQ(all[0].readout, "PDH");
  EXPECT_LT(deviation(all[0].slope, -1.62210783e8), 1e-7);
  EXPECT_LT(deviation(all[0].best_slope, std::hypot(1.62210783e8, 1.2165863e4)), 1e-7);
  EXPECT_NEAR(std::remainder(all[0].best_phase - std::atan2(1.2165863e4, -1.62210783e8), 2 * pi), 0, 1e-7);
  double const half_width = light_wavelength / (4 * finesse({3000, 0.02, 0.004, 0})), u = 0.1;
  // (1 - x^2) = (1 - u)(1 + x^2)^2
  double const square = (-(3 - 2 * u) + std::sqrt((3 - 2 * u) * (3 - 2 * u) + 4 * (1 - u) * u)) / (2 * (1 - u));
  EXPECT_LT(deviation(all[0].linear_range, 2 * half_width * std::sqrt(square)), 2e-3);
  EXPECT_LT(deviation(error_signals(modelled(ModulatedCavity(0.2e-9)))[1].offset(), -0.2e-9), 0.1);
}

TEST(NetworkSignals, ScansMoveOneNumber) {
  NetworkModel const m = modelled(ModulatedCavity(0));
  for (char const* name : {"LENGTH", "M2.displacement"}) {
    NetworkScan const scan = scan_network(m, {{*find_parameter(m, name), -0.2e-9, 0.2e-9, 3}});
    EXPECT_EQ(scan.axes[0].at(1), 0);
    EXPECT_EQ(scan.axes[0].at(2), 0.2e-9);
    EXPECT_LT(deviation(scan.values[1][2], -0.03125225501), 1e-7) << name;
  }
  NetworkScan const tuned =
      scan_network(m, {{*find_parameter(m, "M2.tuning"), 0, 2 * pi * 0.2e-9 / light_wavelength, 2}});
  EXPECT_LT(deviation(tuned.values[1][1], -0.03125225501), 1e-7);
  NetworkScan const grid = scan_network(
      m, {{*find_parameter(m, "LENGTH"), -0.2e-9, 0.2e-9, 3}, {*find_parameter(m, "laser.power"), 1, 2, 2}});
  ASSERT_EQ(grid.values[1].size(), 6u);
  EXPECT_LT(deviation(grid.values[1][2], -0.03125225501), 1e-7);
  EXPECT_LT(deviation(grid.values[1][5], -2 * 0.03125225501), 1e-7) << "the first axis is the fastest";
  NetworkScan const off = scan_network(m, {{*find_parameter(m, "EOM.index"), 0, 0.1, 2}});
  EXPECT_TRUE(std::isnan(off.values[1][0]));
  EXPECT_LT(deviation(off.values[0][1], SteadyField(m.network).power_out(m.readouts[0].readout.port)), 1e-12);
  EXPECT_FALSE(find_parameter(m, "M2.power"));
  for (std::string const& name : parameter_names(m)) {
    auto const p = find_parameter(m, name);
    ASSERT_TRUE(p) << name;
    NetworkModel same = m;
    p->set(same, p->value);
    EXPECT_NEAR(value_of(same.readouts[0].readout, SteadyField(same.network)) /
                    value_of(m.readouts[0].readout, SteadyField(m.network)),
                1, 1e-9)
        << name;
  }
}

// Case T18: m/N with an optical spring, conjugate for exp(+iwt); a change of the frequency of the laser acts as one of
// the length, df/f = dL/L, where light is stored and f is low.
TEST(NetworkSignals, Transfers) {
  NetworkModel spring{.preset = "none", .network = Network(light_wavelength)};
  Network& n = spring.network;
  ComponentId const laser = n.add_laser("laser", 1e4), itm = n.add_mirror("ITM", {.transmission = 0.014}),
                    etm = n.add_mirror(
                        "ETM",
                        {.transmission = 1e-6, .loss = 75e-6, .displacement = 0.3e-9, .suspension = {.mass = 42}});
  n.link({laser, 0}, {itm, 0}, 0, -pi / 4);
  n.link({itm, 1}, {etm, 0}, 3000, -pi / 2);
  std::vector<Phasor> const yields =
      transfer_function(spring, *find_cause(spring, "ETM.force"), *find_effect(spring, "ETM"), {10});
  EXPECT_LT(relative(yields[0], Phasor(4.9180343e-8, 1.4450089e-8)), 1e-6);
  NetworkModel const m = modelled(ModulatedCavity(0));
  auto const to = [&](char const* cause) {
    return transfer_function(m, *find_cause(m, cause), *m.readout("PDH"), {0.1})[0];
  };
  double const hz = speed_of_light / light_wavelength;
  EXPECT_LT(relative(to("laser.frequency"), to("LENGTH") * 3000.0 / hz), 1e-4);
  EXPECT_LT(relative(to("laser.phase"), Phasor(0, 0.1) * to("laser.frequency")), 1e-12) << "df = i f dphi";
  EXPECT_LT(std::abs(to("laser.amplitude")), 1e-3 * std::abs(value_of(m.readouts[0].readout, SteadyField(m.network))))
      << "control: no signal of amplitude at the zero";
}

TEST(NetworkSignals, SensingMatrixAndItsCondition) {
  DualRecycled const adv(dual_recycled_presets()[0].parameters);
  NetworkModel const m = adv.model("adv");
  SensingMatrix const s = sensing_matrix(m, 10);
  EXPECT_LT(deviation(std::abs(s.response(0, 0)), 5.88463731e9), 1e-8) << "AS to DARM, case T17";
  EXPECT_GT(s.condition, 1);
  NetworkModel one = modelled(ModulatedCavity(0.1e-9));
  one.readouts.pop_back();
  EXPECT_NEAR(sensing_matrix(one, 10).condition, 1, 1e-12);
}

}  // namespace
}  // namespace straytrace::ifo_layout
