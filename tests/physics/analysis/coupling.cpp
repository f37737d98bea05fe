// SPDX-License-Identifier: BSD-3-Clause
// Couplings from injections against synthetic truth (R6.01, R6.08).
#include "analysis/coupling/coupling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace::commission_coupling {
namespace {

using namespace straytrace::testing;

constexpr double rate = 256, truth = 3e-3;
constexpr std::size_t segment = 128;
constexpr WelchSettings settings{.segment = segment};
constexpr std::size_t twenty = 21 * segment / 2 + segment / 2;  // samples: 21 half-overlapping segments, worth 20

// One stretch: the witness shakes by `level` around its quiet 1; of it the target sees `coupled`; its own noise is 1.
struct Truth {
  double level, factor, own = 1, sensor = 0;
  CrossSpectra stretch(std::size_t samples, std::uint64_t seed) const {
    std::vector<double> const motion = white_noise(samples, 4 * seed, level);
    std::vector<double> const x = motion + white_noise(samples, 4 * seed + 1, sensor);
    std::vector<double> const y = factor * motion + white_noise(samples, 4 * seed + 2, own);
    return cross_spectra(channel("ACC", "m", rate, x), channel("H", "1", rate, y), settings);
  }
};

struct Outcome {
  Coverage coverage, apart;    // with the errors stated; with those of spectra that share nothing
  double mean = 0, plain = 0;  // of H; of sqrt(y/x) without the quiet levels
  int flags[5] = {}, points = 0, below_limit = 0, whole_missed = 0;  // whole: the target's power taken as a limit
  double missed() const { return double(flags[int(CouplingFlag::upper_limit)] - below_limit) / points; }
};

Outcome repeat(Truth const& loud, Truth const& still, std::size_t samples, int trials,
               CouplingThresholds const& t = {}) {
  Outcome o;
  for (int i = 0; i < trials; ++i) {
    CrossSpectra const a = loud.stretch(samples, 2 * std::uint64_t(i) + 1);
    CrossSpectra const b = still.stretch(samples, 2 * std::uint64_t(i) + 2);
    CrossSpectra c = a;
    std::fill(c.cross.begin(), c.cross.end(), 0.0);
    std::vector<CouplingPoint> const all = measure_coupling(a, b, t), apart = measure_coupling(c, b, {});
    for (std::size_t k = 2; k + 3 < all.size(); k += 3) {  // beyond what the Hann window spreads
      ++o.flags[int(all[k].flag)];
      ++o.points;
      if (all[k].flag == CouplingFlag::upper_limit) {
        o.below_limit += loud.factor < all[k].factor;
        double const up = upper_factor(a.effective_averages, 0.95);
        o.whole_missed += loud.factor > std::sqrt(up * a.output[k + 1] / (a.input[k + 1] - b.input[k + 1]));
      }
      if (all[k].flag != CouplingFlag::measured) continue;
      o.coverage.add(all[k].factor, all[k].sigma, loud.factor);
      o.apart.add(apart[k].factor, apart[k].sigma, loud.factor);
      o.mean += all[k].factor;
      o.plain += std::sqrt(a.output[k + 1] / a.input[k + 1]);
    }
  }
  o.mean /= std::max(1, o.coverage.all);
  o.plain /= std::max(1, o.coverage.all);
  return o;
}

TEST(Coupling, LinearTruthIsFoundWithItsErrorR6_01) {
  // Target 4 x quiet in amplitude: own 1, motion of 1 quiet and 1000 in the injection.
  Outcome const strong = repeat({1000, truth, 0.8}, {1, truth, 0.8}, twenty, 120);
  EXPECT_GT(strong.flags[int(CouplingFlag::measured)], 0.95 * strong.points);
  EXPECT_NEAR(strong.mean / truth, 1, 0.01);
  EXPECT_GT(strong.coverage.share(), 0.60);
  EXPECT_LT(strong.coverage.share(), 0.75);
  EXPECT_GT(strong.apart.share(), 0.80)
      << "control: witness and target taken as independent, though they rise together";
}

TEST(Coupling, ContributionOfTheQuietWitnessIsSubtractedR6_08) {
  // The quiet target is made by the witness altogether: H = 1 at any level, and 2.5 x is a weak injection.
  Truth const loud{2.5, 1, 0.1}, still{1, 1, 0.1};
  Outcome const o = repeat(loud, still, 40 * segment, 60, {.significance = 0});
  EXPECT_NEAR(o.mean, 1, 0.02);
  EXPECT_GT(o.coverage.share(), 0.60);
  EXPECT_LT(o.coverage.share(), 0.75);
  // Control: with independent noise in the target the plain ratio of injected spectra is too large.
  Outcome const weak = repeat({1000, truth, 1.5}, {1, truth, 1.5}, 80 * segment, 20);
  EXPECT_NEAR(weak.mean / truth, 1, 0.01);
  EXPECT_GT(weak.plain / truth, 1.08);
}

TEST(Coupling, ErrorsWithoutCoherenceAreThoseOfIndependentSpectra) {  // sensor noise as strong as the motion
  Outcome o;
  Truth const loud{1000, truth, 0.5, 0}, still{1, truth, 0.5, 0};
  for (int i = 0; i < 120; ++i) {  // another stretch of the same injection for the target
    auto const seed = 10 * std::uint64_t(i);
    CrossSpectra a = loud.stretch(twenty, seed + 1), b = still.stretch(twenty, seed + 2);
    CrossSpectra const other = loud.stretch(twenty, seed + 3), again = still.stretch(twenty, seed + 4);
    a.output = other.output;
    b.output = again.output;
    std::fill(a.cross.begin(), a.cross.end(), 0.0);
    std::fill(b.cross.begin(), b.cross.end(), 0.0);
    auto const all = measure_coupling(a, b, {.check_linear = false});
    for (std::size_t k = 2; k + 3 < all.size(); k += 3)
      if (all[k].flag == CouplingFlag::measured) o.coverage.add(all[k].factor, all[k].sigma, truth);
  }
  EXPECT_GT(o.coverage.share(), 0.60);
  EXPECT_LT(o.coverage.share(), 0.75);
}

TEST(Coupling, RiseOfTheWitnessAloneGivesALimitR6_08) {
  Outcome const none = repeat({1000, 0}, {1, 0}, twenty, 200);
  EXPECT_EQ(none.flags[int(CouplingFlag::measured)], 0) << "false alarms at 3 sigma and twice the amplitude";
  EXPECT_GT(none.flags[int(CouplingFlag::upper_limit)], 0.99 * none.points);
  // The largest coupling that can hide below twice the quiet amplitude: power of 2.2 on top of 1.
  Outcome const hidden = repeat({1000, 1.48e-3}, {1, 1.48e-3}, twenty, 200);
  EXPECT_GT(hidden.flags[int(CouplingFlag::upper_limit)], 0.5 * hidden.points);
  EXPECT_GE(hidden.below_limit, 0.95 * hidden.flags[int(CouplingFlag::upper_limit)]);
  Outcome const still = repeat({1, truth}, {1, truth}, twenty, 100);
  EXPECT_EQ(still.flags[int(CouplingFlag::below_thresholds)], still.points);
}

// C.4: the truth lies above a limit in 5 % of all trials where a coupling begins to show, in fewer where it cannot.
TEST(Coupling, LimitsHoldIn95PercentOfTrialsR6_08) {
  for (double const seen : {1.0, 1.2}) {  // motion of the injection in the target, over the target's own noise
    Outcome const o = repeat({1000, 1e-3 * seen}, {1, 1e-3 * seen}, twenty, 400);
    EXPECT_GT(o.flags[int(CouplingFlag::upper_limit)], 0.9 * o.points);
    EXPECT_NEAR(o.missed(), 0.045, 0.015) << seen;
    EXPECT_LT(o.whole_missed, 0.001 * o.points) << "control: the whole power of the target never misses";
  }
  EXPECT_LT(repeat({1000, 5e-4}, {1, 5e-4}, twenty, 100).missed(), 0.005)
      << "a low fluctuation of noise carries no information";
}

// The lowest of four limits: each needs more confidence than it would alone.
TEST(Coupling, LowestOfSeveralLimitsHoldsR6_08) {
  int const trials = 300;
  auto const missed = [&](double confidence) {
    int above = 0, points = 0;
    for (int i = 0; i < trials; ++i) {
      std::vector<CouplingFunction> all;
      CrossSpectra const still = Truth{1, 1e-3}.stretch(twenty, 5 * std::uint64_t(i) + 1);
      for (std::uint64_t j = 2; j < 6; ++j)
        all.push_back({"ACC", "H", "m", "1/m",
                       measure_coupling(Truth{1000, 1e-3}.stretch(twenty, 5 * std::uint64_t(i) + j), still,
                                        {.confidence = confidence})});
      std::vector<CouplingPoint> const lowest = combine(all).points;
      for (std::size_t k = 2; k + 3 < lowest.size(); k += 3) {
        above += lowest[k].flag == CouplingFlag::upper_limit && lowest[k].factor < 1e-3;
        ++points;
      }
    }
    return double(above) / points;
  };
  EXPECT_LT(missed(each_of(4, 0.95)), 0.05);
  EXPECT_GT(missed(0.95), 0.06) << "control: four limits of 95 %";
}

TEST(Coupling, FringeWrappedTargetIsFlaggedR6_08) {
  std::size_t const n = 60 * segment;
  auto const target = [n](std::vector<double> const& motion, std::uint64_t seed) {  // G sin(phi), phi = motion
    std::vector<double> y(n);
    for (std::size_t i = 0; i < n; ++i) y[i] = 20 * std::sin(motion[i] + 0.3);
    return channel("H", "1", rate, y + white_noise(n, seed));
  };
  std::vector<double> const still = white_noise(n, 1, 0.02), slow = white_noise(n, 2, 2.5);
  std::vector<double> weak = 0.1 * slow;
  CrossSpectra const quiet = cross_spectra(channel("ACC", "m", rate, still), target(still, 3), settings);
  auto const flags = [&](std::vector<double> const& motion) {
    int wrapped = 0;
    for (CouplingPoint const& p :
         measure_coupling(cross_spectra(channel("ACC", "m", rate, motion), target(motion, 4), settings), quiet, {}))
      wrapped += p.flag == CouplingFlag::not_linear;
    return wrapped;
  };
  EXPECT_GT(flags(slow), 55) << "2.5 rad rms: hardly any of the 64 bins is linear";
  EXPECT_EQ(flags(weak), 0) << "control: 0.25 rad rms is linear";
}

TEST(Coupling, InjectionsCombineR6_01) {
  auto const one = [](double factor, double sigma, CouplingFlag flag) {
    CouplingFunction c{"A", "H", "m", "1/m", {{}}};
    c.points[0].hz = 10;
    c.points[0].factor = factor;
    c.points[0].sigma = sigma;
    c.points[0].flag = flag;
    return c;
  };
  using enum CouplingFlag;
  auto const of = [](std::vector<CouplingFunction> const& all) { return combine(all).points[0]; };
  CouplingPoint const mean = of({one(1, 0.1, measured), one(1.1, 0.2, measured), one(0.5, not_a_number, upper_limit)});
  EXPECT_NEAR(mean.factor, 1.02, 1e-12);
  EXPECT_NEAR(mean.sigma, 0.1 / std::sqrt(1.25), 1e-12);
  CouplingPoint const apart = of({one(1, 0.1, measured), one(2, 0.1, measured)});  // chi^2 = 50
  EXPECT_NEAR(apart.sigma, 0.5, 1e-12);
  EXPECT_EQ(of({one(3, not_a_number, upper_limit), one(2, not_a_number, upper_limit)}).factor, 2);
  EXPECT_EQ(of({one(not_a_number, not_a_number, no_data), one(2, not_a_number, upper_limit)}).flag, upper_limit);
  EXPECT_EQ(of({one(1, 0.1, measured), one(2, 1, not_linear)}).flag, not_linear);
}

TEST(Coupling, UnitsOfFactors) {
  EXPECT_EQ(coupling_unit("1", "m"), "1/m");
  EXPECT_EQ(coupling_unit("m", "m"), "m/m");
  EXPECT_EQ(coupling_unit("1", "m/s^2"), "1/(m/s^2)");
}

}  // namespace
}  // namespace straytrace::commission_coupling
