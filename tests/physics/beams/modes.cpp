// SPDX-License-Identifier: BSD-3-Clause
// Gaussian beams of general astigmatism in space (docs/theory/conventions.md and docs/theory/interferometer.md;
// docs/theory/beams.md): free flight, Gouy phase, tilted curved mirrors and refracting faces against closed forms and
// the phase on the surface itself.
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "beams/eigenmode.hpp"
#include "beams/mode.hpp"
#include "support/beams_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::beams_modes {
namespace {

using testing::wavefront;

using testing::Dice;
constexpr double nd_yag = 1.064e-6;  // m
constexpr Vec3 along_z{0, 0, 1};

double difference(Mode const& a, Mode const& b) {  // of Q, relative; frames are the same
  double const size = std::abs(b.q11) + std::abs(b.q12) + std::abs(b.q22);
  return (std::abs(a.q11 - b.q11) + std::abs(a.q12 - b.q12) + std::abs(a.q22 - b.q22)) / size;
}
double handedness(Mode const& m) { return dot(cross(m.e1, m.e2), m.travel); }

TEST(mode, flight_of_a_circular_beam_is_eq_6_1) {
  double const w0 = 2e-3, z_r = pi * w0 * w0 / nd_yag;
  Mode const waist = circular_mode({1, 2, 3}, along_z, w0, 0, nd_yag);
  for (double z : {-30.0, 0.3, 11.0, 500.0}) {
    Mode const there = propagated(waist, z);
    EXPECT_NEAR(spot(there).major / (w0 * std::hypot(1, z / z_r)), 1, 1e-13);
    EXPECT_NEAR(spot(there).minor, spot(there).major, 1e-15);
    EXPECT_NEAR(wavefront(there).first * (z + z_r * z_r / z), 1, 1e-12);
    EXPECT_NEAR(gouy(waist, z), std::atan(z / z_r), 1e-13);
    EXPECT_NEAR(length(there.origin - Vec3{1, 2, 3 + z}), 0, 1e-12);
    EXPECT_LT(difference(propagated(there, -z), waist), 1e-12);
  }
}

// Two flights are one; the phase counts on without jumps, also where det(1 + z Q) turns by more than pi.
TEST(mode, gouy_phase_is_continuous_and_additive) {
  Dice dice(4);
  for (int i = 0; i < 20; ++i) {
    Mode m = testing::twisted_mode(dice, {}, along_z, 1e-3, nd_yag);
    m.q11 -= 1, m.q22 -= 1;  // both axes pass a focus
    double sum = 0, one_go = 0, jumped = 0;
    Mode here = m;
    std::complex<double> det = 1;
    for (int step = 0; step < 400; ++step) {
      sum += gouy(here, 0.2);
      here = propagated(here, 0.2);
      double const z = 0.2 * (step + 1);
      det = (1.0 + z * m.q11) * (1.0 + z * m.q22) - z * z * m.q12 * m.q12;
      EXPECT_NEAR(gouy(m, z), sum, 1e-11);
      EXPECT_NEAR(std::remainder(2 * sum - std::arg(det), 2 * pi), 0, 1e-10);
      one_go = gouy(m, z), jumped = 0.5 * std::arg(det);
    }
    EXPECT_GT(one_go, pi / 2);                 // beyond the far field of one axis
    EXPECT_GT(std::fabs(one_go - jumped), 3);  // the principal value of the root forgets a turn
    EXPECT_LT(difference(here, propagated(m, 80)), 1e-10);
  }
}

// Behind a cylindrical lens the two axes focus at different places, each with its own phase.
TEST(mode, gouy_phases_of_the_axes_are_independent) {
  Mode const m = elliptic_mode({}, {1, 0, 0}, along_z, {1e-3, 2e-3}, {-1, 0.1}, nd_yag);
  for (double z : {0.5, 1.0, 3.0}) {
    auto const axis = axis_gouy(m, z);
    for (int i : {0, 1}) {
      double const w = i == 0 ? 1e-3 : 2e-3, bend = i == 0 ? -1 : 0.1;
      auto const q = std::conj(1.0 / std::complex<double>(bend, nd_yag / (pi * w * w)));  // z + i z_R
      EXPECT_NEAR(axis[i], std::atan2(q.real() + z, q.imag()) - std::atan2(q.real(), q.imag()), 1e-12);
    }
    EXPECT_NEAR(gouy(m, z), 0.5 * (axis[0] + axis[1]), 1e-15);
    EXPECT_GT(std::fabs(axis[0] - axis[1]), 0.1);
  }
}

TEST(mode, spot_and_wavefront_have_the_axes_they_were_made_with) {
  Vec3 const e1 = unit({3, 4, 0});
  Mode const m = elliptic_mode({}, e1, along_z, {2e-3, 1e-3}, {0.5, 3}, nd_yag);
  Mode turned = m;  // the same beam in another frame
  turned.e1 = {1, 0, 0}, turned.e2 = {0, 1, 0};
  double const c = 0.6, s = 0.8;
  turned.q11 = c * c * m.q11 + s * s * m.q22;
  turned.q22 = s * s * m.q11 + c * c * m.q22;
  turned.q12 = c * s * (m.q11 - m.q22);
  for (Mode const& same : {m, turned}) {
    EXPECT_NEAR(spot(same).major, 2e-3, 1e-15);
    EXPECT_NEAR(spot(same).minor, 1e-3, 1e-15);
    EXPECT_NEAR(std::fabs(dot(spot(same).axis, e1)), 1, 1e-14);
    EXPECT_NEAR(wavefront(same).first, 3, 1e-13);
    EXPECT_NEAR(wavefront(same).second, 0.5, 1e-13);
    EXPECT_NEAR(std::fabs(dot(wavefront(same).axis, m.e2)), 1, 1e-14);
    EXPECT_NEAR(intensity(same, 1e-3 * e1), intensity(m, 1e-3 * e1), 1e-6);
    EXPECT_NEAR(intensity(same, 2e-3 * e1) / intensity(same, {}), std::exp(-2), 1e-13);
    EXPECT_NEAR(std::norm(field(same, {1e-3, 2e-3, 0.4})) / intensity(same, {1e-3, 2e-3, 0.4}), 1, 1e-12);
  }
  EXPECT_GT(std::fabs(intensity(m, 1e-3 * m.e2) / intensity(m, 1e-3 * e1) - 1), 0.1);
}

// Curved mirror at incidence theta, plane of incidence along e1: RoC cos(theta) in it, RoC/cos(theta) across it.
TEST(mode, tilted_mirror_has_the_textbook_focal_lengths) {
  double const roc = 0.2;
  Mode const m = elliptic_mode({}, {1, 0, 0}, along_z, {1e-3, 2e-3}, {0.3, -0.2}, nd_yag);
  for (double theta : {0.0, 0.2, pi / 4, 1.2}) {
    Vec3 const normal{std::sin(theta), 0, -std::cos(theta)};
    for (Vec3 side : {normal, -normal}) {  // the normal towards either side
      double const sign = dot(side, normal);
      Mode const out = reflected(m, side, spherical_mirror({}, side, sign * roc).curvature);
      EXPECT_NEAR(out.q11.real(), 0.3 - 2 / (roc * std::cos(theta)), 1e-11);
      EXPECT_NEAR(out.q22.real(), -0.2 - 2 * std::cos(theta) / roc, 1e-11);
      EXPECT_NEAR(out.q11.imag(), m.q11.imag(), 1e-12);
      EXPECT_NEAR(handedness(out), 1, 1e-14);
      EXPECT_NEAR(dot(out.travel, reflected(m.travel, normal)), 1, 1e-14);
      if (theta > 0.1) {
        EXPECT_GT(std::fabs(out.q11.real() - (0.3 - 2 / roc)), 0.1);  // without cos theta
      }
    }
  }
}

// Refracting sphere at incidence theta (Coddington): n' cos^2 t'/s' = n cos^2 t/s + (n' cos t' - n cos t)/R along the
// plane of incidence, the same without squares across it. Sizes: the spot is wider by cos t'/cos t in that plane.
TEST(mode, tilted_face_obeys_coddington) {
  double const roc = 0.5, n1 = 1.2, n2 = 1.75;
  Mode const m = elliptic_mode({}, {1, 0, 0}, along_z, {1e-3, 2e-3}, {0.3, -0.2}, nd_yag / n1);
  for (double theta : {0.0, 0.3, 1.0}) {
    Vec3 const normal{std::sin(theta), 0, -std::cos(theta)};
    Mode const out = refracted(m, normal, spherical_mirror({}, normal, roc).curvature, n1, n2);
    double const c1 = std::cos(theta), c2 = std::sqrt(1 - std::pow(n1 / n2 * std::sin(theta), 2));
    double const bend = (n2 * c2 - n1 * c1) / roc;
    EXPECT_NEAR(out.q11.real(), (n1 * c1 * c1 * 0.3 + bend) / (n2 * c2 * c2), 1e-12);
    EXPECT_NEAR(out.q22.real(), (n1 * -0.2 + bend) / n2, 1e-12);
    EXPECT_NEAR(spot(out).minor, 1e-3 * c2 / c1, 1e-15);
    EXPECT_NEAR(spot(out).major, 2e-3, 1e-15);
    EXPECT_NEAR(out.wavelength * n2, nd_yag, 1e-20);
    EXPECT_NEAR(handedness(out), 1, 1e-14);
    if (theta > 0) {
      EXPECT_GT(std::fabs(out.q11.real() - (n1 * 0.3 + bend) / n2), 1e-3);  // without squares
    }
  }
  EXPECT_THROW(refracted(m, unit({1, 0, -1}), spherical_mirror({}, along_z, infinity).curvature, 1.75, 1.2),
               NumericalError);
}

// On the curved surface itself the phases of both waves agree up to third order in the distance from the chief ray, at
// any incidence, for twisted beams and surfaces; with a wrong curvature they differ by much more.
double phase_misfit(Mode const& in, Mode const& out, Vec3 normal, SurfaceCurvature const& c, double size) {
  double worst = 0;
  for (int i = 0; i < 16; ++i) {
    double const x = size * std::cos(i * pi / 8), y = size * std::sin(i * pi / 8);
    double const height = 0.5 * (c.aa * x * x + 2 * c.ab * x * y + c.bb * y * y);
    Vec3 const p = x * c.a + y * c.b + height * normal;
    auto const phase = [&](Mode const& m) {
      double const u = dot(p, m.e1), v = dot(p, m.e2);
      double const q = m.q11.real() * u * u + 2 * m.q12.real() * u * v + m.q22.real() * v * v;
      return m.wave_number() * (dot(p, m.travel) + 0.5 * q);
    };
    worst = std::max(worst, std::fabs(phase(in) - phase(out)));
  }
  return worst;
}

TEST(mode, phases_agree_on_any_surface_to_second_order) {
  Dice dice(7);
  for (int i = 0; i < 50; ++i) {
    Vec3 const normal = dice.near({0, 0, -1}, 1.2);
    SurfaceCurvature const c = dice.curved(normal, 0.5);
    Mode const in = testing::twisted_mode(dice, {}, along_z, 1e-3, nd_yag);
    SurfaceCurvature half = c;
    half.aa *= 0.5;
    half.ab += 0.2;
    for (bool mirror : {true, false}) {
      auto const leave = [&](SurfaceCurvature const& k) {
        return mirror ? reflected(in, normal, k) : refracted(in, normal, k, 1, 1.6);
      };
      double const small = phase_misfit(in, leave(c), normal, c, 1e-4),
                   large = phase_misfit(in, leave(c), normal, c, 2e-4);
      double const wrong = phase_misfit(in, leave(half), normal, c, 1e-4);
      EXPECT_LT(small, 0.1 * wrong);
      EXPECT_GT(large, 7 * small);  // third order: a factor of 8
      EXPECT_NEAR(phase_misfit(in, leave(half), normal, c, 2e-4) / wrong, 4, 0.5);
    }
  }
}

// A wedge with flat faces: q of eq. 6.2 with one factor (cos out/cos in)^2 per face in the plane of incidence.
TEST(mode, flat_wedge_squeezes_the_beam_in_its_plane) {
  double const n = 1.5, t1 = 0.5, wedge = 0.1;
  double const g1 = std::asin(std::sin(t1) / n), g2 = g1 - wedge, t2 = std::asin(n * std::sin(g2));
  Vec3 const first{std::sin(t1), 0, -std::cos(t1)};
  Mode const in = circular_mode({}, along_z, 1e-3, 0.5, nd_yag);
  Mode const aligned = elliptic_mode({}, {1, 0, 0}, along_z, {1e-3, 1e-3}, {0.5, 0.5}, nd_yag);
  EXPECT_LT(difference(in, aligned), 1e-15);
  auto const flat = [](Vec3 normal) { return spherical_mirror({}, normal, infinity).curvature; };
  Mode const glass = refracted(aligned, first, flat(first), 1, n);
  Frame const f{glass.e1, glass.e2, glass.travel};
  Vec3 const second = unit(f.to_world({std::sin(g2), 0, -std::cos(g2)}));
  Mode const out = refracted(propagated(glass, 0.02), second, flat(second), n, 1);
  double const s1 = std::cos(g1) / std::cos(t1), s2 = std::cos(t2) / std::cos(g2);
  auto const q = 1.0 / aligned.q11;
  EXPECT_LT(std::abs(1.0 / out.q11 - s2 * s2 * (s1 * s1 * q + 0.02 / n)), 1e-13);
  EXPECT_LT(std::abs(1.0 / out.q22 - (q + 0.02 / n)), 1e-13);
  EXPECT_GT(std::abs(1.0 / out.q11 - (q + 0.02 / n)), 1e-2);
  EXPECT_NEAR(std::acos(dot(out.travel, in.travel)), std::fabs(t1 - t2 - wedge), 1e-12);
}

TEST(mode, a_reversed_beam_retraces_its_way) {
  Dice dice(3);
  Mode const start = testing::twisted_mode(dice, {}, along_z, 1e-3, nd_yag);
  Vec3 const normal = unit({0.4, 0.3, -1});
  SurfaceCurvature const c = dice.curved(normal, 0.7);
  Mode const there = refracted(propagated(start, 0.8), normal, c, 1, 1.5);
  Mode const home = reversed(propagated(refracted(reversed(there), normal, c, 1.5, 1), 0.8));
  for (Vec3 p : {Vec3{1e-3, 0, 0}, {0, 1e-3, 0}, {7e-4, -5e-4, 0}}) {
    EXPECT_LT(std::abs(field(home, p) / field(start, p) - 1.0), 1e-9);
    EXPECT_LT(std::abs(std::conj(field(reversed(start), p)) / field(start, p) - 1.0), 1e-12);
    EXPECT_GT(std::abs(field(reversed(start), p) / field(start, p) - 1.0), 1e-2);  // not conjugate
  }
  EXPECT_NEAR(handedness(reversed(start)), 1, 1e-15);
}

}  // namespace
}  // namespace straytrace::beams_modes
