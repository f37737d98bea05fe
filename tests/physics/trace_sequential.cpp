// SPDX-License-Identifier: BSD-3-Clause
// Sequential tracing against the walk, which finds surfaces and media by itself (requirements.md R3.01, R3.02, R3.04,
// R3.22, R3.23), and both against closed forms.
#include "trace/sequential.hpp"
#include "trace_support.hpp"

namespace straytrace::testing {
namespace {

constexpr double metre = 1e-12;  // m, agreement asked of two tracings of one ray

// Glass and mirrors about the z axis, a free beam from z = -50 mm and a black screen at z = 1 m.
class Bench {
 public:
  Bench() : body_(world.add_body("bench", {})), group_(world.add_group("bench")), black_(black_optic(world)) {
    Optic bare;
    bare.has_interface = true;
    bare.interface = world.add_interface(Fresnel{});
    bare_ = world.add_optic(bare);
  }
  std::uint32_t glass(double index) { return world.add_volume({index, 0}); }
  template <class Shape>
  SurfaceId face(Shape const& shape, std::uint32_t volume) {
    return world.add_surface(shape, bare_, bare_, body_, group_, volume);
  }
  template <class Shape>
  SurfaceId mirror(Shape const& shape) {
    std::uint32_t const silver = mirror_optic(world, 1);
    return world.add_surface(shape, silver, silver, body_, group_);
  }
  SurfaceId screen() { return world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 1}, black_, black_, body_, group_); }
  void shine(Vec3 from, Vec3 along) {
    Footprint f;
    f.centre = start_ = from;
    f.travel = along_ = unit(along);
    f.profile = Profile::point;
    f.free = true;
    f.receives = false;
    world.add_footprint(f);
    world.limits.roulette_below = 0;
    world.finish();
  }
  Ray ray() const { return {start_, along_}; }

  World world;

 private:
  BodyId body_;
  GroupId group_;
  std::uint32_t black_, bare_ = 0;
  Vec3 start_, along_;
};

struct Visited {
  SurfaceId surface;
  Vec3 point;
  double path_length, n_out;
  Event left_by;  // how light left the vertex before
};
struct Visits : Silent {
  std::vector<Visited> all;
  void visit(PathState const& p, Vertex const& v) {
    all.push_back({v.surface, v.point, p.path_length, v.n_out, p.hop.left_by});
  }
};

// The first history of the walk that passes through everything; reflections where `steps` says so.
std::vector<Visited> walked(World const& world, std::span<SequenceStep const> steps) {
  WorldView const view = world.view();
  for (std::uint64_t h = 0; h < 2000; ++h) {
    Visits sink;
    trace_history(view, 3, h, sink);
    bool same = sink.all.size() == steps.size();
    for (std::size_t i = 0; same && i + 1 < steps.size(); ++i) same = sink.all[i + 1].left_by == steps[i].event;
    if (same) return sink.all;
  }
  return {};
}

double largest_difference(Sequence const& s, std::vector<Visited> const& w) {
  if (s.end != SequenceEnd::complete || s.points.size() != w.size() || w.empty()) return infinity;
  double most = 0;
  for (std::size_t i = 0; i < w.size(); ++i)
    most =
        std::max({most, length(s.points[i].point - w[i].point), std::fabs(s.points[i].path_length - w[i].path_length)});
  return most;
}

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

// R3.02, and the focus in the limit of small heights. Twin: another index behind the cement.
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

// R3.01: the same way back; points and lengths. Twin: back through the lens turned round.
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

// A ball of glass in glass, and two plates that touch: one boundary each, whatever the order of the faces. Twin: media
// guessed from the index of the ray (C8.4).
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

// Three mirrors at right angles, turned somehow: antiparallel to 1e-12. Twin: one mirror tilted by 1e-9 rad.
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

// R3.23: 43.602 deg for n = 1.45003, everything reflected beyond. Twin: index 1.4496.
TEST(Sequential, CriticalAngle) {
  auto const critical = [](double index) {
    Bench bench;
    SurfaceId const face = bench.face(Disk{{}, {0, 0, 1}, 0, 10}, bench.glass(index));
    bench.world.finish();
    double low = 0.5, high = 1.2;
    std::vector<SequenceStep> const out = {{face, Event::transmit, 1}};
    for (int i = 0; i < 50; ++i) {
      double const angle = 0.5 * (low + high);
      Ray const ray{{-std::sin(angle), 0, -std::cos(angle)}, {std::sin(angle), 0, std::cos(angle)}};
      SequenceEnd const end = trace_sequence(bench.world.view(), ray, out, index).end;
      (end == SequenceEnd::complete ? low : high) = angle;
      if (i > 30) continue;  // within rounding of the edge
      PathState path;
      path.media.enter(0);
      Vertex v = make_vertex(bench.world.view(), face, {}, ray.dir);
      look(bench.world.view(), path, ray.dir, v);
      if (end == SequenceEnd::total_reflection) {
        EXPECT_NEAR(v.reflect, 1, 1e-12);
        EXPECT_EQ(v.transmit, 0);
      } else {
        EXPECT_GT(v.transmit, 0);
      }
    }
    return low * 180 / pi;
  };
  EXPECT_NEAR(critical(1.45003), 43.602, 5e-4);
  EXPECT_GT(std::fabs(critical(1.4496) - 43.602), 5e-4);
}

// R3.04: a hollow pipe of a million reflections, no recursion; bounces of a ray in a plane through the axis at 45 deg
// are 2 R apart. Twin: a radius that is 1e-9 larger. At the limit of orders all power is booked.
TEST(Sequential, PipeOfAMillionBounces) {
  constexpr std::uint32_t bounces = 1000000;
  constexpr double radius = 1e-3;
  Bench bench;
  SurfaceId const pipe = bench.mirror(Cylinder{{}, {0, 0, 1}, radius, -1, 2 * radius * bounces});
  bench.shine({}, {1, 0, 1});
  bench.world.limits.max_order = bounces;
  struct Last : Silent {
    Vec3 point;
    std::uint64_t count = 0;
    double length = 0, limit = 0;
    void visit(PathState const& p, Vertex const& v) {
      point = v.point;
      length = p.path_length;
      ++count;
    }
    void book(Fate fate, double power) {
      if (fate == Fate::limit) limit += power;
    }
  } last;
  WorldView const view = bench.world.view();
  trace_history(view, 1, 0, last);
  EXPECT_EQ(last.count, bounces);
  EXPECT_DOUBLE_EQ(last.limit, 1);
  auto const expected = [](double r) { return r * (2.0 * bounces - 1); };
  EXPECT_NEAR(last.point.z / expected(radius), 1, 1e-10);
  EXPECT_GT(std::fabs(last.point.z / expected(radius * (1 + 1e-9)) - 1), 1e-10);
  std::vector<SequenceStep> const steps(bounces, {pipe, Event::reflect});
  Sequence const s = trace_sequence(view, bench.ray(), steps);
  ASSERT_EQ(s.points.size(), bounces);
  EXPECT_NEAR(s.points.back().point.z, last.point.z, 1e-9);
  EXPECT_NEAR(s.points.back().path_length / last.length, 1, 1e-12);
}

// R3.22: angle in = angle out to 1e-15, in the plane of incidence. Twin: a normal 1e-14 rad off.
TEST(Sequential, ReflectionKeepsTheAngle) {
  auto const most = [](double off) {
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
      Rng rng(5, i, 0, Stream::source);
      auto const direction = [&] {
        double const z = 2 * rng.uniform() - 1;
        SinCos const a = sincos_turn(rng.uniform());
        return unit({std::sqrt(1 - z * z) * a.cos, std::sqrt(1 - z * z) * a.sin, z});
      };
      Vec3 const normal = direction(), d = direction();
      Vec3 const out = unit(reflected(d, unit(normal + off * any_normal(normal))));
      worst = std::max({worst, std::fabs(dot(out, normal) + dot(d, normal)), std::fabs(dot(cross(d, normal), out))});
    }
    return worst;
  };
  EXPECT_LT(most(0), 1e-15);
  EXPECT_GT(most(1e-14), 1e-15);
}

// Plane-parallel plate: shift t sin a (1 - cos a/(n cos b)), direction kept. Twin: index 0.1 % off.
TEST(Sequential, ShiftOfAPlate) {
  constexpr double thickness = 0.01, n = 1.5, angle = 0.6;
  Bench bench;
  std::uint32_t const glass = bench.glass(n);
  SurfaceId const front = bench.face(Disk{{}, {0, 0, -1}, 0, 0.1}, glass),
                  back = bench.face(Disk{{0, 0, thickness}, {0, 0, 1}, 0, 0.1}, glass);
  bench.shine({-0.05 * std::tan(angle), 0, -0.05}, {std::sin(angle), 0, std::cos(angle)});
  std::vector<SequenceStep> const steps = {{front, Event::transmit, n}, {back, Event::transmit, 1}};
  Sequence const s = trace_sequence(bench.world.view(), bench.ray(), steps);
  ASSERT_EQ(s.end, SequenceEnd::complete);
  Vec3 const across{std::cos(angle), 0, -std::sin(angle)};
  double const shift = -dot(s.points[1].point, across);
  auto const closed = [](double index) {
    double const sine = std::sin(angle) / index;
    return thickness * std::sin(angle) * (1 - std::cos(angle) / (index * std::sqrt(1 - sine * sine)));
  };
  EXPECT_NEAR(shift, closed(n), 1e-15);
  EXPECT_GT(std::fabs(shift - closed(1.001 * n)), 1e-15);
  EXPECT_LT(length(s.points[1].dir - bench.ray().dir), 1e-15);
  EXPECT_LT(largest_difference(s, walked(bench.world, steps)), metre);
}

}  // namespace
}  // namespace straytrace::testing
