// SPDX-License-Identifier: BSD-3-Clause
// Sequential tracing against the random walk, which searches surfaces and media.
#include "physics/trace/lit/trace_bench.hpp"

namespace straytrace::testing {
namespace {

// Where the last leg crosses the axis, m.
double focus(Vec3 before, Vec3 after) { return before.z - before.y * (after.z - before.z) / (after.y - before.y); }

// The index rule of case C8.4: a ray whose index is that of the glass leaves it, any other enters.
std::vector<SequenceStep> guessed(World const& world, std::vector<SequenceStep> steps) {
  WorldView const view = world.view();
  double index = 1;
  for (SequenceStep& step : steps) {
    std::uint32_t const volume = view.surfaces[step.surface.value].volume;
    if (volume == Surface::none) continue;
    double const glass = view.media[view.volumes[volume].medium].index;
    step.index = index = index == glass ? 1 : glass;
  }
  return steps;
}

struct Doublet {
  static constexpr double r1 = 0.060, r2 = -0.045, r3 = -0.130, t1 = 0.006, t2 = 0.0025, n1 = 1.517, n2 = 1.649;
  Bench bench;
  std::vector<SequenceStep> steps;
  explicit Doublet(double height) {
    std::uint32_t const crown = bench.glass(n1), flint = bench.glass(n2);
    SurfaceId const a = bench.face(Cap{{}, {0, 0, -1}, -1 / r1, 0, 0.012}, crown);
    SurfaceId const b = bench.face(Cap{{0, 0, t1}, {0, 0, 1}, 1 / r2, 0, 0.012}, crown);
    bench.face(Cap{{0, 0, t1}, {0, 0, -1}, -1 / r2, 0, 0.012}, flint);
    SurfaceId const c = bench.face(Cap{{0, 0, t1 + t2}, {0, 0, 1}, 1 / r3, 0, 0.012}, flint);
    steps = {{a, Event::transmit, n1}, {b, Event::transmit, n2}, {c, Event::transmit, 1}, {bench.screen()}};
    bench.shine({0, height, -0.05}, {0, 0, 1});
  }
  // Back focal distance by ray matrices: y, n u.
  static double paraxial(double middle_index = n2) {
    double const p1 = (n1 - 1) / r1, p2 = (middle_index - n1) / r2, p3 = (1 - middle_index) / r3;
    double y = 1, v = -p1;
    y += v * t1 / n1;
    v -= y * p2;
    y += v * t2 / middle_index;
    v -= y * p3;
    return -y / v;
  }
};

// R3.02, and the focus in the limit of small heights. Control: another index behind the cement.
TEST(Sequential, FocusOfACementedDoublet) {
  for (double const height : {1e-4, 3e-3, 0.01}) {
    Doublet d(height);
    WorldView const view = d.bench.world.view();
    Sequence const s = trace_sequence(view, d.bench.ray(), d.steps);
    std::vector<Visited> const w = walked(d.bench.world, d.steps);
    ASSERT_EQ(w.size(), 4u) << "the walk never passed straight through";
    EXPECT_LT(largest_difference(s, w), metre) << height;
    double const one = focus(s.points[2].point, s.points[3].point), two = focus(w[2].point, w[3].point);
    EXPECT_NEAR(one, two, metre) << height;
    auto other = d.steps;
    other[1].index *= 1 + 1e-9;
    EXPECT_GT(largest_difference(trace_sequence(view, d.bench.ray(), other), w), metre);
    if (height > 1e-4) continue;
    EXPECT_NEAR(one - Doublet::t1 - Doublet::t2, Doublet::paraxial(), 1e-6);
    EXPECT_GT(std::fabs(one - Doublet::t1 - Doublet::t2 - Doublet::paraxial(1.65)), 1e-6);
  }
}

// R3.01: the same way back; points and lengths. Control: back through the lens turned round.
TEST(Sequential, ForwardAndBackward) {
  Doublet d(0.01);
  WorldView const view = d.bench.world.view();
  Sequence const there = trace_sequence(view, d.bench.ray(), d.steps);
  ASSERT_EQ(there.end, SequenceEnd::complete);
  std::vector<SequenceStep> const back = {{d.steps[2].surface, Event::transmit, Doublet::n2},
                                          {d.steps[1].surface, Event::transmit, Doublet::n1},
                                          {d.steps[0].surface, Event::transmit, 1}};
  auto const difference = [&](std::vector<SequenceStep> const& steps) {
    Ray const start{there.points[3].point, -there.points[2].dir};
    Sequence const s = trace_sequence(view, start, steps, 1, {d.steps[3].surface});
    if (s.end != SequenceEnd::complete) return infinity;
    double most = 0;
    for (int i = 0; i < 3; ++i) most = std::max(most, length(s.points[i].point - there.points[2 - i].point));
    double const whole = there.points[3].path_length, first = there.points[0].path_length;
    return std::max(
        {most, std::fabs(s.points[2].path_length - (whole - first)), length(s.points[2].dir + d.bench.ray().dir)});
  };
  EXPECT_LT(difference(back), metre);
  auto wrong = back;
  std::swap(wrong[0].index, wrong[1].index);
  EXPECT_GT(difference(wrong), metre);
}

// A ball of glass in glass, and two plates that touch: one boundary each, whatever the order of the faces. Control:
// media guessed from the index of the ray (C8.4).
TEST(Sequential, NestedAndTouchingGlass) {
  Bench nested;
  std::uint32_t const block = nested.glass(1.5), ball = nested.glass(1.7);
  SurfaceId const front = nested.face(Disk{{}, {0, 0, -1}, 0, 0.05}, block),
                  back = nested.face(Disk{{0, 0, 0.04}, {0, 0, 1}, 0, 0.05}, block),
                  sphere = nested.face(Sphere{{0, 0, 0.02}, {0, 0, 1}, 0.01}, ball), end = nested.screen();
  nested.shine({0, 0.004, -0.05}, {0.02, 0, 1});
  std::vector<SequenceStep> const in_ball = {{front, Event::transmit, 1.5},
                                             {sphere, Event::transmit, 1.7},
                                             {sphere, Event::transmit, 1.5},
                                             {back, Event::transmit, 1},
                                             {end}};
  Bench touching;
  std::uint32_t const one = touching.glass(1.5), two = touching.glass(1.7);
  SurfaceId const a = touching.face(Disk{{}, {0, 0, -1}, 0, 0.05}, one);
  SurfaceId const b = touching.face(Disk{{0, 0, 0.005}, {0, 0, -1}, 0, 0.05}, two);  // found first, entered last
  touching.face(Disk{{0, 0, 0.005}, {0, 0, 1}, 0, 0.05}, one);
  SurfaceId const c = touching.face(Disk{{0, 0, 0.01}, {0, 0, 1}, 0, 0.05}, two), wall = touching.screen();
  touching.shine({0, 0.004, -0.05}, {0.3, 0.1, 1});
  std::vector<SequenceStep> const plates = {
      {a, Event::transmit, 1.5}, {b, Event::transmit, 1.7}, {c, Event::transmit, 1}, {wall}};
  struct Case {
    Bench& bench;
    std::vector<SequenceStep> const& steps;
  };
  for (Case const& k : {Case{nested, in_ball}, Case{touching, plates}}) {
    WorldView const view = k.bench.world.view();
    std::vector<Visited> const w = walked(k.bench.world, k.steps);
    ASSERT_EQ(w.size(), k.steps.size());
    EXPECT_LT(largest_difference(trace_sequence(view, k.bench.ray(), k.steps), w), metre);
    for (std::size_t i = 0; i + 1 < w.size(); ++i) EXPECT_EQ(w[i].n_out, k.steps[i].index) << i;
  }
  EXPECT_GT(largest_difference(trace_sequence(nested.world.view(), nested.ray(), guessed(nested.world, in_ball)),
                               walked(nested.world, in_ball)),
            1e-4);
}

// Three mirrors at right angles, turned somehow: antiparallel to 1e-12. Control: one mirror tilted by 1e-9 rad.
TEST(Sequential, CornerCube) {
  auto const error = [](double tilt) {
    Bench bench;
    Frame const cube = Frame::around(unit({0.3, -0.5, 0.8}));
    std::vector<SequenceStep> steps;
    for (Vec3 const normal : {cube.e1, cube.e2, unit(cube.e3 + tilt * cube.e1)})
      steps.push_back({bench.mirror(Disk{{}, normal, 0, 2}), Event::reflect});
    Vec3 const along = -(cube.e1 + 0.8 * cube.e2 + 0.7 * cube.e3);
    bench.shine(-1.2 * along + 0.1 * cube.e1 - 0.05 * cube.e2, along);
    bench.world.limits.max_order = 3;
    WorldView const view = bench.world.view();
    std::vector<Visited> const w = walked(bench.world, steps);
    if (w.size() != 3) return infinity;
    for (int i = 0; i < 3; ++i) steps[i].surface = w[i].surface;
    Sequence const s = trace_sequence(view, bench.ray(), steps);
    EXPECT_LT(largest_difference(s, w), metre);
    return length(s.points[2].dir + bench.ray().dir);
  };
  EXPECT_LT(error(0), 1e-12);
  EXPECT_GT(error(1e-9), 1e-12);
}

}  // namespace
}  // namespace straytrace::testing
