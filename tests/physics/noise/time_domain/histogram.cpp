// SPDX-License-Identifier: BSD-3-Clause
// Paths that share spectra against the separate spectrum of each path (requirement R4.08, docs/theory/spectra.md,
// eq. 1.11).
#include "base/math/rng.hpp"
#include "noise/interpolate/spectrum_interpolator.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_histogram {
namespace {

// kappa of `count` paths: log-normal, independent in each class, times the strength of the class.
Strengths spread(std::vector<double> const& strength, std::size_t count, double sigma) {
  Strengths s{strength.size(), {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(11, i, 0, Stream::source);
    for (double k : strength)
      s.kappa.push_back(k *
                        std::exp(sigma * std::sqrt(-2 * std::log(rng.uniform())) * std::cos(2 * pi * rng.uniform())));
  }
  return s;
}

struct Shared {
  double error;  // largest over the bins that are not below `floor` of the highest
  std::size_t nodes;
  double step;
  double checked;  // largest error that the spot checks found
};

Shared compare(PhaseSpectra const& spectra, Strengths const& paths, SpectrumInterpolator::Options options,
               double floor = 0) {
  SpectrumInterpolator const nodes(spectra, paths, options);
  std::vector<double> direct(spectra.grid().size()), shared(direct);
  std::vector<SpectrumInterpolator::Share> shares;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    std::vector<double> const one = spectra(paths.of(p)).psd;
    nodes.shares(p, shares);
    for (std::size_t i = 0; i < one.size(); ++i) {
      direct[i] += one[i];
      for (SpectrumInterpolator::Share const& s : shares) shared[i] += s.weight * nodes.basis()[s.basis].psd[i];
    }
  }
  double worst = 0;
  for (std::size_t i = 0; i < direct.size(); ++i)
    if (direct[i] > floor * *std::max_element(direct.begin(), direct.end()))
      worst = std::max<double>(worst, deviation(shared[i], direct[i]));
  double checked = 0;
  for (SpotCheck const& c : nodes.checks()) checked = std::max(checked, c.error);
  return {worst, nodes.nodes(), nodes.step(), checked};
}

FrequencyGrid const grid = logarithmic_grid(3, 100, 12);
MotionClass const ground{power_law_asd(3e-9, 1, -2, 0.1, 300), 0, {}};
double const unit = 3 / ground.variance();  // a phase of 1.7 rad rms

// R4.08. Tolerance: three times the phase power that each separate path treats to first order, above a split of its
// own.
TEST(StrengthHistogram, OneClassAgreesWithTheSumOverPaths) {
  PhaseSpectra const spectra({ground}, grid);
  Strengths const paths = spread({unit}, 120, 1.2);
  Shared const usual = compare(spectra, paths, {});
  EXPECT_LT(usual.nodes, 100u);
  EXPECT_LT(usual.error, 3 * PhaseSpectra::weak);
  EXPECT_GT(compare(spectra, paths, {3, 400, false}).error, 3 * PhaseSpectra::weak);  // control: twelve times as coarse
}

// A narrow line leaves Gaussian tails, where spectra of different strength differ by decades: the step must adapt.
TEST(StrengthHistogram, StepFollowsTheSteepestBin) {
  PhaseSpectra const spectra({{gaussian_line(0.2, 0.05, 1e-6), 0, {}}}, grid);
  Strengths const paths = spread({two_k * two_k}, 150, 0.5);
  Shared const usual = compare(spectra, paths, {}, 1e-12), coarse = compare(spectra, paths, {0.25, 400, false}, 1e-12);
  EXPECT_LT(usual.error, 1e-4);
  EXPECT_LT(usual.step, 0.25);
  EXPECT_GT(coarse.error, 1e-4);  // control: the first step kept
}

TEST(StrengthHistogram, SeveralClasses) {  // two strong ones and one that is linear
  MotionClass const other{power_law_asd(3e-9, 1, -1.2, 0.1, 300), 0, {}},
      quiet{power_law_asd(1e-16, 100, -1, 20, 1000), 0, {}};
  PhaseSpectra const spectra({ground, other, quiet}, grid);
  Strengths const paths = spread({unit, 0.5 / other.variance(), 1e-5 / quiet.variance()}, 200, 0.4);
  EXPECT_LT(compare(spectra, paths, {}).error, 5e-4);
  Shared const usual = compare(spectra, paths, {0.25, 400, false});
  EXPECT_GT(usual.step, SpectrumInterpolator::same);
  EXPECT_LT(usual.error, 5e-4);
}

// Light scattered by small angles moves the phase along the beam by 2k, across it by anything down to nothing. Far in
// the tail of wrapped fringes, where a spectrum is ten decades below its highest value, either changes it by factors.
TEST(StrengthHistogram, StrengthsOfTwoClassesSpreadOverDecades) {
  Spectrum const sea = gaussian_line(0.35, 0.08, 0.5e-6);
  PhaseSpectra const spectra({{power_law_asd(1e-6, 1, -2, 0.7, 2000) + sea, 0, {}},
                              {power_law_asd(1e-6, 1, -2.2, 0.7, 2000) + sea.scaled(2), 0, {}}},
                             grid);
  Strengths paths{2, {}, {}};
  for (int i = 0; i < 160; ++i) {
    Rng rng(12, i, 0, Stream::source);
    double const along = std::exp(0.6 * (rng.uniform() - 0.5)), across = std::pow(10, -6 * rng.uniform());
    paths.kappa.insert(paths.kappa.end(), {two_k * two_k * along, 0.3 * two_k * two_k * across});
  }
  Shared const usual = compare(spectra, paths, {});
  EXPECT_GT(usual.step, SpectrumInterpolator::same);
  EXPECT_LT(usual.error, 3 * PhaseSpectra::weak);
  EXPECT_GT(usual.checked, 0);  // some paths were checked
  EXPECT_LE(usual.checked, SpectrumInterpolator::tolerance);
  Shared const coarse = compare(spectra, paths, {1, 400, false});  // control: four times as coarse
  EXPECT_GT(coarse.error, 1e-2);
  EXPECT_GT(coarse.checked, SpectrumInterpolator::tolerance);  // and the spot checks see it
}

TEST(StrengthHistogram, FewPathsAreTheirOwnNodes) {
  PhaseSpectra const spectra({ground}, grid);
  Shared const few = compare(spectra, spread({unit}, 5, 1), {});
  EXPECT_EQ(few.nodes, 5u);
  EXPECT_LT(few.error, 1e-12);
}

TEST(StrengthHistogram, StepGrowsUntilNodesAreFew) {
  PhaseSpectra const spectra({ground}, FrequencyGrid{{10, 11}});
  SpectrumInterpolator const nodes(spectra, spread({unit}, 1000, 1), {1e-3, 100, false});
  EXPECT_LE(nodes.nodes(), 100u);
  EXPECT_GT(nodes.step(), 1e-3);
}

// One input through two transfers of opposite slope: |H1 - H2|^2 S = |H1|^2 S + |H2|^2 S - 2 Re H1 H2* S, the last as a
// class of negative kappa. Against the same PSD as one class.
TEST(StrengthHistogram, NegativeKappa) {
  Spectrum const a = power_law_asd(4e-9, 1, -2, 0.3, 300), b = power_law_asd(2e-9, 1, -1, 0.3, 300),
                 cross = power_law_asd(std::sqrt(8e-18), 1, -1.5, 0.3, 300);
  PhaseSpectra const spectra({{a, 0, {}}, {b, 0, {}}, {cross, 0, {}}}, grid);
  auto const square = [](double f) { return std::pow(4e-9 * std::pow(f, -2) - 2e-9 / f, 2); };
  std::vector<double> hz, psd;
  for (double f = 0.3; f < 300; f *= 1.002) {
    hz.push_back(f);
    psd.push_back(square(f));
  }
  PhaseSpectra const whole({{Spectrum(hz, psd), 0, {}}}, grid);
  for (double k : {1e-3, 1.0}) {
    double const kappa = k * two_k * two_k;
    std::vector<double> const parts = spectra(std::vector{kappa, kappa, -2 * kappa}).psd,
                              one = whole(std::vector{kappa}).psd, forgot = spectra(std::vector{kappa, kappa, 0.0}).psd;
    for (std::size_t i = 0; i < grid.size(); ++i) EXPECT_LT(deviation(parts[i], one[i]), 5e-3) << k << " bin " << i;
    EXPECT_GT(deviation(forgot[3], one[3]), 0.1);  // control: the negative class dropped
  }
  Strengths paths{3, {}, {}};
  for (int i = 0; i < 16; ++i)
    for (double k : {1.0, 1.0, -1.0}) paths.kappa.push_back(k * 0.3 * two_k * two_k * (1 + 0.008 * i));
  Shared const cells = compare(spectra, paths, {0.25, 50, false});
  EXPECT_LT(cells.nodes, 10u);
  EXPECT_LT(cells.error, 1e-3);
}

}  // namespace
}  // namespace straytrace::testing::noise_histogram
