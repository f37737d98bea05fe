// SPDX-License-Identifier: BSD-3-Clause
// The full result of E.1, from the trace to h: the empty tube with light both ways and two arms.
// Eq. 8.10 (docs/theory/arm.md) is of one direction and one arm: x 2 in amplitude for the reverse path, x sqrt 2 for
// the arms.
#include "support/arm_tube.hpp"

#include <algorithm>

#include "ifo/fabry_perot_michelson.hpp"
#include "noise/noise.hpp"

namespace straytrace::testing::arm_tube {
namespace {

constexpr std::uint64_t histories = 1 << 20;

SampleMean at_10_hz(bool both_ways, double arms) {  // rms strain, mean over static phases
  World world = make({.both_ways = both_ways});
  aim_at_first_order(world);
  world.limits.max_order = 2;
  CouplingTable const table = run_histories(world, histories).coupling;
  FabryPerotMichelson::Parameters p;
  p.arm = {arm, 0.014, 0, 0};
  p.wavelength = lambda;
  p.power = 1;
  p.mass = 1e9;  // no radiation pressure to speak of
  p.mode = {142.3, 55};
  p.arms = arms;
  MotionSet motion;
  motion.bodies = table.bodies;
  auto const pipe = std::uint32_t(std::find(table.bodies.begin(), table.bodies.end(), "pipe") - table.bodies.begin());
  std::complex<double> const i{0, 1};  // the second axis a quarter of a period later
  motion.inputs = {{"shaker", {}, 10, {{BodyId{pipe}, 0, wall_motion}, {BodyId{pipe}, 1, wall_motion * i}}}};
  NoiseSettings settings;
  settings.grid.edges = {9, 11};
  NoiseTrace const total = project_noise(table, motion, FabryPerotMichelson(p), settings).total;
  return {total.asd[0] * std::sqrt(2.0), total.sigma[0] * std::sqrt(2.0), (long long)histories};
}

// An error of 3 % of h is seen; controls leave out one factor each.
TEST(ArmTube, FullResultE1) {
  double const mean = std::sqrt(0.5), expected = mean * 3.68e-24;  // over static phases
  expect_mean("both directions, two arms", at_10_hz(true, 2), expected, 3e-2 * expected);
  expect_mean("one direction, one arm", at_10_hz(false, 1), mean * 1.3025e-24, 3e-2 * mean * 1.3025e-24);
  expect_rejected("one arm", at_10_hz(true, 1), expected);
  expect_rejected("one direction", at_10_hz(false, 2), expected);
}

}  // namespace
}  // namespace straytrace::testing::arm_tube
