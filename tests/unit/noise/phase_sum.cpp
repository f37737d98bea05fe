// SPDX-License-Identifier: BSD-3-Clause
// The sum over fields, its tables, and the choice of paths (R4.05, R4.09, docs/theory/ghosts.md, eq. 10.5).
#include <numeric>

#include "base/math/rng.hpp"
#include "physics/noise/time_domain/time_support.hpp"

namespace straytrace::testing {
namespace {

struct Many {
  std::vector<std::vector<double>> x;
  PhaseTerms terms;
  Many(std::size_t paths, std::size_t coordinates, std::size_t samples) {
    Rng rng(3, 0, 0, Stream::source);
    x.resize(coordinates);
    for (std::size_t c = 0; c < coordinates; ++c)
      for (std::size_t i = 0; i < samples; ++i)
        x[c].push_back(1e-5 * std::sin(6.28 * double(3 + c) * double(i) / double(samples) + double(c)));
    terms.coordinate.assign(x.begin(), x.end());
    for (std::size_t j = 0; j < paths; ++j) {
      terms.amplitude.push_back(rng.uniform());
      terms.turns.push_back(rng.uniform());
      for (std::size_t c = 0; c < coordinates; ++c) terms.phase_sensitivity.push_back(1.88e6 * (2 * rng.uniform() - 1));
    }
  }
};

std::complex<double> with_long_doubles(PhaseTerms const& t, std::size_t i) {
  std::complex<long double> sum = 0;
  for (std::size_t j = 0; j < t.paths(); ++j) {
    long double turns = t.turns[j];
    for (std::size_t c = 0; c < t.coordinate.size(); ++c)
      turns += static_cast<long double>(t.phase_sensitivity[j * t.coordinate.size() + c]) * t.coordinate[c][i];
    sum += std::polar<long double>(t.amplitude[j], 2 * std::acos(-1.0L) * turns);
  }
  return std::complex<double>(sum);
}

TEST(PhaseSum, IsExact) {
  for (std::size_t coordinates : {1u, 3u}) {
    Many const m(200, coordinates, 3000);
    std::vector<std::complex<double>> const direct = direct_phase_sum(m.terms), quick = phase_sum(m.terms);
    for (std::size_t i = 0; i < 3000; i += 101) {
      std::complex<double> const truth = with_long_doubles(m.terms, i);
      EXPECT_LT(std::abs(direct[i] - truth), 1e-12);
      EXPECT_LT(std::abs(quick[i] - truth), 2e-11 * 200);  // a table, with one coordinate
    }
  }
}

// The lowest sample lies on a node of the table, above or below it by rounding. A place below reads what lies in
// front of the table: the previous block of the heap, here full of huge numbers.
TEST(PhaseSum, TheLowestSampleIsAsGoodAsTheOthers) {
  for (int k = 0; k < 200; ++k) {
    Many m(60, 1, 600);
    std::vector<std::vector<double>> huge;
    for (std::size_t n = 1; n < 200; ++n) huge.emplace_back(n, 1e300);
    huge.clear();
    m.x[0].clear();
    for (std::size_t i = 0; i < m.terms.coordinate[0].size(); ++i)
      m.x[0].push_back(1e-9 * (1 + 0.37 * k) * std::sin(0.013 * double(i) + 0.1 * k));
    m.terms.coordinate = {m.x[0]};
    std::vector<std::complex<double>> const direct = direct_phase_sum(m.terms), quick = phase_sum(m.terms);
    for (std::size_t i = 0; i < direct.size(); ++i)
      ASSERT_LT(std::abs(direct[i] - quick[i]), 2e-11 * 60) << k << " " << i;
  }
}

TEST(PhaseSum, ThreadsDoNotChangeABit) {
  Many const m(50, 2, 5000);
  EXPECT_EQ(phase_sum(m.terms, 1), phase_sum(m.terms, 3));
}

CouplingTable uneven() {
  std::vector<PathRecord> records;
  for (std::uint64_t j = 0; j < 300; ++j)
    records.push_back(record(j, double(j % 17) / 2400, {phase_sensitivity(0, 2, two_k)}));
  return known_table({known_class(9, 1e-20, records)});
}
double total_power(std::vector<StrayPath> const& paths) {
  return std::accumulate(paths.begin(), paths.end(), 0.0,
                         [](double s, StrayPath const& p) { return s + p.amplitude * p.amplitude; });
}

TEST(StrayPaths, RepresentativesKeepTheMeanPower) {
  UnitDetector const ifo;
  for (std::size_t n : {0u, 1u, 7u, 64u, 299u, 5000u}) {
    std::vector<StrayPath> const paths = stray_paths(uneven(), ifo, {{0}, n, 4, 0});
    EXPECT_LT(deviation(total_power(paths), 1e-20), 1e-12) << n;
    EXPECT_EQ(paths.size(), n > 0 && n < 300 ? n : 300 - 18);  // 18 have no weight
  }
  // Each record occurs in proportion to its weight.
  std::vector<double> seen(300);
  for (std::uint32_t r = 0; r < 2000; ++r)
    for (StrayPath const& p : stray_paths(uneven(), ifo, {{0}, 16, 4, r})) seen[p.record] += 1.0 / 16 / 2000;
  double const weight = 300 * 8.0;  // about: the mean of j % 17 is 8
  EXPECT_NEAR(seen[16], 16 / weight, 0.001);
  EXPECT_NEAR(seen[1], 1 / weight, 0.0003);
  EXPECT_EQ(seen[17], 0);
}

TEST(StrayPaths, StaticPhasesAreUniformAndRepeatable) {  // docs/theory/path_integral.md
  UnitDetector const ifo;
  std::vector<StrayPath> const a = stray_paths(uneven(), ifo, {{0}, 0, 4, 0}),
                               again = stray_paths(uneven(), ifo, {{0}, 0, 4, 0}),
                               other = stray_paths(uneven(), ifo, {{0}, 0, 4, 1});
  std::complex<double> mean = 0, across = 0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    EXPECT_EQ(a[j].turns, again[j].turns);
    mean += std::polar(1 / double(a.size()), 2 * pi * a[j].turns);
    across += std::polar(1 / double(a.size()), 2 * pi * (a[j].turns - other[j].turns));
  }
  EXPECT_LT(std::abs(mean), 5 / std::sqrt(double(a.size())));
  EXPECT_LT(std::abs(across), 5 / std::sqrt(double(a.size())));
}

std::vector<std::complex<double>> field_of(CouplingTable const& table, MotionSeries const& m) {
  return stray_fields(stray_paths(table, UnitDetector(), {{0}, 0, 1, 0}), m).at(0).field;
}

// Two ghosts half a wavelength apart in length cancel, whatever their common phase; powers would add to 2.
TEST(StrayPaths, GhostsInterfereByTheirFields) {  // eq. 10.5
  CouplingClass ghosts = known_class(
      3, 2, {record(0, 1, {phase_sensitivity(0, 2, two_k)}), record(0, 1, {phase_sensitivity(0, 2, two_k)})});
  ghosts.kind = ClassKind::ghost;
  ghosts.records[0].field = {1, 0};
  ghosts.records[1].field = {-1, 0};
  CouplingTable const table = known_table({ghosts});
  MotionSeries const m = draw_motion(moving({gaussian_line(1, 0.2, 1e-7)}), {0, 64, 640}, 1);
  for (std::complex<double> const s : field_of(table, m)) EXPECT_LT(std::abs(s), 1e-9);
  ghosts.records[1].field = {1, 0};
  EXPECT_NEAR(std::norm(field_of(known_table({ghosts}), m)[17]), 4, 1e-8);
}

TEST(StrayFields, PowerOfBothQuadraturesIsConstant) {  // R4.11
  CouplingTable const one = known_table({known_class(1, 4e-20, {record(0, 1, {phase_sensitivity(0, 2, two_k)})})});
  MotionSeries const m = draw_motion(moving({gaussian_line(1, 0.2, 1e-6)}), {0, 64, 640}, 1);
  for (std::complex<double> const s : field_of(one, m)) EXPECT_NEAR(std::norm(s), 4e-20, 1e-30);
}

TEST(Strain, ResponsesDelayAndKeepTheirQuadratures) {  // eq. 1.13, convention exp(-2 pi i f t)
  TwoQuadratures const ifo;
  double const rate = 1024, hz = 30;
  PortField f{PortId{0}, std::vector<std::complex<double>>(4096)};
  auto const part = [&](bool imaginary) {
    for (std::size_t i = 0; i < 4096; ++i) {
      double const y = std::cos(2 * pi * hz * double(i) / rate);
      f.field[i] = imaginary ? std::complex(0.0, y) : std::complex(y, 0.0);
    }
    std::vector<PortField> const fields = {f};
    std::vector<double> const h = strain(fields, ifo, rate, 1, 0);
    std::complex<double> sum = 0;
    for (std::size_t i = 1024; i < 3072; ++i) sum += h[i] * std::polar(2 / 2048.0, -2 * pi * hz * double(i) / rate);
    return sum;  // of exp(+2 pi i f t): the conjugate of the response
  };
  EXPECT_LT(std::abs(part(true) - std::conj(ifo.strain_per_phase(PortId{0}, hz))), 1e-3);
  EXPECT_LT(std::arg(part(true)), -0.7);  // behind, not ahead: the pole is at 30 Hz
  EXPECT_LT(std::abs(part(false) - std::conj(ifo.strain_per_amplitude(PortId{0}, hz))), 1e-4);
}

}  // namespace
}  // namespace straytrace::testing
