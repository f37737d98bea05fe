// SPDX-License-Identifier: BSD-3-Clause
// Contributions to the total, and the report of the others.
#include "base/errors.hpp"
#include "physics/noise/support.hpp"
#include "trace/tally/coupling_table.hpp"

namespace straytrace::testing::noise_project {
namespace {

std::vector<double> const band = {10, 10.4, 20, 21};
Spectrum const weak = power_law_asd(1e-13, 10, -2, 1, 100);

CouplingClass route(std::uint64_t hash, double mean) {
  return known_class(hash, mean, {record(0, mean, {phase_sensitivity(0, 2, two_k)})});
}

NoiseBudget budget(std::vector<CouplingClass> classes) {
  CouplingTable table = known_table(std::move(classes));
  table.groups = {"baffle"};
  for (CouplingClass& c : table.classes) c.steps = {{GroupId{0}, Event::scatter}};
  return project_noise(table, moving({weak}), UnitDetector(), on(band));
}

// An unresolved route enters with the PSD observed and an equal error: variance of the PSD (2 h sigma)^2.
TEST(Project, UnresolvedRoutesAreNamedAndEnterAsHints) {
  CouplingClass rare = route(2, 5);
  rare.coupling.trusted = false;
  rare.coupling.why_not = "3 effective paths";
  CouplingClass lost = route(3, 1);
  lost.records.clear();
  CouplingClass never = route(4, 0);
  never.records.clear();
  never.coupling = {};
  NoiseBudget const b = budget({route(1, 1), rare, lost, never}), alone = budget({route(1, 1)});
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    double const one = alone.total.asd[i] * alone.total.asd[i], all = b.total.asd[i] * b.total.asd[i];
    EXPECT_NEAR(all / one, 6, 1e-9);
    EXPECT_NEAR(2 * b.total.asd[i] * b.total.sigma[i] / one, 5, 1e-9);
    EXPECT_NEAR(b.routes[1].sigma[i] / b.routes[1].asd[i], 0.5, 1e-12);
  }
  EXPECT_FALSE(b.total.resolved);
  EXPECT_TRUE(alone.total.resolved);
  ASSERT_EQ(b.unresolved.size(), 2u);
  EXPECT_NE(b.unresolved[0].find("3 effective paths"), std::string::npos);
  EXPECT_NE(b.unresolved[1].find("no path of it was kept"), std::string::npos);
  EXPECT_NEAR(b.unresolved_hint, 5, 1e-9);
  ASSERT_EQ(b.routes.size(), 4u);
  EXPECT_EQ(b.routes[1].hash, 2u);
  EXPECT_FALSE(b.routes[1].resolved);
  EXPECT_FALSE(b.routes[3].resolved);
}

// A deterministic class enters the total as it is: the error of the total is that of the sampled class alone, whose
// replicas scatter. Control: the same class as a sampled one cannot enter from a single replica.
TEST(Project, DeterministicClassesHaveNoMonteCarloError) {
  CouplingClass sampled = route(1, 1);
  for (std::size_t r = 0; r < replica_count; ++r) sampled.replica_sum[r] *= 1 + 0.1 * (double(r % 2) - 0.5);
  CouplingClass exact = deterministic_class(ClassKind::edge, {{GroupId{0}, Event::diffract}}, PortId{0}, 1,
                                            route(2, 3).records, "upper bound");
  NoiseBudget const b = budget({sampled, exact}), alone = budget({sampled}), only = budget({exact});
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    EXPECT_NEAR(b.total.asd[i], 2 * alone.total.asd[i], 1e-12 * b.total.asd[i]);
    EXPECT_NEAR(b.total.sigma[i] * b.total.asd[i], alone.total.sigma[i] * alone.total.asd[i],
                1e-9 * b.total.sigma[i] * b.total.asd[i]);
    EXPECT_GT(alone.total.sigma[i], 0);
    EXPECT_EQ(only.total.sigma[i], 0);
    EXPECT_GT(only.total.asd[i], 0);
  }
  EXPECT_TRUE(only.total.resolved);
  CouplingTable table = known_table({exact});
  table.groups = {"rim"};
  table.replica_histories = {};
  table.replica_histories[0] = table.histories = 4096;
  auto const projected = [&] { return project_noise(table, moving({weak}), UnitDetector(), on(band)); };
  EXPECT_TRUE(projected().total.resolved);
  table.classes[0].kind = ClassKind::scattered;
  EXPECT_FALSE(projected().total.resolved);
}

// A route that is resolved with one seed and not with another moves the total by less than its errors. Control: left
// out.
TEST(Project, TheTotalDoesNotJumpWithTheStatus) {
  CouplingClass sure = route(2, 8e-3), doubtful = sure;
  doubtful.coupling.trusted = false;
  doubtful.coupling.why_not = "3 effective paths";
  NoiseBudget const with = budget({route(1, 1), sure}), hint = budget({route(1, 1), doubtful}),
                    without = budget({route(1, 1)});
  EXPECT_NEAR(hint.total.asd[0], with.total.asd[0], 1e-12 * with.total.asd[0]);
  EXPECT_NEAR(hint.total.sigma[0] / hint.total.asd[0], 0.5 * 8e-3 / 1.008, 1e-6);
  EXPECT_GT(with.total.asd[0] - without.total.asd[0], 3 * without.total.sigma[0] + 3e-3 * with.total.asd[0]);
}

TEST(Project, UpperBoundsAreAShareOfTheTotal) {
  CouplingClass const edge = deterministic_class(ClassKind::edge, {{GroupId{0}, Event::diffract}}, PortId{0}, 1,
                                                 route(2, 3).records, "upper bound");
  NoiseBudget const b = budget({route(1, 1), edge}), control = budget({route(1, 1), route(2, 3)});
  EXPECT_TRUE(b.routes[1].upper_bound);
  EXPECT_NEAR(b.total.bound_share[0], 0.75, 1e-12);
  EXPECT_EQ(control.total.bound_share[0], 0);
}

// The PSD observed for an unresolved route decides whether it could matter: 1e-4 of the total cannot, 1e-2 can.
TEST(Project, FaintUnresolvedRoutesDoNotMakeALowerBound) {
  CouplingClass faint = route(2, 1e-4), strong = route(2, 1e-2);
  for (CouplingClass* c : {&faint, &strong}) {
    c->coupling.trusted = false;
    c->coupling.why_not = "3 effective paths";
  }
  NoiseBudget const b = budget({route(1, 1), faint}), control = budget({route(1, 1), strong});
  EXPECT_TRUE(b.total.resolved);
  EXPECT_TRUE(b.unresolved.empty());
  ASSERT_EQ(b.faint.size(), 1u);
  EXPECT_TRUE(b.routes[1].faint);
  EXPECT_NEAR(b.faint_share, 1e-4, 1e-8);
  EXPECT_FALSE(control.total.resolved);
  EXPECT_EQ(control.unresolved.size(), 1u);
  EXPECT_TRUE(control.faint.empty());
}

// Bright still light with three moving paths in it: its power is known, its noise is not. All moving: it is.
TEST(Project, NoiseOfAFewAmongManyIsUnresolved) {
  auto const of = [](int few) {
    CouplingClass c = route(1, 200);
    c.records.clear();
    for (int i = 0; i < 200; ++i)
      c.records.push_back(record(std::uint64_t(i) * 4096, 1, {phase_sensitivity(0, 2, i < few ? two_k : 0)}));
    return budget({c});
  };
  NoiseBudget const three = of(3);
  ASSERT_EQ(three.unresolved.size(), 1u);
  EXPECT_NE(three.unresolved[0].find("rests on about 3 of the kept paths"), std::string::npos);
  EXPECT_TRUE(of(200).unresolved.empty());
  EXPECT_TRUE(of(100).unresolved.empty());
  EXPECT_TRUE(of(0).unresolved.empty());  // nothing moves: its noise is zero
}

TEST(Project, OneReplicaGivesNoError) {
  CouplingTable table = known_table({route(1, 1)});
  table.groups = {"baffle"};
  table.classes[0].steps = {{GroupId{0}, Event::scatter}};
  table.replica_histories = {4096};
  table.histories = 4096;
  NoiseBudget const b = project_noise(table, moving({weak}), UnitDetector(), on(band));
  EXPECT_NEAR(b.routes[0].sigma[0] / b.routes[0].asd[0], 0.5, 1e-12);  // a hint, with an error as large
  EXPECT_TRUE(std::isnan(b.total.asd[0]));
  EXPECT_FALSE(b.routes[0].resolved);
  EXPECT_EQ(b.unresolved.size(), 1u);
}

TEST(Project, EqualReplicasAgreeExactly) {
  NoiseBudget const b = budget({route(1, 1), route(2, 3)});
  EXPECT_LT(b.total.sigma[0], 1e-12 * b.total.asd[0]);
  EXPECT_NEAR(b.total.mean_square_phase, two_k * two_k * weak.total(), 1e-9 * two_k * two_k * weak.total());
}

TEST(Project, ReverseAndCopiesMultiplyPower) {
  CouplingClass pair = route(1, 1);
  pair.reverse = 2;
  EXPECT_NEAR(budget({pair}).total.asd[0] / budget({route(1, 1)}).total.asd[0], std::sqrt(2), 1e-12);
}

TEST(Project, StillBodiesAreQuiet) {
  CouplingTable table = known_table({route(1, 1)});
  table.groups = {"baffle"};
  table.classes[0].steps = {{GroupId{0}, Event::scatter}};
  NoiseBudget const b = project_noise(table, MotionSet(), UnitDetector(), on(band));
  EXPECT_EQ(b.total.asd[0], 0);
  EXPECT_TRUE(b.total.resolved);
}

TEST(Project, WithoutRoutesThereIsNoNoise) {
  NoiseBudget const b = budget({});
  EXPECT_TRUE(b.routes.empty());
  EXPECT_EQ(b.total.asd.size(), band.size() - 1);
}

class BrokenDetector final : public Interferometer {
 public:
  std::complex<double> strain_per_phase(PortId, double) const override { return not_a_number; }
  std::complex<double> strain_per_amplitude(PortId, double) const override { return 0; }
  double copies(PortId) const override { return 1; }
  std::string description() const override { return {}; }
};

TEST(Project, NonFiniteValuesAreErrors) {
  CouplingTable table = known_table({route(1, 1)});
  table.groups = {"baffle"};
  table.classes[0].steps = {{GroupId{0}, Event::scatter}};
  EXPECT_THROW(project_noise(table, moving({weak}), BrokenDetector(), on(band)), NumericalError);
}

TEST(Project, MotionBeyondTheRangeIsAnError) {  // 1 m rms at 100 Hz: fringes at GHz
  CouplingTable table = known_table({route(1, 1)});
  table.groups = {"baffle"};
  table.classes[0].steps = {{GroupId{0}, Event::scatter}};
  EXPECT_THROW(project_noise(table, moving({gaussian_line(100, 1, 1)}), UnitDetector(), on(band)), NumericalError);
}

// Paths share spectra; a few are computed individually (requirement R4.08). Fringes of a slow line fall by decades
// within a bin: where each path also has a strong tone of different strength, nodes cannot follow. 600 paths are then
// computed each, without a word; of 2500, some are drawn: said, and in the error, which has nothing else here (all
// replicas are equal).
TEST(Project, DrawnPathsAreReportedAndInTheError) {
  MotionSet motion = moving({gaussian_line(0.5, 0.1, 3e-7)});
  auto const projected = [&](std::size_t count) {
    std::vector<PathRecord> records;
    for (std::uint64_t i = 0; i < count; ++i) {
      double const along = std::fmod(0.618034 * double(i), 1), across = std::fmod(0.754878 * double(i), 1);
      records.push_back(record(i * 4096, 1,
                               {phase_sensitivity(0, 2, two_k * (0.7 + 0.6 * along)),
                                phase_sensitivity(1, 2, two_k * std::pow(30, across))}));
    }
    CouplingTable table = known_table({known_class(1, 1, std::move(records))});
    table.groups = {"baffle"};
    table.classes[0].steps = {{GroupId{0}, Event::scatter}};
    table.classes[0].kind = ClassKind::edge;  // computed: no replica changes it
    return project_noise(table, motion, UnitDetector(), on({1, 1.1, 3, 3.3, 8, 9}));
  };
  EXPECT_TRUE(projected(2500).warnings.empty());  // one class of motion: shared well
  motion.bodies.push_back("shaken");
  motion.inputs.push_back({"shaken z", {}, 0.9, {{BodyId{1}, 2, 1e-7}}});
  NoiseBudget const each = projected(600), some = projected(2500);
  EXPECT_TRUE(each.warnings.empty());
  EXPECT_EQ(each.total.sigma[1], 0);
  ASSERT_EQ(some.warnings.size(), 1u);
  for (char const* part : {"2500 paths", "route 'baffle", " z'", "% of h to its error"})
    EXPECT_NE(some.warnings[0].find(part), std::string::npos) << some.warnings[0];
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(some.total.sigma[i] + some.total.sigma[1], 0);
    EXPECT_LT(some.total.sigma[i], 0.1 * some.total.asd[i]);
    EXPECT_LT(deviation(some.total.asd[i], each.total.asd[i]), 0.2);  // the same golden sequences, four times as many
  }
}

}  // namespace
}  // namespace straytrace::testing::noise_project
