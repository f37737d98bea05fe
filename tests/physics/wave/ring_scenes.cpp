// SPDX-License-Identifier: BSD-3-Clause
// Rings and folded cavities of scenes (docs/theory/wave.md): defects and measured maps on mirrors at an incidence (eq.
// W.18, W.33, W.55), the driven field (eq. W.50 to W.53), and levers of edges and mirrors (eq. W.56 to W.58) against
// eigenvalues with either moved, and against those of a linear cavity (eq. W.14).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "support/recorded.hpp"
#include "wave/arm/arm_waves.hpp"
#include "wave/heights/defects.hpp"
#include "wave/ring/ring_cavity.hpp"
#include "wave/ring/ring_waves.hpp"

namespace straytrace::wave_ring_scenes {
namespace {

using testing::deviation;
using wave::Complex;

constexpr double nd_yag = 1.064e-6;  // m
double const cosine = std::cos(pi / 6);

std::string list(Vec3 v, char const* unit = "") {
  return fmt::format("[{:.17g}{}, {:.17g}{}, {:.17g}{}]", v.x, unit, v.y, unit, v.z, unit);
}

// An equilateral triangle of 100 m, C curved; both edges are off the axis and clip the beam. Moved by `displacement`,
// or turned by `rotation` about its centre, is the part of this name.
struct Triangle {
  std::string moved;
  Vec3 displacement, rotation;
  std::string settings, baffles = "edge*", grid = "{points: 192, window: 0.16 m}";
  double radius = 25;  // mm, of the mirrors
  FileTexts files;

  std::string part(std::string const& name, std::string const& shape, Vec3 at, Vec3 facing,
                   std::string const& material) const {
    if (name == moved) {
      at = at + displacement;
      facing = unit(facing) + cross(rotation, unit(facing));
    }
    return "  - {name: " + name + ", shape: {" + shape + "}, at: " + list(at, " m") + ", facing: " + list(facing) +
           ", body: still, material: " + material + "}\n";
  }
  World world() const {
    double const root = std::sqrt(3.0);
    Vec3 const a{-50, 0, 0}, b{50, 0, 0}, c{0, 0, 50 * root}, on{-0.5, 0, 0.5 * root};
    std::string const outer = fmt::format("{} mm", radius);
    FileTexts texts = files;
    texts["a.yaml"] =
        "straytrace: 1\nmaterials: {mirror: {specular: {reflect: 0.9999}}, black: {}}\n"
        "bodies: {still: {motion: still}}\nscene:\n" +
        part("A", "disk: {outer_radius: " + outer + "}", a, {root, 0, 1}, "mirror") +
        part("B", "disk: {outer_radius: " + outer + "}", b, {-root, 0, 1}, "mirror") +
        part("C", "cap: {curvature: 1/(400 m), outer_radius: " + outer + "}", c, {0, 0, -1}, "mirror") +
        part("edge1", "disk: {inner_radius: 16 mm, outer_radius: 10 cm}", {-10, 2e-3, 3e-3}, {1, 0, 0}, "black") +
        part("edge2", "disk: {inner_radius: 17 mm, outer_radius: 10 cm}", b + 40 * on + Vec3{0, -3e-3, 0}, on,
             "black") +
        "beams: {b: {cavity: [A, B, C], power: 1 W}}\nreceivers: {R: {on: C}}\n" + "wave: {beam: b, " +
        (baffles.empty() ? "" : "baffles: \"" + baffles + "\", ") + "crossover: 300 urad, grid: " + grid + settings +
        "}\n";
    Scene const scene = read_scene("a.yaml", {}, &texts);
    World world = build_world(scene);
    scene.throw_if_problems();
    return world;
  }
};

RingWaves solved(Triangle const& triangle) {
  World const world = triangle.world();
  return solve_ring(world, world.wave, planned_ring(world, world.wave));
}
double relative(Complex value, Complex expected) { return std::abs(value - expected) / std::abs(expected); }

// Maps and defects.

// The share of the light that a mirror sends into an order of its heights, `periods` in the window.
double order_share(Triangle const& triangle, int periods_x, int periods_y) {
  World const world = triangle.world();
  RingCavity ring = planned_ring(world, world.wave);
  throw_errors(ring.problems);
  add_ring_heights(ring, world, world.wave);
  auto const stop = std::ranges::find(ring.trip.stops, 1 / 400.,
                                      [](TripStop const& s) { return s.mirror ? s.mirror->curvature : 0; });
  Grid const& grid = ring.trip.grid;
  Complex sum = 0;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const h = stop->mirror->height[std::size_t(row * grid.points + column)];
      sum += turned(-2 * h * stop->opening.cosine / nd_yag) *
             turned((periods_x * grid.at(column) + periods_y * grid.at(row)) / grid.window);
    }
  return std::norm(sum / double(grid.size()));
}

TEST(RingHeights, RippleAtAnIncidenceW18W55) {
  double const k = 2 * pi / nd_yag, h = 20e-9;
  auto const bessel = [&](double path) { return std::pow(std::cyl_bessel_j(1, path), 2); };
  // Across the plane of incidence the period is that of the ripple, in it that times the cosine.
  Triangle across, along;
  across.settings = ", maps: {C: {defects: [{ripple: {amplitude: 20 nm peak, period: 8 mm, direction: 90 deg}}]}}";
  along.settings = fmt::format(
      ", maps: {{C: {{defects: [{{ripple: {{amplitude: 20 nm peak, period: {:.17g} mm}}}}]}}}}", 8 / cosine);
  EXPECT_LT(deviation(order_share(across, 0, 20), bessel(2 * k * h * cosine)), 1e-6);
  EXPECT_LT(deviation(order_share(along, 20, 0), bessel(2 * k * h * cosine)), 1e-6);
  EXPECT_LT(order_share(along, 0, 20), 1e-12);
  EXPECT_GT(deviation(order_share(across, 0, 20), bessel(2 * k * h)), 0.1);  // control: without the cosine
}

// Of a small spot, eq. W.33 times cos (1 + cos^2)/2, the mean of cos^4/(cos^2 cos^2 phi + sin^2 phi)^2 over azimuths.
TEST(RingHeights, AbsorberAtAnIncidenceW33) {
  WaveSettings::Absorber const spot{0, 0, 1e-8, 1e-9};
  double const normal = scattered_by_absorber(spot, 8e-3, nd_yag, 1e-3);
  double const oblique = scattered_by_absorber(spot, LightOnMirror{{8e-3, 8e-3}, cosine}, nd_yag, 1e-3);
  EXPECT_LT(deviation(oblique, normal * cosine * (1 + cosine * cosine) / 2), 1e-6);
  EXPECT_GT(deviation(oblique, normal), 0.1);
}

// The height of an absorber on the grid across the light is that of the mirror at x/cos.
TEST(RingHeights, AbsorberLiesAtItsPlaceOnTheMirror) {
  Grid const grid{256, 0.16};
  WaveSettings::Absorber const wide{4e-3, -3e-3, 12e-3, 1e-9};
  LightOnMirror const light{{8e-3, 8e-3}, cosine, {1e-3, 0.5e-3}};
  std::vector<double> const heights = heights_of_absorber(wide, grid, 0.1, 300, light);
  for (int row : {100, 128, 150})
    for (int column : {110, 131, 140}) {
      double const x = grid.at(column) / cosine + 1e-3, y = grid.at(row) + 0.5e-3;
      double const expected = height_of_absorber(wide, std::hypot(x - 4e-3, y + 3e-3), 0.1);
      EXPECT_LT(deviation(heights[std::size_t(row * 256 + column)], expected), 1e-6);
    }
  // A small one is the sum of a wide one and of a spectrum: far away it is the same height.
  WaveSettings::Absorber const narrow{4e-3, -3e-3, 2e-3, 1e-9};
  std::vector<double> const small = heights_of_absorber(narrow, grid, 0.1, 600, light);
  double const x = grid.at(160) / cosine + 1e-3, y = grid.at(140) + 0.5e-3;
  EXPECT_LT(deviation(small[140 * 256 + 160], height_of_absorber(narrow, std::hypot(x - 4e-3, y + 3e-3), 0.1)), 1e-3);
}

// A map of heights x or y times a slope, whose tilt stays.
std::string tilt_map(double slope_x, double slope_y) {
  std::string text = "x [mm], y [mm], height [nm]\n";
  for (int row = -60; row <= 60; ++row)
    for (int column = -60; column <= 60; ++column)
      text += fmt::format("{}, {}, {:.12g}\n", column, row, 1e6 * (slope_x * column + slope_y * row));
  return text;
}
Triangle with_map(double slope_x, double slope_y) {
  Triangle tilted;
  tilted.files["tilt.csv"] = tilt_map(slope_x, slope_y);
  tilted.settings = ", maps: {C: {file: tilt.csv, remove: [piston]}}";
  return tilted;
}
Triangle turned_mirror(std::string const& name, Vec3 rotation) {
  Triangle triangle;
  triangle.moved = name;
  triangle.rotation = rotation;
  return triangle;
}

// Heights s x lean the normal by -s along x. Mirror C faces -z, so that its x, the normal of the plane of incidence (y)
// times the normal, is -x of the scene.
TEST(RingHeights, AMapOfATiltIsAMirrorThatLeansW55) {
  double const slope = 0.1e-6;
  // Of both signs, so that light scattered by the edge of the map, of second order, drops out.
  auto const change = [&](auto const& triangle) {
    return std::log(solved(triangle(slope)).mode.eigenvalue / solved(triangle(-slope)).mode.eigenvalue);
  };
  Complex const in_plane = change([](double s) { return with_map(s, 0); }),
                across = change([](double s) { return with_map(0, s); });
  // A rotation r about y turns the normal -z towards -x by r, about x towards +y.
  Complex const about_y = change([](double s) {
    return turned_mirror("C", {0, -s, 0});
  }),
                about_x = change([](double s) {
                  return turned_mirror("C", {-s, 0, 0});
                });
  EXPECT_LT(relative(in_plane, about_y), 0.04);
  EXPECT_LT(relative(across, about_x), 0.04);
  EXPECT_GT(relative(across * cosine, about_x), 0.1);  // control: the cosine twice
}

TEST(RingHeights, LowOrdersOfAnEllipticSpot) {
  HeightMap map;
  for (int i = -40; i <= 40; ++i) map.x.push_back(i * 1e-3);
  map.y = map.x;
  LightOnMirror const light{{6e-3, 9e-3}, 0.6, {3e-3, -2e-3}};
  for (double const y : map.y)
    for (double const x : map.x) {
      double const dx = x - 3e-3, dy = y + 2e-3;
      map.height.push_back(1e-9 + 2e-7 * dx - 1e-7 * dy + 1e-5 * (dx * dx + dy * dy) / 2);
    }
  LowOrders const found = fit_low_orders(map, light);
  EXPECT_LT(deviation(found.piston, 1e-9), 1e-6);
  EXPECT_LT(deviation(found.tilt_x, 2e-7), 1e-6);
  EXPECT_LT(deviation(found.tilt_y, -1e-7), 1e-6);
  EXPECT_LT(deviation(found.curvature, 1e-5), 1e-6);
  EXPECT_GT(deviation(fit_low_orders(map, LightOnMirror{light.radius, 0.6}).tilt_x, 2e-7), 0.1);  // about the vertex
}

// The driven field.

TEST(RingDriven, AiryFunctionW50) {
  Triangle triangle;
  triangle.settings = ", mirrors: {A: {transmission: 2 %}, B: {transmission: 1 %, loss: 0.2 %}}";
  World const world = triangle.world();
  RingWaves const waves = solve_ring(world, world.wave, planned_ring(world, world.wave));
  std::vector<double> const detunings{0, 1e-3, 0.01, 0.3};
  DrivenScan const scan = drive_ring(world, world.wave, waves, {{0.02, 0}, {0.01, 2e-3}, {0, 0}}, detunings);
  ASSERT_EQ(scan.surfaces.size(), 3u);
  EXPECT_EQ(world.name_of(scan.surfaces[0]), "A");
  EXPECT_EQ(world.name_of(scan.surfaces[1]), "B");
  EXPECT_LT(deviation(scan.free_spectral_range, speed_of_light / 300), 1e-6);
  double const r1 = std::sqrt(0.98), r2 = std::sqrt(0.988), t1 = std::sqrt(0.02),
               trip = std::abs(waves.mode.eigenvalue);
  for (std::size_t i = 0; i < detunings.size(); ++i) {
    Complex const round = r1 * r2 * trip * turned(detunings[i]), gain = t1 / (1.0 - round);
    DrivenPowers const& p = scan.detunings[i];
    EXPECT_LT(deviation(p.circulating, std::norm(gain)), 1e-4) << i;
    EXPECT_NEAR(p.reflected, std::norm(-r1 + t1 / r1 * round * gain), 2e-4) << i;
    ASSERT_EQ(p.ports.size(), 2u);
    // An edge between A and B, and the outline of B, take their shares.
    double const passed = 1 - waves.losses.taken[0] - waves.losses.taken[1];
    EXPECT_LT(deviation(p.ports[0], 0.01 * std::norm(gain) * passed), 1e-4 + waves.losses.beyond_band) << i;
    EXPECT_EQ(p.ports[1], 0);
  }
  EXPECT_GT(deviation(scan.detunings[0].circulating, std::norm(t1 / (1 - r1 * std::sqrt(0.99) * trip))), 0.05);
}

// eq. W.53: with three mirrors the mode that is odd in the plane of incidence is half a free spectral range away.
TEST(RingDriven, OddModesAreHalfARangeApartW53) {
  auto const order1 = [](char const* tilt, double detuning) {
    Triangle triangle;
    triangle.baffles = "";
    triangle.radius = 40;  // no clipping
    triangle.grid = "{points: 288, window: 0.24 m}";
    triangle.settings = fmt::format(", input: {{tilt: {}}}", tilt);
    World const world = triangle.world();
    RingWaves const waves = solve_ring(world, world.wave, planned_ring(world, world.wave));
    DrivenScan const scan = drive_ring(world, world.wave, waves, {{0.02, 0}, {0.02, 0}, {0, 0}}, {detuning});
    DrivenPowers const& p = scan.detunings[0];
    return p.circulating * p.orders[1];
  };
  World const world = Triangle{}.world();
  RingCavity const ring = planned_ring(world, world.wave);
  double const in_plane = ring.gouy[0] / (2 * pi), across = ring.gouy[1] / (2 * pi);
  double const tilt = 2e-6, gain = std::norm(std::sqrt(0.02) / (1 - 0.98));
  auto const share = [&](double w) { return std::pow(pi * w * tilt / nd_yag, 2); };
  EXPECT_LT(deviation(order1("[2 urad, 0 rad]", in_plane), gain * share(ring.start[0].radius)), 0.02);
  EXPECT_LT(deviation(order1("[0 rad, 2 urad]", across), gain * share(ring.start[1].radius)), 0.02);
  EXPECT_LT(order1("[2 urad, 0 rad]", in_plane + 0.5), 1e-3 * gain * share(ring.start[0].radius));  // control
  EXPECT_NEAR(std::fabs(std::remainder(in_plane - across, 1)), 0.5, 0.1);  // but for the astigmatism
}

// The grid. A window is the same, so that heights are as well; 192 points are followed by 288.

TEST(RingGrid, CheckIsTheDifferenceToTheFinerGrid) {
  ArmOptions options;
  options.highest_order = 1;
  options.grid_check = true;
  auto const at = [&](char const* grid) {
    Triangle triangle;
    triangle.grid = grid;
    World const world = triangle.world();
    return solve_ring(world, world.wave, planned_ring(world, world.wave), options);
  };
  RingWaves const coarse = at("{points: 192, window: 0.16 m}"), fine = at("{points: 288, window: 0.16 m}");
  ASSERT_TRUE(coarse.grid_check && fine.grid_check);
  RingGridCheck const& check = *coarse.grid_check;
  EXPECT_EQ(check.points, 288);
  EXPECT_EQ(check.loss, fine.mode.loss() - coarse.mode.loss());
  ASSERT_EQ(check.losses.taken.size(), 5u);
  EXPECT_EQ(check.losses.taken[0], fine.losses.taken[0] - coarse.losses.taken[0]);
  double phase = 0;
  for (std::size_t i = 0; i < 3; ++i) phase = std::max(phase, std::fabs(fine.modes[i].phase - coarse.modes[i].phase));
  EXPECT_EQ(check.phase, phase);
  double largest = 0, squares = 0;
  for (std::size_t i = 0; i < coarse.levers.surfaces.size(); ++i) {
    if (coarse.levers.surfaces[i].mirror) continue;
    double change = 0;
    for (int axis = 0; axis < 3; ++axis) {
      Complex const was = coarse.levers.surfaces[i].levers.displacement[axis];
      change += std::norm(fine.levers.surfaces[i].levers.displacement[axis] - was);
      squares += std::norm(was) / 2;  // of two edges
    }
    largest = std::max(largest, std::sqrt(change));
  }
  EXPECT_LT(deviation(check.edges, largest / std::sqrt(squares)), 1e-12);
  EXPECT_LT(std::fabs(fine.grid_check->loss), std::fabs(check.loss));  // control: of another grid
}

// Levers.

SurfaceLevers const& levers_of(RingWaves const& waves, World const& world, std::string const& name) {
  return *std::ranges::find(waves.levers.surfaces, name,
                            [&](SurfaceLevers const& s) { return world.name_of(s.surface); });
}
constexpr char rough[] =
    ", maps: {B: {defects: [{ripple: {amplitude: 1 nm peak, period: 9 mm, direction: 30 deg}}]}, "
    "C: {defects: [{absorber: {at: [4 mm, -3 mm], radius: 2 mm, power: 5 mW}}]}}";

// d ln(gamma) by the motion of a part, from both sides: the axis of the planned cavity follows its mirrors.
Complex difference(std::string const& part, Vec3 displacement, Vec3 rotation, double step,
                   std::string const& settings = rough) {
  auto const eigenvalue = [&](double size) {
    Triangle triangle;
    triangle.settings = settings;
    triangle.moved = part;
    triangle.displacement = size * displacement;
    triangle.rotation = size * rotation;
    return solved(triangle).mode.eigenvalue;
  };
  return std::log(eigenvalue(step) / eigenvalue(-step)) / (2 * step);
}

struct Solved {
  World world;
  RingWaves waves;
};
RingLevers exact_levers(World const& world) {
  RingCavity ring = planned_ring(world, world.wave);
  add_ring_heights(ring, world, world.wave);
  RoundTrip const trip(ring.trip);
  SolveOptions exact;
  exact.loss_error = 1e-10;
  WaveMode const mode = trip.mode(trip.hermite_gauss(ring.start[0], ring.start[1]), exact);
  return ring_levers(world, ring, trip, mode, exact);
}
Solved rough_ring() {
  Triangle triangle;
  triangle.settings = rough;
  World world = triangle.world();
  RingWaves waves = solve_ring(world, world.wave, planned_ring(world, world.wave));
  return {std::move(world), std::move(waves)};
}

TEST(RingLevers, OfAnEdgeAgainstTheMovedEdgeW56) {
  auto const [world, waves] = rough_ring();
  SurfaceLevers const& edge = levers_of(waves, world, "edge1");  // the light runs along x
  Complex const y = difference("edge1", {0, 1, 0}, {}, 2e-5), z = difference("edge1", {0, 0, 1}, {}, 2e-5),
                x = difference("edge1", {1, 0, 0}, {}, 0.05);
  EXPECT_LT(relative(edge.levers.displacement[1], y), 1e-3);
  EXPECT_LT(relative(edge.levers.displacement[2], z), 1e-3);
  EXPECT_LT(relative(edge.levers.displacement[0], x), 1e-2);
  EXPECT_GT(relative(2.0 * edge.levers.displacement[1], y), 0.5);  // control: two passages
  SurfaceLevers const& other = levers_of(waves, world, "edge2");
  EXPECT_LT(relative(other.levers.displacement[1], difference("edge2", {0, 1, 0}, {}, 2e-5)), 2e-3);
  EXPECT_LT(std::abs(waves.levers.eigenvalue / waves.mode.eigenvalue - 1.0), 1e-8);
}

// The field the other way around is another one; its conjugate is not the left eigenvector. At a plane behind edge 1.
TEST(RingLevers, TakeTheProductWithoutAConjugateW56) {
  Trip trip{nd_yag, {192, 0.16}, {}, true};
  auto const mirror = [](double leg, double curvature) {
    RoundHole const outline{0.025};
    return TripStop{leg, outline, WaveMirror{curvature, outline, 0, 0, {}, 0}};
  };
  trip.stops = {{30, {0.016, 2e-3, 1e-3}, {}}, mirror(70, 0), mirror(100, 1 / 400.), mirror(100, 0)};
  SolveOptions exact;
  exact.loss_error = 1e-9;
  AxisBeam const start{7.9e-3, 1 / 636.};
  auto const arriving = [&](Trip const& of, std::size_t stop) {
    RoundTrip const way(of);
    WaveMode const mode = way.mode(way.hermite_gauss(start, start), exact);
    Field found(of.grid), work = mode.spectrum;
    way.travel(work, {[&](std::size_t i, Field const& field) {
                        if (i == stop) found = field;
                      },
                      {}});
    return std::pair{found, mode.eigenvalue};
  };
  auto const [f, gamma] = arriving(trip, 0);
  auto const [b, other] = arriving(reversed(trip), 2);  // the last stop before the start
  EXPECT_LT(std::abs(other / gamma - 1.0), 1e-9);
  auto const moved = [&](double x) {
    Trip shifted = trip;
    shifted.stops[0].opening.x += x;
    return arriving(shifted, 0).second;
  };
  double const step = 2e-5;
  Complex const expected = std::log(moved(step) / moved(-step)) / (2 * step);
  Transform const transform(192);
  Mask const here(trip.stops[0].opening, trip.grid, transform), less({0.016, 2e-3 - step, 1e-3}, trip.grid, transform),
      more({0.016, 2e-3 + step, 1e-3}, trip.grid, transform);
  auto const lever = [&](auto const& product) {
    Complex change = 0, all = 0;
    for (std::size_t i = 0; i < f.values.size(); ++i) {
      Complex const p = product(f.values[i], b.values[i]);
      change += (more.values()[i] - less.values()[i]) / (2 * step) * p;
      all += here.values()[i] * p;
    }
    return change / all;
  };
  EXPECT_LT(relative(lever([](Complex a, Complex c) { return a * c; }), expected), 1e-4);
  EXPECT_GT(relative(lever([](Complex a, Complex c) { return a * std::conj(c); }), expected), 0.02);
  EXPECT_GT(relative(lever([](Complex a, Complex) { return a * a; }), expected), 0.02);  // one direction alone
}

// The change of the angle of incidence, and with it of the astigmatism, is not in W.57. A is the input mirror. Errors
// are relative to the lever of an edge, since the outline of A, which alone moves along y, has a lever of 1 % of that.
TEST(RingLevers, OfAMirrorAgainstTheMovedMirrorW57) {
  auto const [world, waves] = rough_ring();
  double const size = std::abs(levers_of(waves, world, "edge1").levers.displacement[1]);
  for (char const* const name : {"A", "B", "C"}) {
    SurfaceLevers const& mirror = levers_of(waves, world, name);
    Vec3 const axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int axis : {0, 1, 2}) {
      Complex const lever = mirror.levers.displacement[axis], moved = difference(name, axes[axis], {}, 2e-5);
      EXPECT_LT(std::abs(lever - moved), 5e-4 * size) << name << axis;
      EXPECT_GT(std::abs(cosine * lever - moved), 5e-4 * size) << name << axis;  // control: a cosine too many
    }
    for (int axis : {0, 1}) {
      Complex const lever = mirror.levers.rotation[axis], turned = difference(name, {}, axes[axis], 1e-7);
      EXPECT_LT(relative(lever, turned), 3e-3) << name << axis;
      EXPECT_GT(relative(cosine * lever, turned), 0.1) << name << axis;
    }
  }
}

// About z a mirror leans and rolls. Maps lie in the plane of incidence and do not roll in a scene, so that the mirrors
// are smooth here; C only rolls, which a round mirror does not show.
TEST(RingLevers, OfAMirrorThatTurnsAboutTheAxisOfTheTriangleW57) {
  World const world = Triangle{}.world();
  RingWaves const waves = solve_ring(world, world.wave, planned_ring(world, world.wave));
  auto const about_z = [&](char const* name) { return levers_of(waves, world, name).levers.rotation[2]; };
  for (char const* const name : {"A", "B"}) {
    Complex const turned = difference(name, {}, {0, 0, 1}, 1e-7, "");
    EXPECT_LT(relative(about_z(name), turned), 2e-3) << name;
    EXPECT_GT(relative(cosine * about_z(name), turned), 0.1) << name;  // control: a cosine too many
  }
  EXPECT_GT(relative(about_z("A"), difference("B", {}, {0, 0, 1}, 1e-7, "")), 0.1);  // control: the other mirror
  EXPECT_LT(std::abs(about_z("C")), 1e-3 * std::abs(about_z("B")));
}

struct CommonMotion {
  std::array<double, 3> displacement, rotation;  // |sum|; rotations times 1/50 m
  double size;                                   // of the lever of an edge, 1/m
};
// Of all surfaces but `left_out`, about a point off all of them.
CommonMotion common_motion(std::string const& grid, std::string const& left_out = "") {
  Triangle triangle;
  triangle.settings = rough;
  triangle.grid = grid;
  World const world = triangle.world();
  std::array<Complex, 3> displacement{}, rotation{};
  CommonMotion found{};
  for (SurfaceLevers const& s : exact_levers(world).surfaces) {
    if (!s.mirror) found.size = std::max(found.size, std::abs(s.levers.displacement[1]));
    if (world.name_of(s.surface) == left_out) continue;
    RimLevers const about = levers_about(s, {10, -4, 20});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      displacement[axis] += s.levers.displacement[axis];
      rotation[axis] += about.rotation[axis];
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    found.displacement[axis] = std::abs(displacement[axis]);
    found.rotation[axis] = std::abs(rotation[axis]) / 50;
  }
  return found;
}

// eq. W.58: nothing changes when all bodies move or turn together. 384 points carry the light between openings up to
// b/dz (eq. W.5). On 192 the limit of the grid cuts it at an angle that does not turn along.
TEST(RingLevers, CommonMotionChangesNothingW58) {
  std::string const fine = "{points: 384, window: 0.16 m}", coarse = "{points: 192, window: 0.16 m}";
  CommonMotion const all = common_motion(fine), cut = common_motion(coarse), without = common_motion(fine, "edge1");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_LT(all.displacement[axis], 2e-5 * all.size) << axis;
    EXPECT_LT(all.rotation[axis], 5e-5 * all.size) << axis;
    EXPECT_LT(cut.displacement[axis], 1e-4 * cut.size) << axis;
  }
  EXPECT_GT(without.displacement[1], 0.1 * all.size);  // controls
  EXPECT_GT(without.rotation[0], 0.01 * all.size);
  EXPECT_GT(std::ranges::max(cut.rotation), 3e-4 * cut.size);
}

// Between two passages of an edge in a folded cavity stands the factor 2 of W.14.
TEST(RingLevers, AFoldedCavityHasThoseOfALinearOneW14) {
  testing::KilometreArm arm = testing::kilometre_arm(
      "crossover: 160 urad, grid: {points: 384, window: 0.5 m}, maps: {I: {spectrum: none}, E: {spectrum: none}}");
  arm.baffles =
      "  - {name: baffle, shape: {disk: {inner_radius: 40 mm, outer_radius: 30 cm}}, at: [3 mm, -2 mm, 300 m],"
      " facing: [0, 0, 1], body: pipe, material: black}\n";
  auto const built = [&](std::string text) {
    std::string const scatter = ", scatter: {model: power-law, kappa: 5e-7 /sr, exponent: 2, above: 1 urad}";
    text.replace(text.find(scatter), scatter.size(), "");
    FileTexts const texts{{"a.yaml", text}};
    Scene const scene = read_scene("a.yaml", {}, &texts);
    World world = build_world(scene);
    scene.throw_if_problems();
    return world;
  };
  World const straight = built(arm.text());
  ArmWaves const linear = solve_arm(straight, straight.wave);
  arm.baffles +=
      "  - {name: F, shape: {disk: {outer_radius: 15 cm}}, at: [0 m, 0 m, 500 m], facing: [1, 0, -1], body: optics, "
      "material: polished}\n";
  arm.end = "at: [500 m, 0 m, 500 m], facing: [-1, 0, 0]";
  std::string text = arm.text();
  text.replace(text.find("cavity: [I, E]"), 14, "cavity: [I, F, E, F]");
  text.replace(text.find(arm.ports), arm.ports.size(), "receivers: {R: {on: E}}\n");
  text.replace(text.find("E: {spectrum: none}"), 19, "E: {spectrum: none}, F: {spectrum: none}");
  World const bent = built(text);
  RingWaves const folded = solve_ring(bent, bent.wave, planned_ring(bent, bent.wave));
  SurfaceLevers const& edge = levers_of(folded, bent, "baffle");
  RimResponse const& expected = linear.rims[0].draws[0].responses[0];
  EXPECT_LT(deviation(folded.mode.loss(), linear.draws[0].loss), 1e-3);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(relative(edge.levers.displacement[axis], expected.levers.displacement[axis]), 5e-3) << axis;
    if (axis == 2) continue;  // a round edge that turns about the beam changes nothing
    EXPECT_LT(relative(edge.levers.rotation[axis], expected.levers.rotation[axis]), 5e-3) << axis;
  }
  EXPECT_LT(relative(edge.widening, expected.widening), 5e-3);
}

}  // namespace
}  // namespace straytrace::wave_ring_scenes
