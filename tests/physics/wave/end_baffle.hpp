// SPDX-License-Identifier: BSD-3-Clause
// A kilometre with photodiodes around an opening of 47 mm at its end, where the tail of the beam is 2e-5 of its peak:
// what they measure for tilts and defects of the mirrors.
#pragma once

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "wave/diodes/diode_fit.hpp"
#include "wave/diodes/photodiode.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::testing::end_baffle {

inline constexpr double light = 1.064e-6, spot = 0.0205755;  // m

struct Truth {
  double tilt1_x = 0, tilt2_x = 0, tilt2_y = 0;  // rad
  double bump = 0, bump_x = 0;                   // m: height of a round bump of 3 mm on mirror 1, and its place
  double opening_x = 0;                          // m
  std::uint64_t seed = 0;                        // of random heights; 0: none
};

inline double brdf_of(double angle) { return angle > 20e-6 && angle < 90e-6 ? 2e-8 / (angle * angle) : 0; }

inline WaveCavity cavity_of(Truth const& t) {
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

inline std::vector<Photodiode> const& rings() {
  static std::vector<Photodiode> const all = [] {
    std::vector<Photodiode> diodes;
    for (double r : {0.0495, 0.0545})
      for (int i = 0; i < 12; ++i)
        diodes.push_back({"", 1, Travel::towards_mirror2, 0, 0, r, 2 * pi * i / 12, DiodeShape::square, 4e-3, 0});
    return diodes;
  }();
  return all;
}

inline WaveMode mode_of(CavityWaves const& waves) {
  SolveOptions tight;
  tight.loss_error = 1e-6;
  return waves.mode(waves.hermite_gauss(), tight);
}
inline Eigen::VectorXd watts(Truth const& t) {
  CavityWaves const waves(cavity_of(t));
  DiodeMeter meter(waves, rings());
  Field work = mode_of(waves).spectrum;
  waves.round_trip(work, std::ref(meter));
  Eigen::VectorXd out(Eigen::Index(rings().size()));
  for (std::size_t i = 0; i < rings().size(); ++i) out[Eigen::Index(i)] = 1e4 * meter.light()[i].power();
  return out;
}
inline HaloStatistics halo(Truth const& t) {
  CavityWaves const waves(cavity_of(t));
  return halo_on(waves, mode_of(waves), {HaloMirror{spot, brdf_of}, HaloMirror{spot, brdf_of}}, rings());
}

inline Eigen::VectorXd measured(Eigen::VectorXd watts, Eigen::VectorXd const& error, std::uint64_t seed) {
  for (Eigen::Index i = 0; i < watts.size(); ++i) {
    Rng random(seed, std::uint64_t(i), 0, Stream::source);
    double const size = std::sqrt(-2 * std::log(random.uniform()));
    watts[i] += error[i] * size * std::cos(2 * pi * random.uniform());
  }
  return watts;
}

// Parameters in urad, nm and mm.
inline DiodeFitProblem problem_of(std::vector<FitRange> ranges, Eigen::VectorXd const& data,
                                  Eigen::VectorXd const& error,
                                  std::function<Truth(Eigen::VectorXd const&)> const& truth) {
  Eigen::Index const n = data.size();
  return {std::move(ranges), data, error, [truth](Eigen::VectorXd const& at) { return watts(truth(at)); },
          [n](Eigen::VectorXd const&) -> Eigen::MatrixXd { return Eigen::MatrixXd::Zero(n, n); }};
}

inline Truth tilted(Eigen::VectorXd const& at) {
  Truth t;
  t.tilt2_x = 1e-6 * at[0];
  return t;
}

}  // namespace straytrace::testing::end_baffle
