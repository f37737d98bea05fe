// SPDX-License-Identifier: BSD-3-Clause
// Paths that no nodes of strength can follow: they are computed individually, or so many of them are drawn (R4.08).
#include "base/errors.hpp"
#include "base/math/rng.hpp"
#include "noise/interpolate/spectrum_interpolator.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_shared_spectra {
namespace {

FrequencyGrid const grid = logarithmic_grid(3, 100, 20);

struct Hard {
  std::string name;
  std::vector<MotionClass> classes;
  std::vector<double> strength, spread;  // of kappa, log-normal; a negative strength is a negative kappa
  double old_error;                      // what interpolation alone is off by, at least
  bool scatter;                          // whether draws are repeated: cheap ones
};

MotionClass drifting() {
  MotionClass d;
  d.drift = true;
  return d;
}

// Slow motion: its fringes fall by decades within a few bins. The negative class is of a shape between the others, so
// that the sum of all stays positive.
std::vector<Hard> hard_cases() {
  double const unit = two_k * two_k;
  MotionClass const slow{gaussian_line(0.3, 0.06, 1.2e-6), 0, {}}, fast{gaussian_line(0.6, 0.12, 5e-7), 0, {}},
      tone{{}, 0.9, {}}, steep{power_law_asd(2e-7, 1, -2, 0.5, 30), 0, {}},
      flat{power_law_asd(2e-7, 1, -1, 0.5, 30), 0, {}}, between{power_law_asd(2e-7, 1, -1.5, 0.5, 30), 0, {}};
  return {{"line and a tone", {slow, tone}, {unit, 9}, {0.6, 1.5}, 0.1, true},
          {"two and a tone", {slow, fast, tone}, {unit, unit, 9}, {0.6, 1.2, 1.5}, 0.1, false},
          {"negative", {steep, flat, between}, {unit, unit, -0.8 * unit}, {0.15, 0.15, 0.2}, 2e-3, false},
          {"drift", {slow, drifting()}, {unit, std::pow(2 * pi * 10, 2)}, {0.6, 0.4}, 0.02, true}};
}

// Weights are log-normal too. `turn`: the same paths in another order, from which other ones are drawn.
Strengths paths_of(Hard const& hard, std::size_t count, std::size_t turn = 0) {
  Strengths s{hard.classes.size(), {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(13, (i + turn) % count, 0, Stream::source);
    auto const normal = [&] { return std::sqrt(-2 * std::log(rng.uniform())) * std::cos(2 * pi * rng.uniform()); };
    for (std::size_t c = 0; c < s.classes; ++c)
      s.kappa.push_back(hard.strength[c] * std::exp(hard.spread[c] * normal()));
    s.weight.push_back(std::exp(0.5 * normal()));
  }
  return s;
}

std::vector<double> direct_sum(PhaseSpectra const& spectra, Strengths const& paths) {
  std::vector<double> sum(grid.size());
  for (std::size_t p = 0; p < paths.size(); ++p) {
    std::vector<double> const one = spectra(paths.of(p)).psd;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += paths.weight[p] * one[i];
  }
  return sum;
}

struct Sum {
  std::vector<double> psd, variance;
  bool sampled;
  std::size_t drawn;
};

Sum shared_sum(PhaseSpectra const& spectra, Strengths const& paths, SpectrumInterpolator::Options const& options) {
  SpectrumInterpolator const nodes(spectra, paths, options);
  std::vector<double> weight(nodes.basis().size());
  std::vector<SpectrumInterpolator::Share> shares;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    nodes.shares(p, shares);
    for (SpectrumInterpolator::Share const& s : shares) weight[s.basis] += s.weight * paths.weight[p];
  }
  Sum sum{std::vector<double>(grid.size()), std::vector<double>(grid.size()), nodes.sampled(), nodes.drawn()};
  for (std::size_t b = 0; b < weight.size(); ++b)
    for (std::size_t i = 0; i < grid.size(); ++i) sum.psd[i] += weight[b] * nodes.basis()[b].psd[i];
  nodes.add_variance(weight, sum.variance);
  return sum;
}

// Bins within twelve decades of the highest.
std::vector<std::size_t> counted(std::vector<double> const& psd) {
  std::vector<std::size_t> bins;
  for (std::size_t i = 0; i < psd.size(); ++i)
    if (psd[i] > 1e-12 * *std::max_element(psd.begin(), psd.end())) bins.push_back(i);
  return bins;
}

double worst(std::vector<double> const& psd, std::vector<double> const& expected) {
  double error = 0;
  for (std::size_t const i : counted(expected)) error = std::max<double>(error, deviation(psd[i], expected[i]));
  return error;
}

constexpr SpectrumInterpolator::Options computed{0.25, 100, true, 24, 2000}, interpolated{0.25, 100, true, 24, 0},
    drawn{0.25, 100, true, 24, 100};

// R4.08: within 1e-3 of the sum over paths, over 12 decades.
TEST(SharedSpectra, PathsThatNodesCannotFollowAreComputed) {
  for (Hard const& hard : hard_cases()) {
    PhaseSpectra const spectra(hard.classes, grid);
    Strengths const paths = paths_of(hard, 500);
    std::vector<double> const expected = direct_sum(spectra, paths);
    Sum const all = shared_sum(spectra, paths, computed);
    EXPECT_FALSE(all.sampled) << hard.name;
    EXPECT_LT(worst(all.psd, expected), 1e-3) << hard.name;
    EXPECT_GT(worst(shared_sum(spectra, paths, interpolated).psd, expected), hard.old_error)
        << hard.name << ": control";
  }
}

// Of many paths few are drawn. Their sum is without bias and its stated variance that of its scatter: over draws from 8
// orders of the same paths, the mean lies within five of its errors, and squares of deviations have the mean of the
// variances within a factor of 2.5 in the geometric mean over the bins. A wrong factor of 2 in the error of h^2 is 4.
TEST(SharedSpectra, DrawnPathsStateTheirError) {
  constexpr std::size_t orders = 8, count = 300;
  for (Hard const& hard : hard_cases()) {
    if (!hard.scatter) continue;
    PhaseSpectra const spectra(hard.classes, grid);
    std::vector<double> const expected = direct_sum(spectra, paths_of(hard, count));
    std::vector<double> mean(grid.size()), square(mean), variance(mean);
    for (std::size_t turn = 0; turn < orders; ++turn) {
      Sum const sum = shared_sum(spectra, paths_of(hard, count, 37 * turn), drawn);
      ASSERT_TRUE(sum.sampled) << hard.name;
      EXPECT_LE(sum.drawn, 101u);
      for (std::size_t i = 0; i < grid.size(); ++i) {
        double const off = sum.psd[i] - expected[i];
        mean[i] += off / orders;
        square[i] += off * off;
        variance[i] += sum.variance[i];
      }
    }
    double logarithms = 0, bins = 0;
    for (std::size_t const i : counted(expected)) {
      if (!(variance[i] > 1e-14 * expected[i] * expected[i])) continue;
      EXPECT_LT(std::fabs(mean[i]), 5 * std::sqrt(variance[i]) / orders) << hard.name << " bin " << i;
      logarithms += std::log(square[i] / variance[i]);
      ++bins;
    }
    ASSERT_GT(bins, 10) << hard.name;
    EXPECT_LT(std::fabs(logarithms / bins), std::log(2.5)) << hard.name << ": " << std::exp(logarithms / bins);
  }
}

// Few nodes for strengths that differ by decades lie far apart, some beyond reach of any transform, though no path is:
// the required spectra are computed; only without them the paths are rejected.
TEST(SharedSpectra, PathsBeyondTheNodesAreNotLost) {
  Hard const hard = hard_cases()[1];
  PhaseSpectra const spectra(hard.classes, grid);
  constexpr SpectrumInterpolator::Options few{0.25, 20, true, 24, 0}, some{0.25, 20, true, 24, 150};
  Strengths const paths = paths_of(hard, 300);
  std::vector<double> const expected = direct_sum(spectra, paths);
  EXPECT_THROW(shared_sum(spectra, paths, few), NumericalError);
  Sum const sum = shared_sum(spectra, paths, some);
  EXPECT_TRUE(sum.sampled);
  for (std::size_t const i : counted(expected))
    EXPECT_NEAR(sum.psd[i], expected[i], 6 * std::sqrt(sum.variance[i]) + 1e-6 * expected[i]) << "bin " << i;
}

// Seven tones move the paths, two each: 21 sets of tones, each of which needs nodes of its own however far apart they
// lie. With 20 nodes no lattice exists, and every path is computed.
TEST(SharedSpectra, MoreSetsOfMotionThanNodes) {
  std::vector<MotionClass> tones;
  for (double const hz : {1.1, 1.3, 1.7, 1.9, 2.3, 2.9, 3.1}) tones.push_back({{}, hz, {}});
  Strengths paths{tones.size(), {}, {}};
  for (std::size_t a = 0; a < tones.size(); ++a)
    for (std::size_t b = a + 1; b < tones.size(); ++b)
      for (double const kappa : {4.0, 5.0}) {
        paths.kappa.resize(paths.kappa.size() + tones.size());
        double* const last = &paths.kappa[paths.kappa.size() - tones.size()];
        last[a] = last[b] = kappa;
        paths.weight.push_back(1);
      }
  PhaseSpectra const spectra(tones, grid);
  constexpr SpectrumInterpolator::Options few{0.25, 20, true, 24, 0}, some{0.25, 20, true, 24, 100};
  EXPECT_LT(worst(shared_sum(spectra, paths, some).psd, direct_sum(spectra, paths)), 1e-3);
  EXPECT_THROW(shared_sum(spectra, paths, few), NumericalError) << "control: nodes alone";
}

}  // namespace
}  // namespace straytrace::testing::noise_shared_spectra
