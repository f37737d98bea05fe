// SPDX-License-Identifier: BSD-3-Clause
// A footprint as density, as sampler and as wavefront.
#include "beams/footprint.hpp"

#include <gtest/gtest.h>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/eigenmode.hpp"
#include "geometry/shapes/sphere.hpp"
#include "support/chi_square.hpp"

namespace straytrace::beams_footprint {
namespace {

Footprint footprint(Profile profile, Vec3 travel) {
  Footprint f;
  f.profile = profile;
  f.centre = {0.1, -0.3, 2999};
  f.travel = travel;
  f.radius = 0.058;
  f.backoff = 0.2;
  return f;
}
std::vector<Vec3> headings() { return {{0, 0, 1}, {0, 0, -1}, unit({0.2, -0.6, 0.7})}; }

// Integral of the intensity over the plane across the beam, midpoint rule on a square of 8 radii; 1 by eq. 0.6.
template <class Density>
double integral(Footprint const& f, Density density) {
  constexpr int n = 500;
  Frame const plane = Frame::around(f.travel);
  double const side = 8 * f.radius, step = side / n;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double const x = (i + 0.5) * step - side / 2, y = (j + 0.5) * step - side / 2;
      sum += density(f.centre + x * plane.e1 + y * plane.e2 + 0.3 * f.travel);
    }
  return sum * step * step;
}

TEST(footprint, intensity_is_normalised) {
  for (Vec3 travel : headings()) {
    Footprint const gaussian = footprint(Profile::gaussian, travel), even = footprint(Profile::even, travel);
    EXPECT_NEAR(integral(gaussian, [&](Vec3 p) { return gaussian.intensity(p); }), 1, 1e-9);
    EXPECT_NEAR(integral(even, [&](Vec3 p) { return even.intensity(p); }), 1, 2e-3);  // sharp edge on the grid
    // control: the amplitude radius of exp(-r^2/w^2) taken for the intensity
    auto const control = [&](Vec3 p) {
      return 2 / (pi * 0.058 * 0.058) * std::exp(-length2(gaussian.offset(p)) / 0.058 / 0.058);
    };
    EXPECT_GT(std::fabs(integral(gaussian, control) - 1), 0.5);
  }
}

// 12 by 12 cells of the plane across the beam, 100,000 lines; the expectation is the intensity in the cell, by
// quadrature (the edge of an even profile runs through cells, so these are split finely).
template <class Draw>
testing::ChiSquare against_intensity(Footprint const& f, Draw draw) {
  constexpr int side = 12, sub = 60, n = 100000;
  double const width = (f.profile == Profile::gaussian ? 4.0 : 2.4) * f.radius, cell = width / side;
  Frame const plane = Frame::around(f.travel);
  std::vector<double> observed(side * side + 1), expected = observed;
  double inside = 0;
  for (int i = 0; i < side * sub; ++i)
    for (int j = 0; j < side * sub; ++j) {
      double const x = (i + 0.5) * cell / sub - width / 2, y = (j + 0.5) * cell / sub - width / 2;
      double const p = f.intensity(f.centre + x * plane.e1 + y * plane.e2) * cell * cell / sub / sub;
      expected[std::size_t((i / sub) * side + j / sub)] += n * p;
      inside += p;
    }
  expected.back() = f.profile == Profile::gaussian ? n * (1 - inside) : 0;
  for (int i = 0; i < n; ++i) {
    Rng rng(1, std::uint64_t(i), 0, Stream::source);
    double const u = rng.uniform(), v = rng.uniform();
    Vec3 const o = plane.to_local(draw(f, u, v).origin - f.centre);
    double const x = std::floor((o.x + width / 2) / cell), y = std::floor((o.y + width / 2) / cell);
    bool const outside = x < 0 || y < 0 || x >= side || y >= side;
    ++observed[outside ? observed.size() - 1 : std::size_t(x * side + y)];
  }
  return testing::chi_square(observed, expected, 40);
}

TEST(footprint, sample_follows_the_intensity) {
  auto const as_is = [](Footprint const& f, double u, double v) { return f.sample(u, v); };
  auto const too_wide = [](Footprint f, double u, double v) {
    f.radius *= 1.02;
    return f.sample(u, v);
  };
  auto const no_root = [](Footprint const& f, double u, double v) { return f.sample(u * u, v); };
  for (Profile profile : {Profile::gaussian, Profile::even})
    for (Vec3 travel : headings()) {
      Footprint const f = footprint(profile, travel);
      EXPECT_TRUE(testing::passes(against_intensity(f, as_is), 6));
      EXPECT_FALSE(testing::passes(against_intensity(f, too_wide), 6));
      EXPECT_FALSE(testing::passes(against_intensity(f, no_root), 6));
    }
}

TEST(footprint, lines_are_parallel_and_start_before_the_surface) {
  for (Profile profile : {Profile::gaussian, Profile::even, Profile::point}) {
    Footprint const f = footprint(profile, unit({0.2, -0.6, 0.7}));
    Ray const r = f.sample(0.4, 0.8);
    EXPECT_EQ(length(r.dir - f.travel), 0);
    EXPECT_NEAR(dot(r.origin - f.centre, f.travel), -0.2, 1e-12);
    EXPECT_EQ(r.t_max, infinity);
  }
  Footprint const point = footprint(Profile::point, {0, 0, 1});
  EXPECT_EQ(length(point.sample(0.4, 0.8).origin - (point.centre - Vec3{0, 0, 0.2})), 0);
}

// At a cavity mirror the wavefront of the mode is the mirror: the incoming direction is minus the mirror's normal, 1e-9
// rad. The control has the wavefront of a beam with the waist on the mirror.
double worst_misfit(double curvature, double roc) {
  Cap mirror;
  mirror.curvature = 1 / roc;
  mirror.outer_radius = 0.17;
  mirror.place(facing_along({0, 0, 3000}, {0, 0, -1}));
  Footprint f = footprint(Profile::gaussian, {0, 0, 1});
  f.centre = mirror.vertex;
  f.curvature = curvature;
  double worst = 0;
  for (double u : {0.0, 0.1, 0.5, 1.0})
    for (double v : {0.0, 0.3, 0.8}) {
      Vec3 const p = mirror.sample(u, v);
      worst = std::fmax(worst, length(f.direction(p) + mirror.normal(p)));
    }
  return worst;
}

TEST(footprint, wavefront_of_a_cavity_mode_fits_the_mirror) {
  CavityMode const m = cavity_mode(3000, 1420, 1683, 1.064e-6);
  double const z = 3000 - m.waist_position, curvature = z / (z * z + m.rayleigh * m.rayleigh);  // at mirror 2
  EXPECT_NEAR(curvature * 1683, 1, 1e-12);
  EXPECT_LT(worst_misfit(curvature, 1683), 1e-9);
  EXPECT_GT(worst_misfit(0, 1683), 1e-5);
  EXPECT_GT(worst_misfit(-1 / 1683.0, 1683), 1e-4);  // converging instead of diverging
}

}  // namespace
}  // namespace straytrace::beams_footprint
