// SPDX-License-Identifier: BSD-3-Clause
// Diffraction at the inner edges of baffles (docs/theory/diffraction.md, eq. 8.11 to 8.14, case A19), against closed
// forms and against independent integrals: over the rim, and over the blocked area.
#include "trace/deterministic/edges.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "support/trace_support.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::testing::trace_edges {
namespace {

using Field = std::complex<double>;
constexpr double lambda = 1064e-9, k = 2 * pi / lambda, L = 1e4, aperture = 0.42;
constexpr double kappa = 3.2145e-9, slope = 2.3986;  // mirrors of ET-HF, per sr and angle

double beta(double theta) { return kappa * std::pow(theta, -slope); }
double j0(double x) { return std::cyl_bessel_j(0, x); }
double j1(double x) { return std::cyl_bessel_j(1, x); }
double reduced(double z) { return z * (L - z) / L; }

enum : std::uint32_t { mirror_a, pipe, mirror_b };  // bodies

struct Arm {
  World world;
  std::vector<SurfaceId> rings;
};

// Two mirrors and flat rings at `places` between them.
Arm arm(std::vector<double> const& places) {
  Arm made;
  World& w = made.world;
  w.wavelength = lambda;
  for (char const* name : {"A", "pipe", "B"}) w.add_body(name, {});
  std::uint32_t const mirror = power_law_optic(w, kappa, slope, 1e-6), black = black_optic(w);
  SurfaceId const a = w.add_surface(Disk{{}, {0, 0, 1}, 0, 0.31}, mirror, black, {mirror_a}, w.add_group("A"));
  SurfaceId const b = w.add_surface(Disk{{0, 0, L}, {0, 0, -1}, 0, 0.31}, mirror, black, {mirror_b}, w.add_group("B"));
  for (double z : places)
    made.rings.push_back(
        w.add_surface(Disk{{0, 0, z}, {0, 0, 1}, aperture, 0.5}, black, black, {pipe}, w.add_group("rings")));
  for (auto const& [at, z, port] : {std::tuple{a, 0.0, "A"}, std::tuple{b, L, "B"}}) {
    Footprint f = spot(at, {0, 0, z}, {0, 0, z > 0 ? 1.0 : -1.0}, Profile::gaussian, 0.12, w.add_port(port));
    f.standing = true;
    w.add_footprint(f);
  }
  w.finish();
  w.edges.groups = {"rings"};
  return made;
}

// Of one ring, displaced by d along x.
EdgeWave wave_of(Arm& made, double d = 0, std::size_t ring = 0) {
  made.world.edges.offset = {d, 0, 0};
  return edge_wave(made.world, 0, 1, *rim_of(made.world, made.rings.at(ring)));
}

std::complex<double> gradient(EdgeWave const& wave, std::uint32_t body, int axis) {
  for (EdgeWave::Gradient const& g : wave.gradient)
    if (g.body.value == body) return g.d[axis];
  return 0;
}

// A19: sqrt(f_r) of ET-HF at mid-arm, and J0 at 0 and 1 mm.
TEST(Edges, MidArmA19) {
  Arm made = arm({5e3, 4e3});
  double const centred = lambda * beta(aperture / 5e3) / L;
  EXPECT_NEAR(beta(aperture / 5e3), 19.2, 0.05);
  EXPECT_NEAR(centred, 2.04e-9, 0.005e-9);
  EXPECT_NEAR(aperture * aperture / (lambda * reduced(5e3)), 66.3, 0.05);
  EXPECT_NEAR(std::abs(wave_of(made).amplitude) / centred, 1, 1e-6);
  EXPECT_NEAR(std::abs(wave_of(made, 1e-3).amplitude) / centred, 0.76867, 1e-4);
  EXPECT_NEAR(std::abs(wave_of(made, 2.4e-3).amplitude) / centred, 0, 0.02);                   // near its first zero
  EXPECT_GT(std::fabs(std::abs(wave_of(made, 1e-3, 1).amplitude) / centred - 0.76867), 1e-3);  // control: elsewhere
}

// Eq. 8.11 for any place and offset; the sign of J0 is the phase.
TEST(Edges, FollowsJ0) {
  std::vector<double> const places = {40, 700, 5e3, 8e3};
  Arm made = arm(places);
  for (std::size_t ring = 0; ring < places.size(); ++ring)
    for (double d : {0.0, 0.3e-3, 2e-3, 8e-3}) {
      double const z = places[ring], lr = reduced(z);
      EdgeWave const wave = wave_of(made, d, ring);
      double const size = lambda * std::sqrt(beta(aperture / z) * beta(aperture / (L - z))) / L;
      Field const back = wave.amplitude * std::polar(1 / size, -k * (aperture * aperture + d * d) / (2 * lr));
      double const expected = j0(k * aperture * d / lr), tolerance = z < 100 ? 0.02 : 1e-3;
      EXPECT_NEAR(std::abs(back), std::fabs(expected), tolerance) << z << ' ' << d;
      if (z > 1000) {
        EXPECT_NEAR(back.real(), expected, tolerance) << z << ' ' << d;
      }
      if (z == 5e3 && d == 2e-3) {
        EXPECT_GT(std::fabs(back.real() - j0(k * aperture * d / z)), 0.1);  // control: one distance for the reduced one
      }
    }
}

// Eq. 8.12 and 8.13: derivatives for motion of the rim, and none for motion of all three bodies together.
TEST(Edges, PhaseSensitivitiesAreDerivatives) {
  double const z = 3e3, d = 0.7e-3;
  Arm made = arm({z});
  EdgeWave const wave = wave_of(made, d);
  double const kr = k * aperture / reduced(z);
  double const size = lambda * std::sqrt(beta(aperture / z) * beta(aperture / (L - z))) / L;
  Field const turn = std::conj(wave.amplitude) / std::abs(wave.amplitude);
  EXPECT_NEAR((gradient(wave, pipe, 0) * turn).real() / (-kr * j1(kr * d) * size), 1, 1e-3);
  EXPECT_NEAR(std::abs(gradient(wave, pipe, 1)) / (kr * size), 0, 1e-9);
  double const along = k * aperture * aperture / 2 * (1 / (L - z) / (L - z) - 1 / z / z);  // eq. 8.13
  EXPECT_NEAR((gradient(wave, pipe, 2) / wave.amplitude).imag() / along, 1, 1e-3);
  EXPECT_GT(std::fabs((gradient(wave, pipe, 2) / wave.amplitude).imag() / -along - 1), 1);  // control: the other sign
  for (int axis = 0; axis < 3; ++axis) {
    Field const all = gradient(wave, mirror_a, axis) + gradient(wave, pipe, axis) + gradient(wave, mirror_b, axis);
    EXPECT_NEAR(std::abs(all) / (kr * size), 0, 1e-6) << axis;
  }
  // Frozen geometry: that the BSDF changes around a rim off centre, n/(ka^2/l_r) = 0.5 %, is not in the phase
  // sensitivity.
  double const step = 1e-6;
  Field const moved = (wave_of(made, d + step).amplitude - wave_of(made, d - step).amplitude) / (2 * step);
  EXPECT_NEAR(std::abs(gradient(wave, pipe, 0) - moved) / std::abs(moved), 0, 1e-2);
  EXPECT_NEAR(std::abs(gradient(wave_of(made), pipe, 0)) / (kr * size), 0, 1e-9);  // a centred rim: second order
}

// The overlap of the two spherical waves over the blocked area (8.11 is its boundary term). Beyond the rim the screen
// grows slowly transparent, so that nothing else cuts the waves off; small-angle scatter taken constant there.
Field blocked_area(double z, double d, double radius) {
  double const lr = reduced(z), fade = 0.8;  // m
  auto const ring = [&](double r) {          // of exp(i k |r + d|^2/2 lr) over the azimuth
    return 2 * pi * r * std::polar(1.0, k * (r * r + d * d) / (2 * lr)) * j0(k * r * d / lr);
  };
  auto const taper = [&](double r) {
    double const x = (r - radius) / fade;
    return x >= 1 ? 0 : std::exp(-4 * x * x * x * x / (1 - x * x));
  };
  Field sum = 0;
  int const n = 100000;
  for (int j = 0; j < n; ++j) {
    double const r = radius + fade * (j + 0.5) / n;
    sum += ring(r) * taper(r) * (fade / n);
  }
  return sum * std::sqrt(beta(aperture / z) * beta(aperture / (L - z))) / (z * (L - z));
}
TEST(Edges, IsTheOverlapOverTheBlockedArea) {
  Arm made = arm({5e3});
  for (double d : {0.0, 1e-3}) {
    double const rim = std::abs(wave_of(made, d).amplitude);
    EXPECT_NEAR(rim / std::abs(blocked_area(5e3, d, aperture)), 1, 2e-3) << d;
    EXPECT_GT(std::fabs(rim / std::abs(blocked_area(5e3, d + 0.5e-3, aperture)) - 1), 5e-3) << d;  // control: elsewhere
  }
}

// The same by a direct sum over the rim of the exact lengths of both legs.
TEST(Edges, IsTheSumOverTheRim) {
  double const z = 2e3, d = 1.3e-3;
  Field sum = 0;
  int const n = 20000;
  for (int j = 0; j < n; ++j) {
    double const a = 2 * pi * j / n, x = d + aperture * std::cos(a), y = aperture * std::sin(a);
    double const one = std::hypot(std::hypot(x, y), z), two = std::hypot(std::hypot(x, y), L - z);
    double const size = std::sqrt(beta(std::hypot(x, y) / z) * beta(std::hypot(x, y) / (L - z)));
    sum += lambda * size / L / n * std::polar(1.0, k * (one + two - L));
  }
  Arm made = arm({z});
  EXPECT_NEAR(std::abs(wave_of(made, d).amplitude - sum) / std::abs(sum), 0, 1e-3);
  EXPECT_GT(std::abs(wave_of(made, 2 * d).amplitude - sum) / std::abs(sum), 0.1);  // control: twice as far off
}

// Eq. 8.14: random teeth, first zero at 6.333 mm (A19).
TEST(Edges, RandomTeeth) {
  Arm made = arm({5e3});
  double const smooth = std::abs(wave_of(made).amplitude);
  made.world.edges.tooth_width = 10e-3;
  for (double height : {1e-3, 3e-3, 6.333e-3, 9e-3}) {
    made.world.edges.tooth_height = height;
    double const x = k * aperture * height / (2 * reduced(5e3));
    EXPECT_NEAR(std::abs(wave_of(made).amplitude) / smooth, std::fabs(std::sin(x) / x), 1e-4) << height;
    if (height == 3e-3) {
      EXPECT_GT(std::fabs(std::abs(wave_of(made).amplitude) / smooth - std::fabs(std::sin(2 * x) / (2 * x))),
                0.1);  // control: the height from the middle
    }
  }
  made.world.edges.tooth_height = 6.333e-3;
  EXPECT_LT(std::abs(wave_of(made).amplitude) / smooth, 1e-4);
  // The rest is not gone: each tooth sends it out on its own.
  double rest = 0;
  for (PathRecord const& r : wave_of(made).teeth) rest += r.weight;
  EXPECT_NEAR(rest / (smooth * smooth) * (2 * pi * aperture / 10e-3), 1, 1e-3);
}

// Teeth that the shape has, regular and finer than any structure of J0, act on the mean field like random ones.
TEST(Edges, TeethOfTheShape) {
  Arm made = arm({5e3});
  double const smooth = std::abs(wave_of(made).amplitude);
  for (double depth : {2e-3, 6.333e-3, 18e-3}) {
    SerratedCone cone;
    cone.inner_radius = aperture - 0.5 * depth;
    cone.outer_radius = 0.5;
    cone.half_angle = pi / 2;
    cone.tooth_depth = depth;
    cone.teeth = 260;
    cone.place({{0, 0, 5e3}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    World& w = made.world;
    SurfaceId const id = w.add_surface(cone, 1, 1, {pipe}, w.add_group("teeth"));
    double const x = k * aperture * depth / (2 * reduced(5e3));
    EdgeWave const wave = edge_wave(w, 0, 1, *rim_of(w, id));
    EXPECT_NEAR(std::abs(wave.amplitude) / smooth, std::fabs(std::sin(x) / x), 2e-3) << depth;
    if (depth == 2e-3) {
      EXPECT_GT(std::fabs(std::abs(wave.amplitude) / smooth - std::fabs(std::sin(2 * x) / (2 * x))),
                0.1);  // negative control
    }
  }
}

// A baffle that only one mirror sees diffracts nothing into the other.
TEST(Edges, OnlyPartsVisibleFromBothMirrors) {
  Arm hidden = arm({5e3, 4e3});
  EXPECT_NEAR(wave_of(hidden).seen, 1, 1e-12);
  World& w = hidden.world;
  w.add_surface(Disk{{0, 0, 2e3}, {0, 0, 1}, 0.1, 0.5}, 1, 1, {pipe}, w.add_group("stop"));
  w.finish();
  EXPECT_EQ(wave_of(hidden).seen, 0);
  EXPECT_EQ(edge_classes(w).classes.size(), 0u);
  EXPECT_EQ(edge_classes(w).warnings.size(), 1u);
  EXPECT_EQ(edge_classes(arm({5e3, 4e3}).world).classes.size(), 2u);  // control: without the stop
}

// Classes of the table: both directions, C_rev, and the three ways to add rims.
TEST(Edges, ClassesAddRims) {
  Arm made = arm({4990, 5000, 5010});
  auto const mean = [&](EdgeSettings::Sum sum) {
    made.world.edges.sum = sum;
    EdgeClasses const all = edge_classes(made.world);
    EXPECT_EQ(all.classes.size(), 2u);
    for (CouplingClass const& c : all.classes) {
      EXPECT_EQ(c.kind, ClassKind::edge);
      EXPECT_EQ(c.reverse, 2);
      EXPECT_TRUE(c.coupling.trusted);
      EXPECT_EQ(c.coupling.std_error, 0);
      EXPECT_NE(c.statement.find("upper bound"), std::string::npos);
      double weights = 0;
      for (PathRecord const& r : c.records) weights += r.weight;
      EXPECT_NEAR(weights / c.coupling.mean, 1, 1e-12);
    }
    EXPECT_NEAR(all.classes[0].coupling.mean / all.classes[1].coupling.mean, 1, 1e-9);
    return all.classes[0].coupling.mean;
  };
  double const one = std::pow(lambda * beta(aperture / 5e3) / L, 2);
  EXPECT_NEAR(mean(EdgeSettings::Sum::independent) / one, 3, 1e-4);
  EXPECT_NEAR(mean(EdgeSettings::Sum::in_phase) / one, 9, 1e-3);
  EXPECT_GT(std::fabs(mean(EdgeSettings::Sum::geometric) / one - 3), 5);  // control: their powers
  EXPECT_NEAR(mean(EdgeSettings::Sum::geometric) / one, 9, 0.02);  // 10 m change the phase of mid-arm rims by 1e-3
}

}  // namespace
}  // namespace straytrace::testing::trace_edges
