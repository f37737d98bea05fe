// SPDX-License-Identifier: BSD-3-Clause
// Coherent families in the projection: paths of one class whose relative static phases are known
// (docs/theory/ghosts.md, eq. 10.5), as spectra, as one realisation in time, and in the band of realisations. Control
// everywhere: their powers added.
#include "noise/bands/speckle_band.hpp"
#include "physics/noise/time_domain/time_support.hpp"

namespace straytrace::testing::noise_family {
namespace {

struct Member {
  std::complex<double> field;
  std::vector<PhaseSensitivity> phase_sensitivities;
};

CouplingClass family(std::vector<Member> const& members, bool known_phases = true) {
  CouplingClass c = known_class(1, 0, {});
  c.kind = ClassKind::ghost;
  for (Member const& m : members) {
    c.records.push_back(record(0, std::norm(m.field), m.phase_sensitivities));
    if (known_phases) c.records.back().field = {m.field, 0};
    c.coupling.mean += std::norm(m.field);
  }
  return c;
}

NoiseTrace total(CouplingClass const& c, MotionSet const& motion, std::vector<double> edges) {
  return project_noise(known_table({c}), motion, UnitDetector(), on(std::move(edges))).total;
}

double bessel(int n, double z) { return std::cyl_bessel_j(n, std::fabs(z)) * (z < 0 && n % 2 ? -1 : 1); }

// Line n of a tone is (|sum_j E_j J_n(z_j)|^2 + |sum_j E_j J_-n(z_j)|^2)/2 (eq. 7.3, 7.4 with fields added first).
TEST(Family, LinesOfTwoPathsInAndOutOfPhase) {
  double const z = 2.3;
  MotionSet m;
  m.bodies = {"body"};
  m.inputs = {tone(1, 1)};
  std::vector<double> edges;
  for (int n = 1; n <= 5; ++n) edges.insert(edges.end(), {n - 0.3, n + 0.3});
  for (double const second : {1.0, 0.4})  // of the phase sensitivity of the first
    for (double const phase : {0.0, pi, 1.1}) {
      std::vector<Member> const members = {{0.8, {phase_sensitivity(0, 2, z)}},
                                           {std::polar(0.7, phase), {phase_sensitivity(0, 2, second * z)}}};
      NoiseTrace const t = total(family(members), m, edges), powers = total(family(members, false), m, edges);
      for (int n = 1; n <= 5; ++n) {
        std::complex<double> plus = 0, minus = 0;
        for (Member const& one : members) {
          double const j = bessel(n, one.phase_sensitivities[0].d[2]);
          plus += one.field * j;
          minus += one.field * j * (n % 2 ? -1.0 : 1.0);
        }
        double const expected = (std::norm(plus) + std::norm(minus)) / 2, width = 0.6;
        std::size_t const bin = 2 * std::size_t(n) - 2;
        EXPECT_NEAR(std::pow(t.asd[bin], 2) * width, expected, 1e-9) << second << ' ' << phase << " line " << n;
        EXPECT_EQ(t.sigma[bin], 0);
        if (n == 1) {
          EXPECT_GT(deviation(std::pow(powers.asd[bin], 2) * width, expected), 0.05) << "control: powers added";
        }
      }
    }
}

// Weak motion: S = |sum_j E_j J_j|^2 S_x/2 (eq. 7.9). Equal phase sensitivities out of phase are still; unequal ones
// are not.
TEST(Family, WeakMotionSeesTheSumOfFieldsTimesPhaseSensitivities) {
  Spectrum const line = gaussian_line(30, 3, 1e-11);
  MotionSet const m = moving({line});
  std::vector<double> const edges = {27, 33};
  double const unit = two_k * two_k * line.power(27, 33) / 6 / 2;
  for (double const second : {1.0, 0.5, -0.25})
    for (double const phase : {0.0, pi}) {
      std::vector<Member> const members = {{1.0, {phase_sensitivity(0, 2, two_k)}},
                                           {std::polar(1.0, phase), {phase_sensitivity(0, 2, second * two_k)}}};
      double const expected = std::norm(1.0 + std::polar(1.0, phase) * second);
      NoiseTrace const t = total(family(members), m, edges);
      EXPECT_NEAR(std::pow(t.asd[0], 2) / unit, expected, 1e-4) << second << ' ' << phase;
      if (expected > 0.1) {
        EXPECT_NEAR(t.linear_share[0], 1, 1e-4);
      }
      double const powers = std::pow(total(family(members, false), m, edges).asd[0], 2) / unit;
      EXPECT_GT(std::fabs(powers - expected), 0.4) << "control: powers added";
    }
}

// Slow strong motion of one body, common to both paths, under weak motion at 30 Hz of their difference: the fast part
// is first order on fields that slow motion has turned apart.
TEST(Family, SlowMotionThatIsSharedLeavesTheCrossTerm) {
  Spectrum const slow = gaussian_line(0.3, 0.05, 1e-6), fast = gaussian_line(60, 2, 1e-11);
  MotionSet m = moving({slow, fast});
  std::vector<double> const edges = {40, 80};
  std::vector<Member> const shared = {{1.0, {phase_sensitivity(0, 2, two_k), phase_sensitivity(1, 2, two_k)}},
                                      {1.0, {phase_sensitivity(0, 2, two_k)}}},
                            apart = {{1.0, {phase_sensitivity(0, 2, two_k), phase_sensitivity(1, 2, two_k)}},
                                     {1.0, {phase_sensitivity(1, 2, two_k)}}};
  double const unit = two_k * two_k * fast.total() / 2 / 40;  // of one path
  auto const psd = [&](std::vector<Member> const& members, bool known) {
    return std::pow(total(family(members, known), m, edges).asd[0], 2) / unit;
  };
  EXPECT_NEAR(psd(shared, true), 1, 0.02);  // the second path does not see the fast motion
  EXPECT_NEAR(psd(apart, true), 2, 0.02);   // both do, but strong slow motion of one of them mixes their phases
  EXPECT_NEAR(psd(apart, false), 2, 0.02);
}

// A drift that both share makes one line of |E_1 + E_2|^2/2; drifts that differ keep the powers.
TEST(Family, DriftsTogetherOrApart) {
  MotionSet m = moving({});
  m.bodies = {"a", "b"};
  MotionInput drift;
  drift.name = "drift";
  drift.drift = true;
  drift.gains = {{BodyId{0}, 2, 20 * wavelength / 2}};  // 20 fringes per second for one bounce
  m.inputs = {drift};
  std::vector<double> const edges = {9.9, 10.1, 19.9, 20.1};
  std::vector<Member> const together = {{1.0, {phase_sensitivity(0, 2, two_k)}},
                                        {0.5, {phase_sensitivity(0, 2, two_k)}}},
                            apart = {{1.0, {phase_sensitivity(0, 2, two_k)}},
                                     {0.5, {phase_sensitivity(0, 2, two_k / 2)}}};
  NoiseTrace const one = total(family(together), m, edges), two = total(family(apart), m, edges);
  EXPECT_NEAR(std::pow(one.asd[2], 2) * 0.2, 1.5 * 1.5 / 2, 1e-9);
  EXPECT_NEAR(std::pow(one.asd[0], 2) * 0.2, 0, 1e-9);
  EXPECT_NEAR(std::pow(two.asd[2], 2) * 0.2, 0.5, 1e-9);
  EXPECT_NEAR(std::pow(two.asd[0], 2) * 0.2, 0.125, 1e-9);
  EXPECT_NEAR(std::pow(total(family(together, false), m, edges).asd[2], 2) * 0.2, 0.625, 1e-9);  // negative control
}

// h(t) of one family, its relative phases kept from draw to draw, against its spectrum. Control: phases of their own.
TEST(Family, OneRealisationInTimeKeepsRelativePhases) {
  TwoQuadratures const ifo;
  MotionSet m = moving({gaussian_line(3, 0.6, 9e-8), gaussian_line(5, 0.5, 6e-8)});
  m.inputs[0].gains.push_back({BodyId{1}, 2, 0.6});
  std::vector<Member> const members = {
      {1.0, {phase_sensitivity(0, 2, two_k)}},
      {std::polar(0.9, 0.4), {phase_sensitivity(1, 2, two_k)}},
      {std::polar(0.5, -2.5), {phase_sensitivity(0, 2, two_k), phase_sensitivity(1, 2, -two_k)}}};
  Simulation s{known_table({family(members)}), m, &ifo, {}, 16, 256, 4, 500};
  for (double const f : {2.125, 4.125, 6.125, 9.125, 12.125}) s.edges.push_back(f);
  Comparison const fields = compared(s);
  expect_agreement(fields, 0.25);
  s.table = known_table({family(members, false)});
  Comparison const powers = compared(s);
  expect_agreement(powers, 0.25);  // phases of their own: the sum of powers
  double statistic = 0;
  for (std::size_t b = 0; b < powers.mean.size(); ++b)
    statistic += std::pow((powers.mean[b] - fields.exact[b]) / powers.error[b], 2);
  EXPECT_LT(chi_square_tail(statistic, double(powers.mean.size())), 1e-6);  // negative control
}

// Without fields the paths of a computed route have phases of their own in every realisation.
TEST(Family, UnknownPhasesAreDrawnSeparately) {
  CouplingTable const table =
      known_table({family({{1.0, {phase_sensitivity(0, 2, two_k)}}, {1.0, {phase_sensitivity(0, 2, two_k)}}}, false)});
  std::complex<double> mean = 0;
  for (std::uint32_t r = 0; r < 400; ++r) {
    std::vector<StrayPath> const p = stray_paths(table, UnitDetector(), {{0}, 0, 7, r});
    ASSERT_EQ(p.size(), 2u);
    mean += std::polar(1.0 / 400, 2 * pi * (p[0].turns - p[1].turns));
  }
  EXPECT_LT(std::abs(mean), 5 / std::sqrt(400.0));
}

// One input: the family is one phasor, as a single path of its summed field (docs/theory/spectra.md).
TEST(Family, SpreadOfRealisationsIsThatOfOnePhasor) {
  MotionSet const m = moving({gaussian_line(30, 3, 1e-11)});
  auto const bands = [&](CouplingClass const& c) {
    CouplingTable const table = known_table({c});
    NoiseBudget b = project_noise(table, m, UnitDetector(), on({27, 33}));
    add_speckle_band(b, table, m, UnitDetector());
    return b.bands;
  };
  std::vector<Member> const members = {{1.0, {phase_sensitivity(0, 2, two_k)}},
                                       {std::polar(0.8, 2.2), {phase_sensitivity(0, 2, 0.5 * two_k)}}};
  std::complex<double> const sum = 1.0 + 0.5 * std::polar(0.8, 2.2);
  NoiseBands const fields = bands(family(members)),
                   one = bands(family({{sum, {phase_sensitivity(0, 2, two_k)}}}, false)),
                   powers = bands(family(members, false));
  EXPECT_LT(deviation(fields.speckle_50[0], one.speckle_50[0]), 0.02);
  EXPECT_LT(deviation(fields.speckle_95[0], one.speckle_95[0]), 0.02);
  EXPECT_GT(deviation(powers.speckle_95[0], one.speckle_95[0]), 0.3) << "control: phases of their own";
}

}  // namespace
}  // namespace straytrace::testing::noise_family
