// SPDX-License-Identifier: BSD-3-Clause
// Tilts and defects of mirrors from the power on photodiodes (docs/theory/wave.md, eq. W.44): synthetic truth is
// recovered within its errors, and a wrong model is rejected.
#include "wave/diodes/diode_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "support/recorded.hpp"
#include "wave/diodes/halo.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::wave_diode_fit {
namespace {

constexpr double light = 1.064e-6, spot = 0.0205755;  // m

// A kilometre with photodiodes around an opening of 47 mm at its end, where the tail of the beam is 2e-6 of its peak.
struct Truth {
  double tilt1_x = 0, tilt2_x = 0, tilt2_y = 0;  // rad
  double bump = 0, bump_x = 0;                   // m: height of a round bump of 3 mm on mirror 1, and its place
  double opening_x = 0;                          // m
  std::uint64_t seed = 0;                        // of random heights; 0: none
};

double brdf_of(double angle) { return angle > 20e-6 && angle < 90e-6 ? 2e-8 / (angle * angle) : 0; }

WaveCavity cavity_of(Truth const& t) {
  Grid const grid{128, 0.42};
  WaveMirror const mirror{1 / 2500., {0.075}, 0, 0, {}, 0};
  WaveCavity cavity{light, 1000, mirror, mirror, {{990, {0.047, t.opening_x}, 0.06}}, grid};
  cavity.mirror1.tilt_x = t.tilt1_x;
  cavity.mirror2.tilt_x = t.tilt2_x;
  cavity.mirror2.tilt_y = t.tilt2_y;
  auto const spectrum = [](double f) { return height_spectrum(brdf_of(f * light), light); };
  cavity.mirror1.height =
      t.seed > 0 ? synthesise(spectrum, grid, 0, 90e-6 / light, t.seed, 0) : std::vector<double>(grid.size());
  if (t.seed > 0) cavity.mirror2.height = synthesise(spectrum, grid, 0, 90e-6 / light, t.seed, 1);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const r = std::hypot(grid.at(column) - t.bump_x, grid.at(row)) / 3e-3;
      cavity.mirror1.height[std::size_t(row) * std::size_t(grid.points) + std::size_t(column)] +=
          t.bump * std::exp(-r * r);
    }
  return cavity;
}

std::vector<Photodiode> const& rings() {
  static std::vector<Photodiode> const all = [] {
    std::vector<Photodiode> diodes;
    for (double r : {0.0495, 0.0545})
      for (int i = 0; i < 12; ++i)
        diodes.push_back({"", 1, Travel::towards_mirror2, 0, 0, r, 2 * pi * i / 12, DiodeShape::square, 4e-3, 0});
    return diodes;
  }();
  return all;
}

WaveMode mode_of(CavityWaves const& waves) {
  SolveOptions tight;
  tight.loss_error = 1e-6;
  return waves.mode(waves.hermite_gauss(), tight);
}
Eigen::VectorXd watts(Truth const& t) {
  CavityWaves const waves(cavity_of(t));
  DiodeMeter meter(waves, rings());
  Field work = mode_of(waves).spectrum;
  waves.round_trip(work, std::ref(meter));
  Eigen::VectorXd out(Eigen::Index(rings().size()));
  for (std::size_t i = 0; i < rings().size(); ++i) out[Eigen::Index(i)] = 1e4 * meter.light()[i].power();
  return out;
}
HaloStatistics halo(Truth const& t) {
  CavityWaves const waves(cavity_of(t));
  return halo_on(waves, mode_of(waves), {HaloMirror{spot, brdf_of}, HaloMirror{spot, brdf_of}}, rings());
}

Eigen::VectorXd measured(Eigen::VectorXd watts, Eigen::VectorXd const& error, std::uint64_t seed) {
  for (Eigen::Index i = 0; i < watts.size(); ++i) {
    Rng random(seed, std::uint64_t(i), 0, Stream::source);
    double const size = std::sqrt(-2 * std::log(random.uniform()));
    watts[i] += error[i] * size * std::cos(2 * pi * random.uniform());
  }
  return watts;
}

// Parameters in urad, nm and mm.
DiodeFitProblem problem_of(std::vector<FitRange> ranges, Eigen::VectorXd const& data, Eigen::VectorXd const& error,
                           std::function<Truth(Eigen::VectorXd const&)> const& truth) {
  Eigen::Index const n = data.size();
  return {std::move(ranges), data, error, [truth](Eigen::VectorXd const& at) { return watts(truth(at)); },
          [n](Eigen::VectorXd const&) -> Eigen::MatrixXd { return Eigen::MatrixXd::Zero(n, n); }};
}

Truth tilted(Eigen::VectorXd const& at) {
  Truth t;
  t.tilt2_x = 1e-6 * at[0];
  return t;
}

TEST(DiodeFit, TiltAndBumpOfKnownMirrors) {
  Truth truth;
  truth.tilt2_x = 0.3e-6;
  truth.bump = 1e-9;
  truth.bump_x = 5e-3;
  Eigen::VectorXd const clean = watts(truth), error = 0.02 * clean;
  auto const model = [](Eigen::VectorXd const& at) {
    Truth t;
    t.tilt2_x = 1e-6 * at[0];
    t.bump = 1e-9 * at[1];
    t.bump_x = 5e-3;
    return t;
  };
  std::vector<FitRange> const ranges{{-1, 1}, {0, 3}};
  DiodeFit const fit = fit_diodes(problem_of(ranges, measured(clean, error, 1), error, model));
  EXPECT_LT(std::fabs(fit.parameters[0].value - 0.3), 3 * fit.parameters[0].sigma);
  EXPECT_LT(std::fabs(fit.parameters[1].value - 1), 3 * fit.parameters[1].sigma);
  EXPECT_LT(fit.parameters[0].sigma, 0.1);
  EXPECT_LT(fit.parameters[1].sigma, 0.1);
  EXPECT_GT(fit.probability, 0.01);
  // Negative control: the same data without the bump in the model.
  DiodeFit const wrong = fit_diodes(problem_of({{-1, 1}}, measured(clean, error, 1), error, tilted));
  EXPECT_LT(wrong.probability, 1e-6);
}

// Diodes in one plane see where the beam is, not its direction: of two tilts they determine one combination,
// x_2 = L (alpha_1 + g_1 alpha_2)/(1 - g_1 g_2) (eq. W.23).
TEST(DiodeFit, TellsTheCombinationThatIsNotDetermined) {
  Truth truth;
  truth.tilt2_x = 0.2e-6;
  Eigen::VectorXd const clean = watts(truth), error = 0.02 * clean;
  auto const model = [](Eigen::VectorXd const& at) {
    Truth t;
    t.tilt1_x = 1e-6 * at[0];
    t.tilt2_x = 1e-6 * at[1];
    return t;
  };
  DiodeFit const fit = fit_diodes(problem_of({{-0.5, 0.5}, {-0.5, 0.5}}, measured(clean, error, 2), error, model));
  ASSERT_EQ(fit.undetermined.size(), 1u);
  EXPECT_NEAR(fit.undetermined[0][0] / fit.undetermined[0][1], -0.6, 0.1);  // -g_1
  EXPECT_FALSE(fit.parameters[0].determined || fit.parameters[1].determined);
  EXPECT_GT(fit.probability, 0.01);
}

// Heights of the mirrors that are not known: their speckle is part of the error, here 5 % on a photodiode of the inner
// ring from interference with the tail of the beam.
TEST(DiodeFit, SpeckleIsPartOfTheError) {
  Truth truth;
  truth.tilt2_x = 0.3e-6;
  truth.seed = 3;
  Eigen::VectorXd const clean = watts(truth), error = 0.002 * clean;
  HaloStatistics const h = halo({});
  DiodeFitProblem problem = problem_of({{-1, 1}}, measured(clean, error, 3), error, tilted);
  problem.mean = [&](Eigen::VectorXd const& at) -> Eigen::VectorXd { return watts(tilted(at)) + 1e4 * h.mean; };
  DiodeFit const without = fit_diodes(problem);  // negative control
  EXPECT_LT(without.probability, 1e-6);
  problem.covariance = [&](Eigen::VectorXd const&) -> Eigen::MatrixXd { return 1e8 * h.covariance; };
  DiodeFit const fit = fit_diodes(problem);
  EXPECT_LT(std::fabs(fit.parameters[0].value - 0.3), 3 * fit.parameters[0].sigma);
  EXPECT_GT(fit.parameters[0].sigma, 5 * without.parameters[0].sigma);
  EXPECT_LT(fit.parameters[0].sigma, 0.2);
  EXPECT_GT(fit.probability, 0.01);
  EXPECT_LT(fit.effective_degrees, fit.degrees);
}

}  // namespace
}  // namespace straytrace::wave_diode_fit
