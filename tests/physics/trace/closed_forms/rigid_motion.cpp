// SPDX-License-Identifier: BSD-3-Clause
// The couplings of a scene do not depend on its position and orientation: every shape, lit on both sides and
// facing a lit screen, at the origin and up to 40 km away (docs/theory/path_integral.md, eq. 1.7 to 1.9;
// docs/theory/sampling.md, eq. 1.14).
#include <array>

#include "support/cad_faces.hpp"
#include "support/mesh_shapes.hpp"
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_rigid_motion {
namespace {

constexpr int blocks = 32;
using Sums = std::array<double, blocks>;

// Adds up what rejoins the modes. `strict`: counts as hidden what is met 1e-9 of the way, or more, before a drawn
// point; that is more than rounding at the origin, and less far away.
struct Coupled : Silent {
  WorldView const& view;
  bool strict;
  double sum = 0;
  Coupled(WorldView const& v, bool s) : view(v), strict(s) {}
  void score(PathState const& path, Vertex const& x, std::uint32_t, std::uint32_t number, Vertex const& y, double c) {
    if (!strict || !(is_hit(number) ? aim_hidden(path, y) : line_hidden(x, y))) sum += c;
  }
  static bool aim_hidden(PathState const& path, Vertex const& y) {
    return path.hop.aim.valid() && y.leg < path.hop.aim_distance * (1 - 1e-9);
  }
  bool line_hidden(Vertex const& x, Vertex const& y) const {
    Vec3 const span = y.point - x.point;
    double const way = length(span);
    return view.occluded({x.point, (1 / way) * span, way * (1 - 1e-9)}, {x.surface, x.piece}, x.surface == y.surface);
  }
};

void light(World& world, char const* port, SurfaceId surface, Vec3 at, Vec3 travel, double radius, std::uint32_t beam) {
  Footprint lit = spot(surface, at, travel, Profile::even, radius, world.add_port(port), beam);
  lit.backoff = 0.5 * radius;  // from the near side of the surface
  lit.standing = true;         // no coupling by a single scatter
  world.add_footprint(lit);
}

// A shape, and a length over which it bends little, m.
template <class Shape>
struct Bent {
  Shape shape;
  double length;
};

// Coupling by two scatters, per block. `home`: the scene as it is drawn, with `place` for its frame.
struct Case {
  double spots = 1;     // size of what is lit; small: little spreads, and nearly all is found by connections
  bool alone = false;   // without the screen
  bool strict = false;  // see Coupled
};
template <class Shape>
Sums coupled(Bent<Shape> const& bent, Pose const& home, Pose const& place, Case which = {}) {
  Shape shape = bent.shape;
  shape.place(home);
  double const unit = std::fmin(bent.length, 0.25 * std::sqrt(shape.area()));
  SurfacePoint const p = sample_of(shape, 0.3, 0.21);
  Vec3 const n = place.direction(home.local_direction(normal_of(shape, p.point, p.piece)));
  Vec3 const at = place.point(home.local_point(p.point));
  shape.place(place);
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.5);
  SurfaceId const s = world.add_surface(shape, white, white, body, world.add_group("shape"));
  Vec3 const across = at + (0.7 * unit) * n;
  light(world, "front", s, at, -n, 0.4 * which.spots * unit, 0);
  light(world, "back", s, at, n, 0.4 * which.spots * unit, 1);
  if (!which.alone) {
    SurfaceId const screen =
        world.add_surface(disk(0, unit, {across, -n}), white, white, body, world.add_group("screen"));
    light(world, "screen", screen, across, n, 0.7 * which.spots * unit, 2);
  }
  world.limits.max_order = 1;
  prepare(world);
  WorldView const view = world.view();
  Coupled sink(view, which.strict);
  Sums sums;
  for (int b = 0; b < blocks; ++b) {
    sink.sum = 0;
    for (std::uint64_t h = 0; h < largest_block; ++h)
      trace_history(view, 1, std::uint64_t(b) * largest_block + h, sink);
    sums[std::size_t(b)] = sink.sum;
  }
  return sums;
}

SampleMean mean_of(Sums const& x) {
  double sum = 0, square = 0;
  for (double const v : x) sum += v;
  double const mean = sum / blocks;
  for (double const v : x) square += (v - mean) * (v - mean);
  return {mean, std::sqrt(square / (blocks * (blocks - 1))), blocks};
}

// Excess of `there` over `here`, relative to `here`. `paired`: the same numbers were drawn, so that paths are alike.
SampleMean excess(Sums const& here, Sums const& there, bool paired) {
  Sums more;
  for (std::size_t i = 0; i < blocks; ++i) more[i] = there[i] - here[i];
  SampleMean const a = mean_of(here), b = mean_of(there), d = mean_of(more);
  double const error = paired ? d.std_error : std::hypot(a.std_error, b.std_error);
  return {d.mean / a.mean, error / a.mean, blocks};
}

// Two of every shape.
template <class Shape>
using Two = std::array<Bent<Shape>, 2>;
auto shapes() {
  return std::tuple(
      Two<Disk>{{{disk(0, 1), 1}, {disk(0.4, 0.5), 1}}},
      Two<Cap>{{{cap(0, 0, 0.2), 1}, {cap(1 / 1683.0, 0, 0.175), 1}}},
      Two<Cylinder>{{{cylinder(1, 0, 2), 1}, {cylinder(0.5, -1500, 1500), 0.5}}},
      Two<Cone>{{{cone(0, 1, pi / 4), 0.5}, {cone(0.4, 0.5, 0.35), 0.4}}},
      Two<Sphere>{{{sphere(1), 1}, {sphere(1e-3), 1e-3}}},
      Two<Conic>{{{conic(1, -1, 0, 0.8), 0.4}, {conic(0.5, -1, 0, 0.3, 0.7), 0.4}}},
      Two<Rectangle>{{{rectangle(2, 0.7), 1}, {rectangle(0.3, 0.5, 0.1, 0.45), 1}}},
      Two<Ellipse>{{{ellipse(0.6, 0.2), 1}, {ellipse(0.5, 0.5, 0.4, 0.1), 1}}},
      Two<Polygon>{{{polygon(3, 1), 1}, {polygon(6, 0.5, 6, 0.4), 1}}},
      Two<Cuboid>{{{cuboid(1, 1, 1), 1}, {cuboid(0.2, 3, 0.7), 0.2}}},
      Two<Torus>{{{torus(1, 0.3), 0.3}, {torus(0.5, 0.01), 0.01}}},
      Two<PiercedCylinder>{{{pierced(0.5, 0, 2, 0.2, 0.7), 0.5}, {pierced(1, -1, 1, 0.3, 0.1, 8), 1}}},
      Two<SerratedCone>{{{serrated(0.4, 0.5, 0.6, 0.03, 12), 0.4}, {serrated(0.2, 1, 1.2, 0.5, 3), 0.4}}},
      Two<Zone>{{{zone(1, -0.3, 0.9), 1}, {zone(0.5, 0.1, 0.2), 0.5}}},
      Two<CutCylinder>{{{cut_cylinder(0.5, 0, 1, 0.7), 0.5}, {cut_cylinder(0.2, -0.3, -0.05, -0.4), 0.2}}},
      Two<CadFace>{{{cad_faces()[0], 1}, {cad_faces()[2], 0.4}}},
      Two<TriangleMesh>{{{mesh_of(bumpy(12, 0.2), {}, 0.1), 0.02}, {mesh_of(cube(), {}), 0.3}}});
}

template <class T>
class RigidMotion : public ::testing::Test {};
template <class... T>
auto typed(std::tuple<Two<T>...>*) -> ::testing::Types<T...>;
using Shapes = decltype(shapes());
static_assert(std::tuple_size_v<Shapes> == std::tuple_size_v<ShapeTypes>);
TYPED_TEST_SUITE(RigidMotion, decltype(typed(static_cast<Shapes*>(nullptr))));

constexpr double smallest = 0.01;  // relative change of a coupling that must be seen
constexpr double bits = 1e-3;      // left to paths that rounding sends elsewhere: a tenth of that

void expect_alike(char const* what, SampleMean excess) {
  EXPECT_LE(excess.std_error, smallest / 8) << what << ": blind";
  EXPECT_LE(std::fabs(excess.mean), 5 * excess.std_error + bits) << what;
  EXPECT_GT(std::fabs(excess.mean + smallest), 5 * excess.std_error + bits) << what << ": 1 % more would pass";
}

TYPED_TEST(RigidMotion, LeavesCouplingsAlike) {
  Vec3 const along{0, 0, 1}, turned = unit({0.3, -0.5, 0.7});
  Pose const home = facing_along({}, along), home_turned = facing_along({}, turned);
  for (Two<TypeParam> const two = std::get<Two<TypeParam>>(shapes()); Bent<TypeParam> const& shape : two) {
    Sums const here = coupled(shape, home, home), here_turned = coupled(shape, home, home_turned);
    Pose const at_3_km = facing_along({0, 0, 3000}, along), at_40_km = facing_along({-2.1e4, 2.5e4, 2.3e4}, turned);
    expect_alike("3 km away", excess(here, coupled(shape, home, at_3_km), true));
    expect_alike("40 km away", excess(here_turned, coupled(shape, home, at_40_km), true));
    Case const small{0.2};
    expect_alike("turned", excess(coupled(shape, home, home, small), coupled(shape, home, home_turned, small), false));
  }
}

// The light that a mirror of 60 m radius of curvature sends to itself is lost in part where rounding hides points.
TEST(RigidMotionControl, PointsHiddenByRoundingAreMissedEq1_14) {
  Bent<Cap> const mirror{cap(1 / 60.0, 0, 0.2), 1};
  Pose const home = facing_along({}, {0, 0, 1}), away = facing_along({0, 0, 40000}, {0, 0, 1});
  Sums const here = coupled(mirror, home, home, {3, true});
  expect_alike("all points", excess(here, coupled(mirror, home, away, {3, true}), true));
  SampleMean const lost = excess(here, coupled(mirror, home, away, {3, true, true}), true);
  EXPECT_LT(lost.mean, -smallest - 5 * lost.std_error);
}

}  // namespace
}  // namespace straytrace::testing::trace_rigid_motion
