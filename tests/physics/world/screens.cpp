// SPDX-License-Identifier: BSD-3-Clause
// Screens next to the chief ray of a followed beam: the light that they take (docs/theory/beams.md, eq. 5.5, 5.6;
// R2.26).
#include <gtest/gtest.h>

#include "beams/overlap.hpp"
#include "support/beams_support.hpp"
#include "support/ghost_support.hpp"
#include "support/shapes.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::testing::world_screens {
namespace {

constexpr double w = 5e-3;

// Screens with holes about z, and a black plate behind them.
struct Hole {
  double radius = w, offset = 0, z = 0, tilt = 0;
};
World with_holes(std::vector<Hole> const& holes, double plate = 1) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const black = black_optic(world);
  BodyId const body = world.add_body("all", {});
  for (Hole const& h : holes)
    world.add_surface(disk(h.radius, 1, {{h.offset, 0, h.z}, {std::sin(h.tilt), 0, -std::cos(h.tilt)}}), black, black,
                      body, world.add_group("screen " + std::to_string(world.groups().size())));
  world.add_surface(disk(0, plate, {{0, 0, 1}, {0, 0, -1}}), black, black, body, world.add_group("plate"));
  world.finish();
  return world;
}
BeamEnergyBalance energy_balance_of(World const& world, BeamLaunch const& launch) {
  BeamEnergyBalance energy_balance;
  rows(world, launch, {1e-15}, &energy_balance);
  return energy_balance;
}
BeamEnergyBalance energy_balance_of(std::vector<Hole> const& holes, double plate = 1) {
  World const world = with_holes(holes, plate);
  return energy_balance_of(world, launched(world, w));
}
double taken(BeamEnergyBalance const& energy_balance, std::size_t object) {
  return energy_balance.objects[object].landed;
}

// The waist is 1 m before the hole; z_R = 73.8 m, so w is 1.00009 times as large there.
double const there = w * std::sqrt(1 + std::pow(lambda / (pi * w * w), 2));

TEST(Screens, holes_transmit_the_share_of_eq_5_5) {
  for (auto [radius, passed] : {std::pair{there, 0.86466}, {pi * there / 2, 0.99281}}) {
    BeamEnergyBalance const energy_balance = energy_balance_of({{radius}});
    EXPECT_NEAR(1 - taken(energy_balance, 0), passed, 5e-6);
    EXPECT_NEAR(taken(energy_balance, 1), 1 - taken(energy_balance, 0), 1e-12);
    EXPECT_NEAR(energy_balance.total(), 1, 1e-12);
  }
  EXPECT_NEAR(taken(energy_balance_of({{2.5 * there}}), 0) / 3.7267e-6, 1, 1e-4);
  EXPECT_EQ(taken(energy_balance_of({{6 * there}}), 0), 0);
  EXPECT_GT(std::fabs(taken(energy_balance_of({{there / 2}}), 0) - std::exp(-2.0)),
            0.1);  // control: a diameter for a radius
}

TEST(Screens, holes_off_the_beam_by_eq_5_6) {
  for (double offset : {0.1 * w, 0.6 * w, 1.3 * w}) {
    double const exact = clipped_share(1.5 * w, there, offset);
    EXPECT_NEAR(taken(energy_balance_of({{1.5 * w, offset}}), 0) / exact, 1, 1e-9);
    EXPECT_GT(std::fabs(clipped_share(1.5 * w, there) / exact - 1), 0.01);  // control: centred
  }
}

// Turned by 60 degrees the hole is half as wide for the beam.
TEST(Screens, tilted_holes) {
  BeamEnergyBalance const energy_balance = energy_balance_of({{2 * w, 0, 0, pi / 3}});
  Mode const mode = circular_mode({0, 0, -1}, {0, 0, 1}, w, 0, lambda);
  double const exact = clipped_share(Aperture{{}, {std::sin(pi / 3), 0, -0.5}, 2 * w}, mode);
  EXPECT_NEAR(taken(energy_balance, 0) / exact, 1, 1e-6);
  EXPECT_GT(std::fabs(clipped_share(2 * w, there) / exact - 1), 0.5);  // control: as across the beam
}

// Each line is taken once on one flight: equal holes in a row clip once, a smaller one behind takes the rest.
TEST(Screens, holes_in_a_row_take_each_line_once) {
  double const one = std::exp(-2 * 1.44), two = std::exp(-2.0);
  BeamEnergyBalance const equal = energy_balance_of({{1.2 * there, 0, 0}, {1.2 * there, 0, 1e-3}});
  EXPECT_NEAR(taken(equal, 0), one, 1e-5);
  EXPECT_LT(taken(equal, 1), 1e-6);
  BeamEnergyBalance const smaller =
      energy_balance_of({{there, 0, 1e-3}, {1.2 * there, 0, 0}});  // the order of the list is another
  EXPECT_NEAR(taken(smaller, 1), one, 1e-5);
  EXPECT_NEAR(taken(smaller, 0), two - one, 1e-5);
  EXPECT_NEAR(taken(smaller, 0) + taken(smaller, 1) + taken(smaller, 2), 1, 1e-12);
  EXPECT_GT(std::fabs((1 - one) * two - (two - one)), 0.04);  // control: the second sees a whole Gaussian
  // ...and the light that misses the plate is the light that no screen took.
  BeamEnergyBalance const plate = energy_balance_of({{1.2 * there}}, there);
  EXPECT_NEAR(taken(plate, 0), one, 1e-5);
  EXPECT_NEAR(plate.objects[1].beside, two - one, 2e-4);  // w grows by 2e-4 to there
  EXPECT_NEAR(taken(plate, 1), 1 - two, 2e-4);
}

// The part cut by the edge of a surface is dark on the flight from it: a second lens of one size, and the
// mount behind it, take nothing more. Control: each of them sees a whole Gaussian.
TEST(Screens, are_shadowed_by_the_surface_left) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const glass = coated(world, 0), black = black_optic(world);
  BodyId const body = world.add_body("all", {});
  for (double z : {0.0, 0.01})
    world.add_surface(disk(0, there, {{0, 0, z}, {0, 0, -1}}), glass, glass, body, world.add_group("lens"));
  world.add_surface(disk(1.001 * there, 1, {{0, 0, 0.02}, {0, 0, -1}}), black, black, body, world.add_group("mount"));
  world.finish();
  BeamEnergyBalance const energy_balance = energy_balance_of(world, launched(world, w));
  EXPECT_NEAR(energy_balance.objects[0].beside, std::exp(-2.0), 1e-4);
  EXPECT_LT(taken(energy_balance, 1), 1e-4);
  EXPECT_NEAR(energy_balance.escaped, 1 - std::exp(-2.0), 1e-4);
  EXPECT_GT(std::fabs(energy_balance.escaped - std::pow(1 - std::exp(-2.0), 3)), 0.1);
}

// Any object at any place off the chief ray: against lines drawn from the beam, each to the first thing that it meets.
struct Clutter {
  World world;
  std::uint32_t black = 0;
  BodyId body;
  Clutter() {
    world.wavelength = lambda;
    black = black_optic(world);
    body = world.add_body("all", {});
  }
  template <class Shape>
  void add(Shape shape, Vec3 at, Vec3 facing) {
    shape.place(facing_along(at, unit(facing)));
    world.add_surface(shape, black, black, body, world.add_group(std::to_string(world.surfaces().size())));
  }
};
World clutter(double tilt) {
  Clutter c;
  c.add(disk(3 * w, 20 * w, {}), {w, 0, 0.2}, {0.3, 0, -1});
  Rectangle plate;
  plate.width = plate.height = 8 * w;
  c.add(plate, {4.6 * w, w, 0.3}, {1, 0.2, -1});
  Cuboid box;
  box.width = box.height = box.depth = 3 * w;
  c.add(box, {-0.5 * w, 2.4 * w, 0.4}, {0.2, 0.1, 1});
  Cylinder post;
  post.radius = w;
  post.from = -0.1;
  post.to = 0.1;
  c.add(post, {0, -2.1 * w, 0.5}, {1, 0, 0.1});
  Sphere ball;
  ball.radius = 0.6 * w;
  c.add(ball, {-1.5 * w, -0.6 * w, 0.6}, {0, 0, 1});
  Polygon blade;
  blade.sides = 5;
  blade.radius = 6 * w;
  blade.hole_radius = 2 * w;
  c.add(blade, {0.2 * w, 0, 0.85}, {std::sin(tilt), 0, -std::cos(tilt)});
  c.add(disk(0, 1.8 * w, {}), {0, 0, 0.9}, {std::sin(tilt), 0, -std::cos(tilt)});
  c.world.finish();
  return std::move(c.world);
}
TEST(Screens, any_shapes_against_drawn_lines) {
  constexpr int lines = 400000;
  for (double tilt : {0.0, 0.7}) {
    World const world = clutter(tilt);
    BeamEnergyBalance const energy_balance = energy_balance_of(world, launched(world, 2 * w));
    std::vector<double> met(world.surfaces().size() + 1);
    Dice dice(1);
    for (int i = 0; i < lines; ++i) {
      double const rho = 2 * w * std::sqrt(-0.5 * std::log(dice.between(0, 1))), phi = dice.between(0, 2 * pi);
      Hit const hit = world.view().closest({{rho * std::cos(phi), rho * std::sin(phi), -1}, {0, 0, 1}}, {});
      ++met[hit.surface.valid() ? hit.surface.value : world.surfaces().size()];
    }
    double elsewhere = 0, swapped = 0;
    for (std::size_t i = 0; i < world.surfaces().size(); ++i) {
      double const found = taken(energy_balance, i), drawn = met[i] / lines;
      elsewhere += energy_balance.objects[i].beside;
      EXPECT_NEAR(found, drawn, 5 * std::sqrt(drawn / lines) + 2e-3 * drawn) << i << ' ' << tilt;
      swapped += std::fabs(taken(energy_balance, i) - met[(i + 1) % world.surfaces().size()] / lines);
    }
    EXPECT_NEAR(elsewhere, met.back() / lines, 5 * std::sqrt(met.back()) / lines + 2e-3);
    EXPECT_GT(swapped, 0.1);  // control: booked under the name of the neighbour
  }
}

// Objects narrower than the beam and far from its axis are found: a ring of wire, a ball.
TEST(Screens, small_things_are_found) {
  Clutter c;
  c.add(torus(3e-3, 0.35e-3), {0, 0, 0}, {0, 0, 1});
  c.world.finish();
  auto const beyond = [](double r) { return std::exp(-2 * r * r / (there * there)); };
  EXPECT_NEAR(taken(energy_balance_of(c.world, launched(c.world, w)), 0) / (beyond(2.65e-3) - beyond(3.35e-3)), 1,
              1e-3);
  for (double turn : {0.0, 0.13, 0.3, 0.44}) {
    Clutter far;
    Vec3 const at{w * std::cos(2 * pi * turn), w * std::sin(2 * pi * turn), 0};
    far.add(sphere(1.3e-3), at, {0, 0, 1});
    far.world.finish();
    Mode const mode = circular_mode({0, 0, -1}, {0, 0, 1}, w, 0, lambda);
    double const exact = 1 - clipped_share(Aperture{at, {0, 0, -1}, 1.3e-3}, mode);
    EXPECT_NEAR(taken(energy_balance_of(far.world, launched(far.world, w)), 0) / exact, 1, 0.02) << turn;
  }
}

// A tube around a beam that spreads takes what is wider than its far end (eq. 5.5). Control: lines parallel to the
// chief ray from the near end, which take nothing.
TEST(Screens, tubes_around_a_beam_that_spreads) {
  Clutter c;
  c.add(cylinder(10e-3, 0, 99), {0, 0, 0}, {0, 0, 1});
  c.add(disk(0, 1, {}), {0, 0, 100}, {0, 0, -1});
  c.world.finish();
  double const waist = 1e-3, z = 100, wide = waist * std::sqrt(1 + std::pow(z * lambda / (pi * waist * waist), 2));
  EXPECT_NEAR(taken(energy_balance_of(c.world, launched(c.world, waist)), 0) / std::exp(-2 * 1e-4 / (wide * wide)), 1,
              1e-5);
  EXPECT_LT(std::exp(-2 * 1e-4 / (waist * waist)), 1e-80);
}

// A ball whose front lies before a ring is lit, whichever of them is listed first. Control: the first of the
// list takes what both cover.
TEST(Screens, each_line_ends_where_it_meets_first) {
  double share[2];
  for (int first : {0, 1}) {
    Clutter c;
    for (int i : {first, 1 - first})
      i == 0 ? c.add(disk(1e-3, 10e-3, {}), {0, 0, 0}, {0, 0, -1}) : c.add(sphere(4e-3), {6e-3, 0, 0}, {0, 0, 1});
    c.world.finish();
    share[first] = taken(energy_balance_of(c.world, launched(c.world, w)), 1 - first);
  }
  Mode const mode = circular_mode({0, 0, -1}, {0, 0, 1}, w, 0, lambda);
  double const exact = 1 - clipped_share(Aperture{{6e-3, 0, 0}, {0, 0, -1}, 4e-3}, mode);
  EXPECT_NEAR(share[0] / exact, 1, 0.01);
  EXPECT_EQ(share[0], share[1]);
  EXPECT_GT(exact, 0.1);
}

// The light on a lit screen: drawn lines carry the power of the energy balance, and none of them falls into the hole.
class Touched final : public BeamSink {
 public:
  void screened(ScreenSpot const& spot, std::span<BeamStep const> way) override {
    all.push_back(spot);
    ways.emplace_back(way.begin(), way.end());
  }
  std::vector<ScreenSpot> all;
  std::vector<std::vector<BeamStep>> ways;
};
double drawn_on(World const& world, Footprint const& f, int lines) {
  Dice dice(7);
  double met = 0;
  for (int i = 0; i < lines; ++i)
    met +=
        world.view().cross(f.surface.value, f.sample(dice.between(0, 1), dice.between(0, 1)), {}).distance < infinity;
  return met / lines;
}
TEST(Screens, light_on_them_is_that_of_the_energy_balance) {
  constexpr int lines = 100000;
  for (double tilt : {0.0, 0.7}) {
    World world = clutter(tilt);
    Touched touched;
    BeamEnergyBalance const energy_balance = grow_tree(world, launched(world, 2 * w), {1e-15}, touched);
    ASSERT_GE(touched.all.size(), 5u);
    for (std::size_t i = 0; i < touched.all.size(); ++i) {
      add_lit_screen(world, 0, 2, Feed::none, touched.all[i], touched.ways[i]);
      Footprint const& f = world.footprints().back();
      double const share = drawn_on(world, f, lines), exact = 2 * taken(energy_balance, f.surface.value);
      EXPECT_NEAR(f.share * share, exact, 5 * f.share * std::sqrt(share / lines) + 2e-3 * exact) << i;
      Footprint whole = f;  // control: points are drawn in the hole too, without its power
      whole.hollow = 1;
      if (f.hollow < 0.9) {
        EXPECT_GT(std::fabs(f.share * drawn_on(world, whole, lines) - exact), 0.05 * exact) << i;
      }
    }
  }
}
// |u|^2 outside of the hole is what the lines are drawn with.
TEST(Screens, light_on_them_is_the_mode_outside_of_the_hole) {
  World world = with_holes({{2 * w, 0.5 * w}});
  Touched touched;
  grow_tree(world, launched(world, w), {1e-15}, touched);
  ASSERT_EQ(touched.all.size(), 1u);
  add_lit_screen(world, 0, 1, Feed::none, touched.all[0], {});
  Footprint const& f = world.footprints().back();
  EXPECT_NEAR(f.share * f.intensity({3 * w, 0, 0}) / (2 / (pi * there * there) * std::exp(-18 * w * w / there / there)),
              1, 1e-6);
  EXPECT_EQ(f.intensity({w, 0, 0}), 0);
  EXPECT_GT(drawn_on(world, f, 20000), 0.1);  // of a mode that is not hollow 0.002 would land
}

}  // namespace
}  // namespace straytrace::testing::world_screens
