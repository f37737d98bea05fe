// SPDX-License-Identifier: BSD-3-Clause
// Gratings (docs/theory/surfaces.md, eq. 3.26 to 3.28; R2.28): directions of the orders, shares of the light, phase
// under motion, and the beam tree in Littrow's mount.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "support/ghost_support.hpp"
#include "support/trace_support.hpp"
#include "trace/tally/replay.hpp"
#include "world/model/diffraction.hpp"

namespace straytrace::testing::gratings {
namespace {

constexpr double wavelength = 1.064e-6;

std::uint32_t grating_optic(World& world, double density, std::vector<GratingOrder> const& orders) {
  Grating grating;
  grating.density = density;
  grating.turn = density * world.wavelength;
  for (GratingOrder const& o : orders) grating.order[grating.count++] = o;
  Optic optic;
  optic.has_interface = optic.diffracts = true;
  optic.interface = world.add_interface(grating);
  optic.lay = Lay::given;
  optic.lay_direction = {0, 1, 0};
  return world.add_optic(optic);
}

// A grating in the plane z = 0 that faces +z, with its grooves along y; in vacuum, or on glass.
struct Bench {
  World world;
  SurfaceId id;
  Bench(double density, std::vector<GratingOrder> const& orders, double glass = 1) {
    std::uint32_t const optic = grating_optic(world, density, orders);
    std::uint32_t const volume = glass > 1 ? world.add_volume({glass, 0}) : Surface::none;
    id = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, optic, optic, world.add_body("grating", {}),
                           world.add_group("grating"), volume);
    world.finish();
  }
  // The order of that number for light along `travel`; `share` 0: it does not propagate.
  SpecularWay order(Vec3 travel, int number, bool through = false) const {
    WorldView const view = world.view();
    Vertex v = make_vertex(view, id, {}, travel);
    MediaStack media;
    if (!v.front && world.surfaces()[id.value].volume != Surface::none) media.enter(0);
    find_media(view, media, travel, v);
    SpecularWay found;
    for_each_order(view, v, travel, through, [&](SpecularWay const& way) {
      if (way.order == number) found = way;
    });
    return found;
  }
};

std::vector<GratingOrder> both_sides(int most) {
  std::vector<GratingOrder> all;
  for (int m = -most; m <= most; ++m) all.push_back({double(m), 0.05, 0.05});
  return all;
}

// Eq. 3.26, R2.28: 1e5 lines per metre turn light at normal incidence by 0.10660 rad; 0.1 rad belongs to 9.383e4 /m.
TEST(Gratings, grating_equation_r2_28) {
  Bench const bench(1e5, both_sides(1));
  Vec3 const out = bench.order({0, 0, -1}, 1).out;
  EXPECT_NEAR(std::asin(out.x), 0.10660, 5e-6);
  EXPECT_NEAR(std::sin(0.1) / wavelength, 9.383e4, 5);
  EXPECT_GT(out.z, 0);
  EXPECT_NEAR(bench.order({0, 0, -1}, -1).out.x, -out.x, 1e-15);
  EXPECT_GT(std::fabs(std::asin(Bench(9.383e4, both_sides(1)).order({0, 0, -1}, 1).out.x) - 0.10660), 5e-6);
}

// Eq. 3.27: n times the direction along the surface changes by m lambda f across the grooves, in conical mount and into
// glass as well; every way is its own way back.
TEST(Gratings, conical_orders_and_their_reverse) {
  Bench const bench(4e5, both_sides(3), 1.45);
  int seen = 0;
  for (Vec3 const travel : {unit(Vec3{0.3, 0.2, -1}), unit(Vec3{-0.5, 0.7, -0.6}), unit(Vec3{0.1, -0.4, 1})}) {
    double const n_in = travel.z < 0 ? 1 : 1.45;
    for (int m = -3; m <= 3; ++m)
      for (bool const through : {false, true}) {
        SpecularWay const way = bench.order(travel, m, through);
        double const n_out = through ? 2.45 - n_in : n_in;
        double const x = (n_in * travel.x + m * wavelength * 4e5) / n_out, y = n_in * travel.y / n_out;
        EXPECT_EQ(way.share > 0, x * x + y * y < 1);
        if (!(way.share > 0)) continue;
        ++seen;
        EXPECT_NEAR(way.out.x, x, 1e-14);
        EXPECT_NEAR(way.out.y, y, 1e-14);
        EXPECT_NEAR(length(way.out), 1, 1e-15);
        EXPECT_EQ(way.out.z * travel.z > 0, through);
        SpecularWay const back = bench.order(-way.out, m, through);
        EXPECT_LT(length(back.out + travel), 1e-14);
        EXPECT_EQ(back.share, way.share);
        if (m != 0) {  // control
          EXPECT_GT(length(bench.order(-way.out, -m, through).out + travel), 0.1);
        }
      }
  }
  EXPECT_GT(seen, 20);
}

// An order that does not propagate is absorbed: order 1 of 1.2e6 /m at normal incidence is evanescent.
TEST(Gratings, evanescent_orders_are_absorbed) {
  auto const escaped = [](double density) {
    World world;
    std::uint32_t const optic = grating_optic(world, density, {{0, 0.2, 0}, {1, 0.7, 0}});
    world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, optic, optic, world.add_body("grating", {}), world.add_group("g"));
    world.add_footprint(free_beam(world.add_group("beam"), {0, 0, 1}, {0, 0, -1}, Profile::gaussian, 1e-3));
    world.finish();
    struct Books : Silent {
      double escaped = 0, absorbed = 0;
      void book(BalanceTerm term, double power) {
        if (term == BalanceTerm::escaped) escaped += power;
        if (term == BalanceTerm::absorbed) absorbed += power;
      }
    } books;
    walk(world, 100, books, [] {});
    EXPECT_NEAR(books.escaped + books.absorbed, 100, 1e-9);
    return books.escaped / 100;
  };
  EXPECT_NEAR(escaped(1.2e6), 0.2, 1e-12);
  EXPECT_NEAR(escaped(0.8e6), 0.9, 1e-12);
}

// The walk takes each order as often as its efficiency says: chi-square of three orders, control with other shares.
TEST(Gratings, walk_draws_orders_by_their_efficiency) {
  World world;
  std::uint32_t const optic = grating_optic(world, 3e5, {{0, 0.2, 0}, {1, 0.5, 0}, {-1, 0, 0.3}});
  world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, optic, optic, world.add_body("grating", {}), world.add_group("g"));
  std::uint32_t const black = black_optic(world);
  for (double const z : {-1.0, 1.0})
    world.add_surface(Disk{{0, 0, z}, {0, 0, 1}, 0, 5}, black, black, world.add_body("wall", {}), world.add_group("w"));
  world.add_footprint(free_beam(world.add_group("beam"), {0, 0, 0.5}, {0, 0, -1}, Profile::gaussian, 1e-3));
  world.finish();
  struct Ends : Silent {
    std::array<double, 3> count{};
    void visit(PathState const& path, Vertex const& v) {
      if (path.order != 2) return;
      count[v.point.z < 0 ? 2 : path.ray.dir.x > 0.1 ? 1 : 0] += 1;
      EXPECT_EQ(path.hop.left_by, v.point.z < 0 || path.ray.dir.x > 0.1 ? Event::diffract : Event::reflect);
    }
  } ends;
  constexpr double histories = 20000;
  walk(world, std::uint64_t(histories), ends, [] {});
  auto const distance = [&](std::array<double, 3> share) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
      sum += std::pow(ends.count[i] - histories * share[i], 2) / (histories * share[i]);
    return sum;
  };
  EXPECT_LT(distance({0.2, 0.5, 0.3}), 20.8);     // 3 sigma to the fifth power: one in 30 000, 2 degrees of freedom
  EXPECT_GT(distance({0.22, 0.49, 0.29}), 20.8);  // control
}

// Phase of the light from a to b by order m of a grating in the frame `at`: k |ap| + k |pb| + 2 pi m f u with u across
// the grooves, stationary in the point p (eq. 3.28).
double phase_by_fermat(Vec3 a, Vec3 b, Pose const& at, int m, double density, Vec3& p) {
  double const k = 2 * pi / wavelength;
  double u = 0, v = 0;
  auto const slope = [&](double x, double y) {
    Vec3 const q = at.point({x, y, 0});
    Vec3 const along = unit(q - a) - unit(b - q);
    return std::array{dot(along, at.e1) + m * density * wavelength, dot(along, at.e2)};
  };
  for (int i = 0; i < 30; ++i) {  // Newton's method; the slope over k
    constexpr double h = 1e-5;
    auto const s = slope(u, v), su = slope(u + h, v), sv = slope(u, v + h);
    double const aa = (su[0] - s[0]) / h, ab = (sv[0] - s[0]) / h, ba = (su[1] - s[1]) / h, bb = (sv[1] - s[1]) / h;
    double const determinant = aa * bb - ab * ba;
    u -= (bb * s[0] - ab * s[1]) / determinant;
    v -= (aa * s[1] - ba * s[0]) / determinant;
  }
  p = at.point({u, v, 0});
  return k * (length(p - a) + length(b - p)) + 2 * pi * m * density * u;
}

Pose turned(Pose const& p, int axis, double angle) {
  double const c = std::cos(angle), s = std::sin(angle);
  Vec3 const e[3] = {p.e1, p.e2, p.e3};
  int const i = (axis + 1) % 3, j = (axis + 2) % 3;
  Vec3 f[3] = {e[0], e[1], e[2]};
  f[i] = c * e[i] + s * e[j];
  f[j] = c * e[j] - s * e[i];
  return {p.origin, f[0], f[1], f[2]};
}

// Eq. 2.3 holds at a grating with the directions of its order: all six coordinates against the derivative of eq. 3.28,
// and along the surface in closed form, - 2 pi m f. Control: light reflected in order 0, which does not feel that
// motion.
TEST(Gratings, phase_under_motion) {
  constexpr double density = 3e5;
  Vec3 const a{-0.3, 0.1, 1}, b{0.9, -0.2, 1.2};
  for (int const m : {0, 1, -2}) {
    Vec3 p;
    phase_by_fermat(a, b, {}, m, density, p);
    Bench const bench(density, both_sides(2));
    Vec3 const in = unit(p - a), out = unit(b - p);
    EXPECT_LT(length(bench.order(in, m).out - out), 1e-10);
    World world;
    std::uint32_t const black = black_optic(world);
    SurfaceId const id = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, black, black, world.add_body("g", {0, 0, 0}),
                                           world.add_group("g"));
    world.add_footprint(spot(id, {}, {0, 0, -1}, Profile::gaussian, 1e-3));
    world.finish();
    std::vector<PassedVertex> const hits{{id, p, in, out}};
    PhaseSensitivity const found = phase_sensitivities_of(world, hits, 0, 0).at(0);
    for (int c = 0; c < 6; ++c) {
      double const step = c < 3 ? 1e-6 : 1e-7;
      auto const moved = [&](double x) {
        Pose at;
        if (c < 3)
          (&at.origin.x)[c] = x;
        else
          at = turned(at, c - 3, x);
        Vec3 q;
        return phase_by_fermat(a, b, at, m, density, q);
      };
      double const expected = (moved(step) - moved(-step)) / (2 * step);
      EXPECT_NEAR(found.d[c], expected, 2e-4 * 2 * pi / wavelength) << "order " << m << ", coordinate " << c;
    }
    EXPECT_NEAR(found.d[0], -2 * pi * m * density, 1e-3);
    if (m != 0) {
      EXPECT_GT(std::fabs(found.d[0]), 1e6);
    }
  }
}

// Littrow's mount: 2 sin(theta) = lambda f returns order -1 into the beam, with its efficiency as recoupled power where
// the wavefront is flat, and 2 k sin(theta) of phase per displacement across the grooves. Control: 1 mrad off.
TEST(Gratings, littrow_returns_into_the_beam) {
  auto const returned = [](double angle) {
    double const sine = std::sin(0.4), density = 2 * sine / wavelength;
    Bench bench(density, {{0, 0.8, 0}, {-1, 0.1, 0}});
    BeamLaunch launch = launched(bench.world, 5e-3, {-0.1 * std::sin(angle), 0, 0.1 * std::cos(angle)},
                                 {std::sin(angle), 0, -std::cos(angle)});
    MainBeam const main(bench.world, launch, {});
    Rows rows(&main);
    grow_tree(bench.world, launch, {}, rows);
    EXPECT_EQ(rows.all.size(), 2u);
    for (Row const& row : rows.all) {
      if (row.order == 0) continue;
      EXPECT_NEAR(row.power, 0.1, 1e-15);
      EXPECT_TRUE(row.standing.against);
      auto const levers = main.phase_sensitivities(row.standing.recoupled, row.way);
      if (!levers.empty()) {
        EXPECT_NEAR(levers[0].d[0], 2 * pi * density, 1e-3);
      }
      return row.standing.recoupled.share();
    }
    return 0.0;
  };
  EXPECT_NEAR(returned(0.4), 0.1, 1e-6);  // the Rayleigh range is 74 m
  EXPECT_LT(returned(0.401), 1e-4);
}

// A grating stretches a beam across the grooves by cos(theta_out)/cos(theta_in), and not along them.
TEST(Gratings, anamorphic_magnification) {
  double const angle = 0.5;
  Bench const bench(6e5, both_sides(1));
  Vec3 const travel{std::sin(angle), 0, -std::cos(angle)}, out = bench.order(travel, -1).out;
  Mode const in = elliptic_mode({}, {0, 1, 0}, travel, {5e-3, 5e-3}, {0, 0}, wavelength);
  Mode const after = diffracted(in, out, {0, 0, 1}, SurfaceCurvature::uniform({0, 0, 1}, 0), 1, 1);
  Spot const s = spot(after);
  double const stretched = 5e-3 * out.z / std::cos(angle);
  EXPECT_NEAR(std::fmax(s.major, s.minor), std::fmax(stretched, 5e-3), 1e-12);
  EXPECT_NEAR(std::fmin(s.major, s.minor), std::fmin(stretched, 5e-3), 1e-12);
  EXPECT_GT(std::fabs(stretched - 5e-3), 1e-4);  // control: a mirror keeps it
}

}  // namespace
}  // namespace straytrace::testing::gratings
