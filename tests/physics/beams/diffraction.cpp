// SPDX-License-Identifier: BSD-3-Clause
// Gaussian beams behind apertures (R2.26, R2.27; docs/theory/beams.md, eq. 5.5 to 5.7, A8).
#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "beams/overlap.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::beams_diffraction {
namespace {

using Field = std::complex<double>;
constexpr double lambda = 1064e-9, w = 0.01;
BeamInPlane const flat{w, 0, lambda};

Opening opening(double radius, double x = 0, double y = 0) {
  Opening a;
  a.radius = radius;
  a.x = x;
  a.y = y;
  return a;
}

// Intensity on the axis of the beam over that without the aperture.
double axis_factor(Opening const& a, double distance) {
  return std::norm(field_behind(flat, a, distance, 0, 0) / free_field(flat, distance, 0, 0));
}

// R2.26: what a centred aperture lets through; A8: with an offset, against a plain sum over the beam.
TEST(Clipping, ClosedForms) {
  EXPECT_NEAR(1 - clipped_share(flat, opening(w)), 0.86466, 5e-6);
  EXPECT_NEAR(1 - clipped_share(flat, opening(pi * w / 2)), 0.99281, 5e-6);
  EXPECT_NEAR(clipped_share(flat, opening(2.5 * w)) / 3.73e-6, 1, 2e-3);
  BeamInPlane const arm{58.05e-3, 0, lambda}, a8{58e-3, 0, lambda};
  EXPECT_NEAR(clipped_share(arm, opening(0.175)) / 1.277e-8, 1, 1e-3);
  EXPECT_NEAR(clipped_share(a8, opening(0.17)) / 3.4513e-8, 1, 1e-4);
  EXPECT_NEAR(clipped_share(a8, opening(0.165)) / 9.3427e-8, 1, 1e-4);
  EXPECT_GT(std::fabs(clipped_share(a8, opening(0.165 / 2)) / 9.3427e-8 - 1),
            1);  // control: the radius for the diameter
}
double outside(double radius, double offset) {  // by a sum over the plane, units of w
  double sum = 0;
  int const n = 4000;
  double const reach = 7, step = 2 * reach / n;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double const x = -reach + (i + 0.5) * step, y = -reach + (j + 0.5) * step;
      if (std::hypot(x - offset, y) > radius) sum += 2 / pi * std::exp(-2 * (x * x + y * y)) * step * step;
    }
  return sum;
}
TEST(Clipping, OffCentreA8) {
  double const radius = 1.5, offset = 0.6;
  double const sum = outside(radius, offset);
  EXPECT_NEAR(clipped_share(flat, opening(radius * w, offset * w)) / sum, 1, 1e-3);
  EXPECT_NEAR(clipped_share(flat, opening(radius * w, 0.36 * w, -0.48 * w)) / sum, 1, 1e-3);
  EXPECT_GT(std::fabs(clipped_share(flat, opening(radius * w)) / sum - 1), 0.1);  // control: centred
}

// Eq. 5.7 and the two 17 % of R2.27: far away the axis loses them, nearby it goes up and down by them.
TEST(Diffraction, AxisAtPiHalfW) {
  Opening const a = opening(pi * w / 2);
  EXPECT_NEAR(axis_factor(a, 1e7), 0.8376, 5e-5);
  double low = 2, high = 0;
  for (double n = 20; n < 24; n += 0.05) {  // Fresnel numbers
    double const factor = axis_factor(a, a.radius * a.radius / (lambda * n));
    low = std::fmin(low, factor);
    high = std::fmax(high, factor);
  }
  double const edge = std::exp(-a.radius * a.radius / (w * w));
  EXPECT_NEAR(2 * edge, 0.1696, 5e-5);
  EXPECT_NEAR(low, (1 - edge) * (1 - edge), 1e-3);
  EXPECT_NEAR(high, (1 + edge) * (1 + edge), 1e-3);
  EXPECT_NEAR(axis_factor(opening(pi * w), 1e7), 1, 2e-4);  // control: twice the aperture
}

// On the axis of a centred aperture the integral is elementary: u/u_0 = 1 - exp(-gamma a^2).
TEST(Diffraction, AxisInClosedForm) {
  for (double curvature : {0.0, 0.02, -0.3})
    for (double z : {0.3, 4.0, 90.0}) {
      BeamInPlane const beam{w, curvature, lambda};
      double const k = 2 * pi / lambda, a = 1.2 * w;
      Field const gamma{1 / (w * w), -0.5 * k * (curvature + 1 / z)};
      Field const ratio = field_behind(beam, opening(a), z, 0, 0) / free_field(beam, z, 0, 0);
      EXPECT_NEAR(std::abs(ratio - (1.0 - std::exp(-gamma * a * a))), 0, 1e-9) << curvature << ' ' << z;
    }
}

// A wide aperture changes nothing, wherever its centre and whatever its teeth.
TEST(Diffraction, WideOpen) {
  BeamInPlane const beam{w, 0.05, lambda};
  Opening wide = opening(6 * w, 0.4 * w, -0.2 * w);
  wide.tooth_height = 0.1 * w;
  for (unsigned teeth : {0u, 24u}) {
    wide.teeth = teeth;
    for (double x : {0.0, 0.7 * w}) {
      Field const free = free_field(beam, 12, x, 0.3 * w);
      EXPECT_NEAR(std::abs(field_behind(beam, wide, 12, x, 0.3 * w) - free) / std::abs(free), 0, 1e-7);
    }
  }
}

// Against a sum over the plane of the opening.
TEST(Diffraction, OffCentreAgainstTheSumOverThePlane) {
  double const k = 2 * pi / lambda, z = 30, a = 1.3 * w;
  Opening const off = opening(a, 0.5 * w, 0.1 * w);
  double const x = 0.4 * w, y = -0.3 * w;
  Field sum = 0;
  int const n = 1500;
  double const step = 2 * a / n;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double const px = off.x - a + (i + 0.5) * step, py = off.y - a + (j + 0.5) * step;
      if (std::hypot(px - off.x, py - off.y) > a) continue;
      double const path = ((x - px) * (x - px) + (y - py) * (y - py)) / (2 * z);
      sum += std::exp(Field{-(px * px + py * py) / (w * w), k * path}) * step * step;
    }
  Field const direct = k / (2 * pi * Field{0, 1} * z) * sum;
  Field const ours = field_behind(flat, off, z, x, y);
  EXPECT_NEAR(std::abs(ours - direct) / std::abs(direct), 0, 2e-3);
  Field const centred = field_behind(flat, opening(a), z, x, y);
  EXPECT_GT(std::abs(centred - direct) / std::abs(direct), 0.02);  // control: the offset forgotten
}

// The power behind the aperture is what it let through; what goes beyond `reach` falls like 1/reach.
double power_behind(Opening const& a, double z, double reach, int radial, int azimuths) {
  double sum = 0;
  for (int i = 0; i < radial; ++i)
    for (int j = 0; j < azimuths; ++j) {
      double const r = (i + 0.5) * reach / radial, angle = 2 * pi * j / azimuths;
      sum += std::norm(field_behind(flat, a, z, r * std::cos(angle), r * std::sin(angle))) * r;
    }
  return sum * reach / radial * 2 * pi / azimuths / (pi * w * w / 2);
}
TEST(Diffraction, PowerIsConserved) {
  double const z = 60;
  Opening const centred = opening(1.1 * w), off = opening(1.1 * w, 0.8 * w);
  Opening serrated = centred;
  serrated.tooth_height = 0.3 * w;
  EXPECT_NEAR(power_behind(centred, z, 16 * w, 800, 1) / (1 - clipped_share(flat, centred)), 1, 2e-3);
  double const behind = power_behind(off, z, 4 * w, 80, 12);
  EXPECT_NEAR(behind / (1 - clipped_share(flat, off)), 1, 0.015);
  EXPECT_GT(std::fabs(behind / (1 - clipped_share(flat, centred)) - 1), 0.1);  // control: the offset forgotten
  // Of random teeth only the mean field: less than what passes between them.
  EXPECT_LT(power_behind(serrated, z, 4 * w, 100, 1) / (1 - clipped_share(flat, serrated)), 0.995);
}

// A rim with given teeth: against a sum over the plane with the teeth cut out; and its mean over the phase of the teeth
// is the mean field of random ones.
TEST(Diffraction, GivenTeeth) {
  double const k = 2 * pi / lambda, z = 80;
  Opening a = opening(1.1 * w, 0.1 * w);
  a.tooth_height = 0.5 * w;
  a.teeth = 9;
  a.phase = 0.3;
  auto const rim = [&](double angle) {
    double const x = (angle - a.phase) / (2 * pi) * a.teeth;
    return a.radius - 0.5 * a.tooth_height + a.tooth_height * (1 - std::fabs(1 - 2 * (x - std::floor(x))));
  };
  double const px = 0.6 * w, py = 0.8 * w;
  Field sum = 0;
  int const n = 1600;
  double const reach = a.radius + 0.5 * a.tooth_height, step = 2 * reach / n;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double const x = -reach + (i + 0.5) * step, y = -reach + (j + 0.5) * step;
      if (std::hypot(x, y) > rim(std::atan2(y, x))) continue;
      double const path = ((px - a.x - x) * (px - a.x - x) + (py - y) * (py - y)) / (2 * z);
      sum += std::exp(Field{-((x + a.x) * (x + a.x) + y * y) / (w * w), k * path}) * step * step;
    }
  Field const direct = k / (2 * pi * Field{0, 1} * z) * sum;
  EXPECT_NEAR(std::abs(field_behind(flat, a, z, px, py) - direct) / std::abs(direct), 0, 3e-3);
  Opening random = a;
  random.teeth = 0;
  EXPECT_GT(std::abs(field_behind(flat, random, z, px, py) - direct) / std::abs(direct),
            0.01);  // control: without pattern
  Field mean = 0;
  int const phases = 16;
  for (int p = 0; p < phases; ++p) {
    a.phase = 2 * pi / a.teeth * p / phases;
    mean += field_behind(flat, a, z, px, py) / double(phases);
  }
  EXPECT_NEAR(std::abs(mean - field_behind(flat, random, z, px, py)) / std::abs(mean), 0, 1e-6);
}

// The field at any distance behind a centred opening by the radial integral (2 pi r J_0), Simpson's rule on steps far
// below a period. Nearer than a few metres of a rim of 0.3 m a quadrature in equal steps of r^2 misses the phase k r
// x/z.
Field by_rings(BeamInPlane const& beam, double radius, double z, double x) {
  double const k = 2 * pi / lambda, turns = k * radius * (radius * (beam.curvature + 1 / z) + 2 * x / z) / (4 * pi);
  int const steps = 2 * int(50 * turns + 1000);
  double const step = radius / steps;
  Field sum = 0;
  for (int j = 0; j <= steps; ++j) {
    double const r = j * step, weight = j == 0 || j == steps ? 1 : j % 2 ? 4 : 2;
    Field const phase{-r * r / (beam.w * beam.w), 0.5 * k * (beam.curvature + 1 / z) * r * r};
    sum += weight * r * std::cyl_bessel_j(0, k * r * x / z) * std::exp(phase);
  }
  return k / (Field{0, 1} * z) * std::polar(1.0, 0.5 * k * x * x / z) * sum * (step / 3);
}
TEST(Diffraction, WideRimsNearbyAgainstRings) {
  for (double number : {3.0, 30.0, 1e3, 1e4}) {  // Fresnel
    double const radius = 0.3, z = radius * radius / (lambda * number);
    BeamInPlane const beam{0.2, 1e-3, lambda};
    for (double x : {0.0, 0.05, 0.28, 0.31}) {
      Field const ours = field_behind(beam, opening(radius), z, x, 0), exact = by_rings(beam, radius, z, x);
      EXPECT_NEAR(std::abs(ours - exact), 0, 1e-6 * std::abs(free_field(beam, z, 0, 0))) << number << ' ' << x;
      if (x > 0.2) {
        Field const wrong = by_rings(beam, radius * (1 + 0.3 / number), z, x);  // control: the rim by a third of a ring
        EXPECT_GT(std::abs(ours - wrong), 1e-4 * std::abs(ours));
      }
    }
  }
}
// Off centre, by a sum over polar rings about the opening; and near the rim of a wide one the field goes over into that
// of a straight edge: a quarter of the free intensity on the geometric shadow (half the field).
TEST(Diffraction, StraightEdgeOfAWideRim) {
  BeamInPlane const beam{10, 0, lambda};  // even over the rim
  double const radius = 0.3;
  for (double number : {1e3, 1e4}) {
    double const z = radius * radius / (lambda * number);
    double const share =
        std::norm(field_behind(beam, opening(radius), z, radius, 0)) / std::norm(free_field(beam, z, radius, 0));
    EXPECT_NEAR(share, 0.25, 0.25 / std::sqrt(number));
    double const zone = std::sqrt(0.5 * lambda * z);  // inside by v = 1.217: the first maximum, 1.370
    double const most = std::norm(field_behind(beam, opening(radius), z, radius - 1.217 * zone, 0)) /
                        std::norm(free_field(beam, z, radius - 1.217 * zone, 0));
    EXPECT_NEAR(most, 1.370, 1.370 / std::sqrt(number));
    EXPECT_GT(std::fabs(share - 0.5), 0.1);  // control: half the intensity
  }
}

// Off centre and curved, close by: against a sum over rings of the opening and over the angle.
TEST(Diffraction, OffCentreNearbyAgainstRings) {
  double const radius = 0.1, z = radius * radius / (lambda * 100), k = 2 * pi / lambda;
  BeamInPlane const beam{0.08, -2e-3, lambda};
  Opening const off = opening(radius, 0.03, -0.02);
  double const px = 0.05, py = 0.01;
  Field sum = 0;
  int const rings = 6000, angles = 3000;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < angles; ++j) {
      double const r = (i + 0.5) * radius / rings, angle = 2 * pi * j / angles;
      double const x = off.x + r * std::cos(angle), y = off.y + r * std::sin(angle), rho2 = x * x + y * y;
      double const path = 0.5 * beam.curvature * rho2 + ((x - px) * (x - px) + (y - py) * (y - py)) / (2 * z);
      sum += r * std::exp(Field{-rho2 / (beam.w * beam.w), k * path});
    }
  Field const exact = k / (2 * pi * Field{0, 1} * z) * sum * (radius / rings * 2 * pi / angles);
  EXPECT_NEAR(std::abs(field_behind(beam, off, z, px, py) - exact) / std::abs(exact), 0, 2e-3);
  Field const centred = field_behind(beam, opening(radius), z, px, py);
  EXPECT_GT(std::abs(centred - exact) / std::abs(exact), 0.01);  // control: the offset forgotten
}

TEST(Diffraction, UnconvergedIntegralsAreErrors) {
  EXPECT_THROW(field_behind(flat, opening(w), 1e-9, w, 0), NumericalError);
}

}  // namespace
}  // namespace straytrace::testing::beams_diffraction
