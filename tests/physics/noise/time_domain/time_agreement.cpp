// SPDX-License-Identifier: BSD-3-Clause
// h(t) drawn at random has the spectra of the closed formulas (docs/theory/spectra.md, eq. 1.10
// to 1.13, 7.7, 7.11, 7.12; R4.11).
#include "physics/noise/time_domain/time_support.hpp"

namespace straytrace::testing {
namespace {

std::vector<double> spaced(double from, double to, double step, double spacing) {
  std::vector<double> edges;
  for (double f = from; f <= to; f += step) edges.push_back(f + spacing / 2);
  return edges;
}

// `n` paths with phase sensitivities of a spread of +- 20 % on body 0.
CouplingTable several_paths(int n, double power = 1) {
  std::vector<PathRecord> records;
  for (int j = 0; j < n; ++j)
    records.push_back(record(std::uint64_t(j), power / n, {phase_sensitivity(0, 2, two_k * (0.8 + 0.4 * j / n))}));
  return known_table({known_class(1, power, records)});
}

TEST(TimeDomainAgreement, LinearCoupling) {
  UnitDetector const ifo;
  Simulation s{several_paths(6), moving({power_law_asd(1e-10, 10, -2, 2, 200)}), &ifo, spaced(5, 60, 5, 0.25)};
  s.duration = 8;
  s.realisations = 200;
  expect_agreement(compared(s), 0.6);
  EXPECT_LT(compared(s, without_static_phases).p, 1e-12);  // control: six paths in phase
}

TEST(TimeDomainAgreement, WrappedFringes) {  // A5: 5 % up to 10 Hz
  UnitDetector const ifo;
  Simulation s{several_paths(1), moving({gaussian_line(0.2, 0.05, 2e-6)}), &ifo, spaced(0.5, 16.5, 1, 0.25)};
  s.table.classes[0].records[0].phase_sensitivities = {phase_sensitivity(0, 2, two_k)};
  s.duration = 80;
  s.rate = 128;
  s.realisations = 800;
  Comparison const c = compared(s);
  EXPECT_GT(c.p, 1e-6);
  for (std::size_t b = 0; b < c.exact.size(); ++b) {
    std::string const centre = std::to_string(int(b) + 1) + " Hz";
    if (b < 10) {
      EXPECT_LT(std::fabs(c.mean[b] / c.exact[b] - 1), 0.05) << centre;
      EXPECT_LT(c.error[b], 0.03 * c.exact[b]) << centre;
    }
    EXPECT_LT(std::fabs(c.mean[b] - c.exact[b]), 5 * c.error[b]) << centre;
    record_mean(centre.c_str(), c.mean[b], c.error[b], c.exact[b]);
  }
  s.realisations = 100;
  EXPECT_LT(compared(s, linear).p, 1e-12);  // negative control
}

TEST(TimeDomainAgreement, TonesOnGaussianMotion) {  // eq. 7.11
  UnitDetector const ifo;
  Simulation s{several_paths(4), moving({gaussian_line(1, 0.2, 3e-8)}), &ifo, spaced(1.5, 16.5, 3, 0.25)};
  s.motion.inputs.push_back(tone(3, 2e-7));
  s.duration = 20;
  s.rate = 256;
  Comparison const c = compared(s);
  expect_agreement(c, 0.8);
  EXPECT_LT(compared(s, linear).p, 1e-12);                // control: no overtones
  EXPECT_LT(compared(s, without_static_phases).p, 1e-6);  // control: wrong odd and even lines
}

TEST(TimeDomainAgreement, TwoBodiesOnOneGround) {  // eq. 1.10, 7.12
  UnitDetector const ifo;
  Spectrum const ground = gaussian_line(2, 0.5, 1.2e-7);
  Simulation s{several_paths(1), moving({gaussian_line(4, 0.5, 2e-8), gaussian_line(6, 0.5, 2e-8)}), &ifo,
               spaced(0.5, 12.5, 1, 0.25)};
  s.motion.inputs.push_back({"ground z", ground, 0, {{BodyId{0}, 2, 1}, {BodyId{1}, 2, 0.6}}});
  for (double share : {-1.0, -0.9, -0.7, 0.8})
    s.table.classes[0].records.push_back(
        record(std::uint64_t(110 + 100 * share), 0.25,
               {phase_sensitivity(0, 2, two_k), phase_sensitivity(1, 2, share * two_k)}));
  s.table.classes[0].records.erase(s.table.classes[0].records.begin());
  s.duration = 20;
  s.rate = 256;
  s.realisations = 200;
  Comparison const c = compared(s);
  expect_agreement(c, 0.8);
  Simulation control = s;  // the bodies move independently
  control.motion.inputs.pop_back();
  control.motion.inputs.push_back({"ground z 0", ground, 0, {{BodyId{0}, 2, 1}}});
  control.motion.inputs.push_back({"ground z 1", ground.scaled(0.36), 0, {{BodyId{1}, 2, 1}}});
  double statistic = 0;
  Comparison const wrong = compared(control);
  for (std::size_t b = 0; b < c.exact.size(); ++b)
    statistic += std::pow((wrong.mean[b] - c.exact[b]) / wrong.error[b], 2);
  EXPECT_LT(chi_square_tail(statistic, double(c.exact.size())), 1e-12);  // negative control
}

TEST(TimeDomainAgreement, BothQuadraturesTwoCopiesAndReversePaths) {  // eq. 1.5, 1.13, R4.11
  TwoQuadratures const ifo;
  Simulation s{several_paths(5, 1e-20), moving({gaussian_line(2, 0.4, 1e-7)}), &ifo, spaced(0.5, 12.5, 1, 0.25)};
  s.table.classes[0].reverse = 2;
  s.duration = 20;
  s.rate = 256;
  s.realisations = 200;
  Comparison const c = compared(s);
  expect_agreement(c, 0.8);
  s.table.classes[0].reverse = 1;  // control: without the factor 2 of reverse paths
  double statistic = 0;
  Comparison const wrong = compared(s);
  for (std::size_t b = 0; b < c.exact.size(); ++b)
    statistic += std::pow((wrong.mean[b] - c.exact[b]) / wrong.error[b], 2);
  EXPECT_LT(chi_square_tail(statistic, double(c.exact.size())), 1e-12);  // negative control
}

}  // namespace
}  // namespace straytrace::testing
