// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of h and ratios of curves of the same histories, against closed forms (docs/theory/decisions.md).
#include "noise/bands/elasticity.hpp"

#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_elasticity {
namespace {

constexpr GroupId mirror{0}, steel{1};
MaterialSpread const of_steel{"steel", "", 1, 1, 1, false, {steel}}, of_mirror{"mirror", "", 1, 1, 1, false, {mirror}};

std::vector<PathStep> by_steel(int scatters) {
  std::vector<PathStep> steps{{mirror, Event::emit}};
  for (int i = 0; i < scatters; ++i) steps.push_back({steel, Event::scatter});
  steps.push_back({mirror, Event::couple});
  return steps;
}
CouplingClass route(int scatters, double mean) {
  CouplingClass c = known_class(std::uint64_t(scatters) + 1, mean, {record(0, mean, {phase_sensitivity(0, 2, two_k)})});
  c.steps = by_steel(scatters);
  return c;
}
CouplingTable table_of(std::vector<CouplingClass> classes) {
  CouplingTable table = known_table(std::move(classes));
  table.groups = {"mirror", "steel"};
  return table;
}

NoiseTrace projected(CouplingTable const& table, double motion = 1) {
  return project_noise(table, moving({power_law_asd(motion * 1e-13, 10, -2, 1, 100)}), UnitDetector(),
                       on({9.8, 10.2, 10.6}))
      .total;
}
RouteFactor count(MaterialSpread const& material) {
  return [&material](std::vector<PathStep> const& steps) { return double(scatters_on(material, steps)); };
}
RouteFactor power(MaterialSpread const& material, double ratio) {
  return
      [&material, ratio](std::vector<PathStep> const& steps) { return std::pow(ratio, scatters_on(material, steps)); };
}
double elasticity_on(MaterialSpread const& material, CouplingTable const& table) {
  return elasticity(projected(scaled_couplings(table, count(material)).table), projected(table)).value[0];
}

// Eq. D.1 with S = 0.5 + 0.3 s + 0.2 s^2: e = 1/2 (0.3 + 0.4). Mirrors scatter at both ends: e = 1.
TEST(Elasticity, CountsTheScattersOfEachRoute) {
  CouplingTable const table = table_of({route(0, 5e-21), route(1, 3e-21), route(2, 2e-21)});
  EXPECT_NEAR(elasticity_on(of_steel, table), 0.35, 1e-12);
  EXPECT_NEAR(elasticity_on(of_mirror, table), 1, 1e-12);
  double const up = projected(scaled_couplings(table, power(of_steel, 2)).table).psd(0) / projected(table).psd(0);
  EXPECT_NEAR(up, 0.5 + 0.6 + 0.8, 1e-12);
  double const black = projected(scaled_couplings(table, power(of_steel, 0)).table).psd(0) / projected(table).psd(0);
  EXPECT_NEAR(black, 0.5, 1e-12);
  EXPECT_GT(std::fabs(elasticity_on(of_steel, table_of({route(0, 5e-21), route(1, 5e-21)})) - 0.35), 0.05) << "control";
}

// A row `other` of two kept routes with 1 and 3 scatters, at 0.75 and 0.25 of its light: s = 2 gives 0.75 x 2 + 0.25
// x 8. Control: the row with unknown routes has the factor of the named one alone, and says so.
TEST(Elasticity, DividesARowByItsKeptPaths) {
  CouplingClass other = route(1, 8e-21);
  other.records = {record(0, 6e-21, {phase_sensitivity(0, 2, two_k)}),
                   record(1, 2e-21, {phase_sensitivity(0, 2, two_k)})};
  other.records[0].member = 0;
  other.records[1].member = 1;
  other.members = {{by_steel(1)}, {by_steel(3)}};
  other.folded = {{1, by_steel(1), 6e-21, 0, true, ""}};
  other.folded_routes = 2;
  other.steps.clear();
  ScaledCouplings const twice = scaled_couplings(table_of({other}), power(of_steel, 2));
  EXPECT_NEAR(twice.table.classes[0].coupling.mean / 8e-21, 3.5, 1e-12);
  EXPECT_EQ(twice.unknown[0], 0);
  other.members.clear();
  ScaledCouplings const unknown = scaled_couplings(table_of({other}), power(of_steel, 2));
  EXPECT_NEAR(unknown.table.classes[0].coupling.mean / 8e-21, 2, 1e-12);
  EXPECT_EQ(unknown.unknown[0], 1);
}

// One class with that PSD and a mean-square phase of 100, by sums of eq. 7.7; eq. D.4 gives -0.49875, -0.48, 0, 1.5, 4
// in the limit. Controls: weak motion, for which e = 1; the limit itself is off by more.
TEST(Elasticity, OfStrongMotionChangesItsSign) {
  double const hz[] = {0.5, 2, 10, 20, 30}, exact[] = {-0.50255, -0.48322, 0.00769, 1.49558, 3.83793};
  std::vector<double> edges;
  for (double const f : hz) edges.insert(edges.end(), {f * 0.9995, f * 1.0005});
  auto const at = [&](double rms_phase) {
    return central_elasticity([&](double factor) {
      MotionSet const motion = moving({around_zero(factor * rms_phase / two_k)});
      return project_noise(table_of({route(1, 1e-20)}), motion, UnitDetector(), on(edges)).total;
    });
  };
  BinValues const strong = at(10), weak = at(1e-3);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(strong.value[2 * i], exact[i], 2e-3) << hz[i];
  EXPECT_NEAR(weak.value[2], 1, 1e-4) << "control";
  EXPECT_GT(std::fabs(4 - strong.value[8]), 0.1) << "control";
}

// Two routes whose couplings differ by replica. What multiplies both has no error (eq. D.2); one of them alone has that
// of its share, here by the textbook formula. Control: the error of independent runs.
TEST(Elasticity, RatiosOfTheSameHistoriesHaveTheErrorOfTheirDifference) {
  CouplingTable table = table_of({route(1, 5e-21), route(2, 5e-21)});
  for (std::size_t r = 0; r < replica_count; ++r) {
    table.classes[0].replica_sum[r] *= 1 + 0.1 * std::cos(double(r));
    table.classes[1].replica_sum[r] *= 1 + 0.1 * std::sin(double(r));
  }
  NoiseTrace const one = projected(table), moved = projected(table, 1.3);
  BinValues const motion = log_ratio(moved, one, true), apart = log_ratio(moved, one, false);
  EXPECT_NEAR(motion.value[0], std::log(1.3), 1e-9);
  EXPECT_LT(motion.sigma[0], 1e-9);
  EXPECT_GT(apart.sigma[0], 5e-3) << "control";
  BinValues const e = elasticity(projected(scaled_couplings(table, count(of_steel)).table), one);
  double sum = 0;  // e = 1/2 (a + 2 b)/(a + b), a = b: de = 1/8 (db/b - da/a), of means over 32 replicas
  for (std::size_t r = 0; r < replica_count; ++r)
    sum += std::pow(0.1 * (std::sin(double(r)) - std::cos(double(r))) / 8, 2);
  EXPECT_NEAR(e.value[0], 0.75, 1e-3);
  EXPECT_NEAR(e.sigma[0], std::sqrt(sum / 32 / 31), 0.05 * e.sigma[0]);
}

}  // namespace
}  // namespace straytrace::testing::noise_elasticity
