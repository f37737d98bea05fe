// SPDX-License-Identifier: BSD-3-Clause
// A beam lights what of a surface it meets first, on the side from which it comes: light rejoins it there, through the
// surface where that lets light through, and nowhere in its shadow (docs/theory/path_integral.md, eq. 1.1, 1.7;
// docs/theory/sampling.md).
#include "support/mesh_shapes.hpp"
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_lit_side {
namespace {

constexpr double lambda = 1.064e-6;

// Light that rejoins the footprint `lit`. Control: as if a beam lit both sides of a surface.
struct Rejoined : Silent {
  WorldView const& view;
  std::uint32_t lit;
  double sum = 0, everywhere = 0;
  Rejoined(WorldView const& v, std::uint32_t l) : view(v), lit(l) {}
  void visit(PathState const& path, Vertex const& y) {
    Footprint const& f = view.lit[lit];
    if (y.surface == f.surface)
      everywhere +=
          path.power * rejoin_bsdf(view, y, f) * accepted(view, f) * connection_density(f, y.point, y.frame.e3);
  }
  void score(PathState const&, Vertex const&, std::uint32_t index, std::uint32_t, Vertex const&, double coupling) {
    if (index == lit) sum += coupling;
  }
};

struct Spots {
  SurfaceId from, to;   // what emits, what receives
  Vec3 from_at, to_at;  // chief rays meet them there
  Vec3 from_travel, to_travel;
  double radius;
};
// Per history, of light that the first spot scatters.
Rejoined rejoined(World& world, WorldView& view, Spots const& spots, std::uint64_t histories,
                  std::function<void(double)> const& after = {}) {
  Footprint from = spot(spots.from, spots.from_at, spots.from_travel, Profile::even, spots.radius);
  Footprint to = spot(spots.to, spots.to_at, spots.to_travel, Profile::even, spots.radius, world.add_port("port"), 1);
  from.backoff = to.backoff = 2 * spots.radius;
  to.emits = false;
  world.limits.window = false;  // nothing to aim at is worth splitting for
  world.add_footprint(from);
  world.add_footprint(to);
  prepare(world);
  view = world.view();
  Rejoined sink(view, 1);
  double before = 0;
  walk(world, histories, sink, [&] {
    if (after) after(sink.sum - before);
    before = sink.sum;
  });
  return sink;
}

// A closed, opaque body that is white inside and outside, lit from outside along -n at a point of it, and from inside
// along n: light inside couples zero into the beam outside.
template <class Shape>
void expect_dark_inside(char const* what, Shape shape, double radius) {
  shape.place(facing_along({1, 2, 3}, unit({0.3, -0.5, 0.7})));
  SurfacePoint const p = sample_of(shape, 0.3, 0.21);
  Vec3 const n = normal_of(shape, p.point, p.piece);
  World world;
  std::uint32_t const white = lambertian_optic(world, 0.9);
  SurfaceId const s = world.add_surface(shape, white, white, world.add_body("body", {}), world.add_group("body"));
  WorldView view;
  Rejoined const r = rejoined(world, view, {s, s, p.point, p.point, n, -n, radius}, 20000);
  EXPECT_LT(r.sum, 1e-12 * r.everywhere) << what;  // faces along the beam are lit by a rounding
  EXPECT_GT(r.everywhere, 1e3 * lambda * lambda) << what << ": blind";
}

TEST(LitSide, LightInsideOpaqueBodiesRejoinsNoBeamOutsideEq1_7) {
  expect_dark_inside("sphere", sphere(0.5), 0.1);
  expect_dark_inside("box", cuboid(1, 1, 1), 0.1);
  expect_dark_inside("torus", torus(1, 0.3), 0.05);
  expect_dark_inside("bumpy mesh", mesh_of(bumpy(12, 0.05), {}, 0.1), 0.01);
  expect_dark_inside("cube of triangles", mesh_of(cube(), {}), 0.1);
}

// A tube closed by two lids, lit on its wall.
TEST(LitSide, LightInsideAClosedTubeRejoinsNoBeamOutsideEq1_7) {
  World world;
  std::uint32_t const white = lambertian_optic(world, 0.9);
  BodyId const body = world.add_body("tube", {});
  GroupId const group = world.add_group("tube");
  SurfaceId const wall = world.add_surface(cylinder(0.5, -1, 1), white, white, body, group);
  for (double const z : {-1.0, 1.0}) world.add_surface(disk(0, 0.5, {{0, 0, z}, {0, 0, 1}}), white, white, body, group);
  WorldView view;
  Vec3 const x{1, 0, 0}, at{0.5, 0, 0.1};
  Rejoined const r = rejoined(world, view, {wall, wall, at, at, x, -x, 0.05}, 20000);
  EXPECT_EQ(r.sum, 0);
  EXPECT_GT(r.everywhere, 0) << "blind";
}

// A sphere lights its own wall evenly, with rho/(4 pi R^2) of the light scattered by any point of it. Of that, the lit
// area of a translucent wall sends lambda^2 tau/pi into the beam outside, whatever the shape of the spot. Control: with
// the wall across, which the beam would light if it came through, and which reflects.
TEST(LitSide, LightPassesATranslucentSphereEq1_7) {
  constexpr double rho = 0.5, tau = 0.3, radius = 0.4;
  World world;
  Optic wall;
  wall.laws = 2;
  wall.law[0] = world.add_law(Lambertian{rho});
  wall.law[1] = world.add_law(Lambertian{tau});
  wall.through[1] = true;
  std::uint32_t const optic = world.add_optic(wall);
  SurfaceId const s =
      world.add_surface(sphere(radius), optic, optic, world.add_body("ball", {}), world.add_group("ball"));
  world.limits.max_order = 1;
  Vec3 const at{0, 0, radius}, n{0, 0, 1};
  WorldView view;
  std::vector<double> each;
  Rejoined const r =
      rejoined(world, view, {s, s, at, at, n, -n, 0.3 * radius}, 1 << 17, [&](double c) { each.push_back(c); });
  double sum = 0, square = 0;
  for (double const c : each) sum += c;
  double const count = double(each.size()), mean = sum / count;
  for (double const c : each) square += (c - mean) * (c - mean);
  SampleMean const got{mean, std::sqrt(square / (count * (count - 1))), (long long)each.size()};
  double const unit = lambda * lambda * rho / (4 * pi * pi * radius * radius);
  expect_mean("through the wall", got, unit * tau, 0.03 * unit * tau);
  expect_rejected("and from the wall across", got, unit * (tau + rho));
  EXPECT_NEAR(r.everywhere / count, unit * (tau + rho), 0.1 * unit * (tau + rho)) << "the control";
}

// Small spots of a screen and of a sphere that face each other couple by lambda^2 (rho/pi)^2/d^2 (eq. 1.2 with both
// cosines 1), as if the sphere ended at its equator; a screen behind the sphere gives nothing.
TEST(LitSide, TheLitSideOfASphereTakesItsLightEq1_7) {
  constexpr double rho = 0.5, radius = 0.1, away = 1;
  double const expected = lambda * lambda * (rho / pi) * (rho / pi) / (away * away);
  for (bool const facing : {true, false}) {
    World world;
    std::uint32_t const white = lambertian_optic(world, rho);
    BodyId const body = world.add_body("all", {});
    SurfaceId const ball = world.add_surface(sphere(radius), white, white, body, world.add_group("ball"));
    Vec3 const out{0, 0, facing ? 1.0 : -1.0}, at = (radius + away) * out;
    SurfaceId const screen =
        world.add_surface(disk(0, 0.05, {at, -out}), white, white, body, world.add_group("screen"));
    world.limits.max_order = 1;
    WorldView view;
    Rejoined const r = rejoined(world, view, {screen, ball, at, {0, 0, radius}, out, {0, 0, -1}, 2e-3}, 20000);
    EXPECT_NEAR(r.sum / 20000, facing ? expected : 0, facing ? 1e-2 * expected : 0);
  }
}

}  // namespace
}  // namespace straytrace::testing::trace_lit_side
