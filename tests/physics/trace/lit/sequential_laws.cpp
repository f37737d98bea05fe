// SPDX-License-Identifier: BSD-3-Clause
// Sequential tracing and the walk against closed forms.
#include "physics/trace/lit/trace_bench.hpp"

namespace straytrace::testing {
namespace {

// R3.23: 43.602 deg for n = 1.45003, everything reflected beyond. Control: index 1.4496.
TEST(SequentialLaws, CriticalAngle) {
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
      evaluate_scattering(bench.world.view(), path, ray.dir, v);
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
// are 2 R apart. Control: a radius that is 1e-9 larger. At the limit of orders all power is booked.
TEST(SequentialLaws, PipeOfAMillionBounces) {
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
    void book(BalanceTerm balance_term, double power) {
      if (balance_term == BalanceTerm::truncated) limit += power;
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

// R3.22: angle in = angle out to 1e-15, in the plane of incidence. Control: a normal 1e-14 rad off.
TEST(SequentialLaws, ReflectionKeepsTheAngle) {
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

// Plane-parallel plate: shift t sin a (1 - cos a/(n cos b)), direction kept. Control: index 0.1 % off.
TEST(SequentialLaws, ShiftOfAPlate) {
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
