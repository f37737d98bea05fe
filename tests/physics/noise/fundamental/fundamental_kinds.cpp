// SPDX-License-Identifier: BSD-3-Clause
// Kinds of thermal noise as named entries of a budget (R2.22, docs/theory/sensitivity.md, eq. 12.7 to 12.9): each is
// there by name, grows with its own parameter and with no other, and the parts of suspensions are where their modes
// are.
#include <algorithm>

#include "noise/fundamental/budget.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "physics/noise/fundamental/closed_forms.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_fundamental_kinds {
namespace {

Detector detector() {
  Detector d;
  d.arm_length = 3000;
  d.wavelength = 1.064e-6;
  d.arm_power = 650e3;
  d.input = {0.014, 1420, not_a_number, not_a_number, {}};
  d.end = {5e-6, 1683, not_a_number, not_a_number, {}};
  d.power_recycling = 1;
  d.mirror_mass = 42;
  d.mirror_radius = 0.175;
  d.mirror_thickness = 0.2;
  WireMaterial const silica{2200, 772, 1.38, 3.9e-7, 1.52e-4, 4.1e-10, 7.2e10, 1.5e-2};
  SuspensionStage mirror;
  mirror.mass = 42, mirror.length = 0.7, mirror.wires = 4, mirror.wire_radius = 200e-6;
  mirror.temperature = mirror.upper_temperature = 295;
  mirror.upper = mirror.lower = silica;
  d.suspension = SuspensionChain{{mirror}, 1e-3};
  SubstrateMaterial m;
  m.temperature = 295, m.young = 7.27e10, m.poisson = 0.167, m.density = 2200, m.expansion = 3.9e-7;
  m.heat_capacity = 739, m.conductivity = 1.38, m.index = 1.45, m.loss = 1e-8, m.loss_exponent = 0, m.surface_loss = 0;
  m.index_slope = 8.5e-6;
  d.substrate = m;
  return d;
}

std::vector<BudgetEntry> entries(Detector const& d, std::vector<double> const& hz) {
  return fundamental_entries(d, hz).entries;
}

BudgetEntry const& named(std::vector<BudgetEntry> const& all, std::string const& name) {
  auto const found = std::find_if(all.begin(), all.end(), [&](BudgetEntry const& e) { return e.name == name; });
  if (found == all.end()) throw std::runtime_error("no entry " + name);
  return *found;
}

// Which entries change by more than 1e-9 at 20 Hz, in the order of their names.
std::vector<std::string> moved(Detector const& a, Detector const& b) {
  std::vector<std::string> names;
  std::vector<BudgetEntry> const before = entries(a, {20}), after = entries(b, {20});
  for (BudgetEntry const& e : before)
    if (deviation(named(after, e.name).asd[0], e.asd[0]) > 1e-9) names.push_back(e.name);
  std::sort(names.begin(), names.end());
  return names;
}

using Names = std::vector<std::string>;

TEST(KindsOfThermalNoise, EachHasItsOwnEntryR2_22) {
  Detector const d = detector();
  std::vector<BudgetEntry> const all = entries(d, {20});
  for (char const* name :
       {"SuspensionThermal", "SubstrateBrownian", "SubstrateThermoElastic", "SubstrateThermoRefractive"}) {
    EXPECT_GT(named(all, name).asd[0], 0) << name;
    EXPECT_EQ(named(all, name).kind, BudgetEntry::Kind::fundamental);
  }
  Detector other = d;
  other.substrate->loss *= 2;
  EXPECT_EQ(moved(d, other), Names{"SubstrateBrownian"});
  other = d;
  other.substrate->expansion *= 2;
  EXPECT_EQ(moved(d, other), Names{"SubstrateThermoElastic"});
  other = d;
  other.substrate->index_slope *= 2;
  EXPECT_EQ(moved(d, other), Names{"SubstrateThermoRefractive"});
  other = d;
  other.suspension->stages[0].lower.loss *= 2;
  EXPECT_EQ(moved(d, other), Names{"SuspensionThermal"});
}

TEST(KindsOfThermalNoise,
     LawsInFrequencyR2_22) {  // Brownian with a constant loss f^-1/2; thermo-elastic, adiabatic, f^-1
  std::vector<BudgetEntry> const all = entries(detector(), {20, 80});
  auto const slope = [&](std::string const& name) {
    BudgetEntry const& e = named(all, name);
    return std::log(e.asd[1] / e.asd[0]) / std::log(4);
  };
  EXPECT_NEAR(slope("SubstrateBrownian"), -0.5, 1e-5);
  EXPECT_NEAR(slope("SubstrateThermoElastic"), -1, 5e-3);
  EXPECT_NEAR(slope("SubstrateThermoRefractive"), -1, 5e-3);
}

TEST(KindsOfThermalNoise, SuspensionsHavePendulumViolinAndVerticalModesR2_22) {
  Detector const d = detector();
  SuspensionStage const& s = d.suspension->stages[0];
  double const area = pi * s.wire_radius * s.wire_radius, weight = s.mass * standard_gravity;
  double const violin = std::sqrt(weight / s.wires / (s.lower.density * area)) / (2 * s.length);
  double const bounce = std::sqrt(s.wires * area * s.lower.young / s.length / s.mass) / (2 * pi);
  std::vector<double> hz;
  for (double f = 0.3; f < 1.2 * violin; f *= 1.0005) hz.push_back(f);
  std::vector<BudgetEntry> const all = entries(d, hz);
  BudgetEntry const& thermal = named(all, "SuspensionThermal");
  ASSERT_EQ(thermal.parts.size(), 2u);
  BudgetEntry const &horizontal = named(thermal.parts, "SuspensionHorizontal"),
                    &vertical = named(thermal.parts, "SuspensionVertical");
  auto const peak = [&](BudgetEntry const& e, double from, double to) {
    std::size_t best = 0;
    for (std::size_t i = 0; i < hz.size(); ++i)
      if (hz[i] > from && hz[i] < to && (best == 0 || e.asd[i] > e.asd[best])) best = i;
    return hz[best];
  };
  EXPECT_NEAR(peak(horizontal, 0.3, 5) / (std::sqrt(standard_gravity / s.length) / (2 * pi)), 1, 0.02);  // pendulum
  EXPECT_NEAR(peak(horizontal, 0.8 * violin, 1.2 * violin) / violin, 1, 0.02);
  EXPECT_NEAR(peak(vertical, 3, 30) / bounce, 1, 0.01);
  EXPECT_LT(peak(horizontal, 3, 30), 3.1) << "control: the bounce mode does not stand in the other part";
  for (std::size_t i = 0; i < hz.size(); i += 50)  // powers of the parts sum to the entry
    EXPECT_LT(deviation(std::hypot(horizontal.asd[i], vertical.asd[i]), thermal.asd[i]), 1e-9);
}

}  // namespace
}  // namespace straytrace::testing::noise_fundamental_kinds
