// SPDX-License-Identifier: BSD-3-Clause
// The chief rays of the beam tree are the rays of the trace: the same surfaces, points and optical lengths as in the
// sequential trace, through tilted curved faces and a wedge.
#include <gtest/gtest.h>

#include "support/ghost_support.hpp"
#include "support/sequential.hpp"

namespace straytrace::testing::trace_beam_tree {
namespace {

struct Bench {
  World world;
  SurfaceId front, back, wedge_front, wedge_back;
};
constexpr double n_lens = 1.45, n_wedge = 1.7;

Bench bench() {
  Bench b;
  b.world.wavelength = lambda;
  std::uint32_t const optic = coated(b.world, 1e-3);
  std::uint32_t const lens = b.world.add_volume({n_lens, 0}), wedge = b.world.add_volume({n_wedge, 0});
  BodyId const body = b.world.add_body("bench", {});
  Vec3 const tilt = unit({0.1, -0.05, -1});
  b.front = b.world.add_surface(cap(-3, 0, 0.05, {{0.003, 0.001, 0}, tilt}), optic, optic, body,
                                b.world.add_group("front"), lens);
  b.back = b.world.add_surface(cap(-2, 0, 0.05, {Vec3{0.003, 0.001, 0} - 0.01 * tilt, -tilt}), optic, optic, body,
                               b.world.add_group("back"), lens);
  b.wedge_front = b.world.add_surface(disk(0, 0.1, {{0, 0, 0.2}, unit({0.02, 0.3, -1})}), optic, optic, body,
                                      b.world.add_group("wedge front"), wedge);
  b.wedge_back = b.world.add_surface(disk(0, 0.1, {{0, 0, 0.22}, unit({0, -0.3, 1})}), optic, optic, body,
                                     b.world.add_group("wedge back"), wedge);
  b.world.finish();
  return b;
}

TEST(BeamTree, chief_rays_are_those_of_the_sequential_trace) {
  Bench const b = bench();
  BeamLaunch const launch = launched(b.world, 1e-3, {0, 0, -0.3});
  WorldView const view = b.world.view();
  int compared = 0;
  for (Row const& r : rows(b.world, launch, {1e-15, 2, 1000})) {
    if (r.order > 2 || r.way.empty()) continue;
    std::vector<SequenceStep> steps;
    for (BeamStep const& s : r.way) steps.push_back({s.surface, s.event, s.n_out});
    Sequence const wanted = trace_sequence(view, {launch.mode.origin, launch.mode.travel}, steps);
    ASSERT_EQ(wanted.end, SequenceEnd::complete);
    for (std::size_t i = 0; i < r.way.size(); ++i) {
      EXPECT_LT(length(wanted.points[i].point - r.way[i].point), 1e-13);
      EXPECT_LT(length(wanted.points[i].dir - r.way[i].out), 1e-13);
      EXPECT_NEAR(wanted.points[i].path_length, r.way[i].path_length, 1e-13);
      bool const in_glass = r.way[i].n_in > 1;
      EXPECT_EQ(r.way[i].n_in, !in_glass                                                   ? 1
                               : r.way[i].surface == b.front || r.way[i].surface == b.back ? n_lens
                                                                                           : n_wedge);
    }
    ++compared;
    if (r.way.size() < 2) continue;
    for (SequenceStep& s : steps) s.index = 1;  // control: no refraction
    Sequence const control = trace_sequence(view, {launch.mode.origin, launch.mode.travel}, steps);
    EXPECT_GT(length(control.points.back().dir - r.way.back().out), 1e-3);
  }
  EXPECT_GE(compared, 7);  // the main beam and the ghosts that stay within the apertures
}

}  // namespace
}  // namespace straytrace::testing::trace_beam_tree
