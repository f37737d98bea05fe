// SPDX-License-Identifier: BSD-3-Clause
// Smooth boundaries: docs/theory/surfaces.md, eq. 3.25 and 3.26, docs/theory/conventions.md (unitary interface), R2.03,
// R2.25, R2.28, R3.22 to R3.24, docs/theory/sampling.md.
#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "optics/coating/fresnel.hpp"
#include "optics/coating/specular.hpp"

namespace straytrace::optics_interface {
namespace {

constexpr double silica = 1.45003;

Amplitudes bare(double degrees, double n_in, double n_out) {
  return Fresnel{}.amplitudes(std::cos(degrees * degree), n_in, n_out, true);
}
double distance(Complex a, Complex b) { return std::sqrt(norm(a - b)); }

// R3.24: printed digits, half a unit of the last. The controls are the wrong index of the neighbouring glass and s for
// p.
TEST(optics_interface, fresnel_numbers) {
  auto const close = [](double value, double printed) { return std::fabs(value - printed) < 0.6e-6; };
  EXPECT_TRUE(close(bare(0, 1, silica).reflectance(), 0.033740));
  EXPECT_TRUE(close(norm(bare(45, 1, silica).rs), 0.080220));
  EXPECT_TRUE(close(norm(bare(45, 1, silica).rp), 0.006435));
  EXPECT_FALSE(close(bare(0, 1, 1.44963).reflectance(), 0.033740));
  EXPECT_FALSE(close(norm(bare(45, 1, silica).rp), 0.080220));
  // scene 7
  EXPECT_TRUE(close(bare(0, 1, 1.5).reflectance(), 0.04));
  EXPECT_TRUE(close(bare(0, 1, 1.44963).reflectance(), 0.033691));
}

// Power through a plate without interference, and its first ghost (R2.25): sums of powers of eq. 3.25.
TEST(optics_interface, plates_and_first_ghost) {
  auto const plate = [](double r) { return (1 - r) / (1 + r); };
  double const r = bare(0, 1, 1.5).reflectance(), t = bare(0, 1.5, 1).transmittance();
  EXPECT_NEAR(plate(r), 0.923077, 1e-6);
  EXPECT_NEAR(t * t * r * r, 1.4746e-3, 1e-7);
  EXPECT_NEAR(plate(bare(0, 1, 1.44963).reflectance()), 0.934815, 1e-6);
  EXPECT_GT(std::fabs((1 - r) * (1 - r) - 0.923077), 1e-3);  // control: no inner reflections
}

// R2.25: a wedge of 1 mrad, n = 1.45, sends its first ghost 2 n times the wedge, 2.90 mrad, off the main beam (5
// urad: sines and tangents); R_AR = 1e-4 on both faces: power 1e-8 of it. Control: 2 times the wedge.
TEST(optics_interface, ghost_of_a_wedge) {
  double const n = 1.45, wedge = 1e-3;
  Vec3 const first{0, 0, -1}, second{std::sin(wedge), 0, -std::cos(wedge)};  // normals towards the incoming light
  Vec3 inside, direct, ghost, dir{0, 0, 1};
  ASSERT_TRUE(refracted(dir, first, 1, n, inside));
  ASSERT_TRUE(refracted(inside, second, n, 1, direct));
  Vec3 const again = reflected(reflected(inside, second), first);
  ASSERT_TRUE(refracted(again, second, n, 1, ghost));
  double const angle = length(cross(direct, ghost));
  EXPECT_NEAR(angle, 2.90e-3, 5e-6);
  EXPECT_GT(std::fabs(2 * wedge - 2.90e-3), 5e-6);
  Amplitudes const ar = unitary_amplitudes(1e-4, 1e-4, 1 - 1e-4, 1 - 1e-4);
  EXPECT_NEAR(ar.reflectance() * ar.reflectance(), 1e-8, 1e-20);
}

// Brewster's angle arctan(n2/n1): r_p changes sign there, to 1e-3 deg of the printed value.
TEST(optics_interface, brewster_angle) {
  auto const vanishes_at = [](double degrees, double n) {
    return bare(degrees - 1e-3, 1, n).rp.re * bare(degrees + 1e-3, 1, n).rp.re < 0;
  };
  EXPECT_TRUE(vanishes_at(55.408, silica));
  EXPECT_TRUE(vanishes_at(55.4009, 1.44963));
  EXPECT_FALSE(vanishes_at(55.408, 1.44963));
}

// R3.23: beyond the critical angle, 43.602 deg, all power is reflected, to 1e-15, and nothing passes.
TEST(optics_interface, total_reflection) {
  EXPECT_GT(bare(43.602 - 1e-3, silica, 1).transmittance(), 1e-3);
  EXPECT_EQ(bare(43.602 + 1e-3, silica, 1).transmittance(), 0);
  EXPECT_GT(bare(43.6167 - 1e-3, 1.44963, 1).transmittance(), 1e-3);
  EXPECT_EQ(bare(43.6167 + 1e-3, 1.44963, 1).transmittance(), 0);
  for (double a : {43.7, 45.0, 60.0, 89.0, 89.9999}) {
    EXPECT_NEAR(norm(bare(a, silica, 1).rs), 1, 1e-15) << a;
    EXPECT_NEAR(norm(bare(a, silica, 1).rp), 1, 1e-15) << a;
  }
  // Phases of total reflection, tan(arg r_s/2) = -sqrt(sin^2 - n^-2)/cos with exp(-i w t): against the closed form;
  // control: the sign of the other time convention.
  Amplitudes const a = bare(60, silica, 1);
  double const wanted = -2 * std::atan(std::sqrt(0.75 - 1 / (silica * silica)) / 0.5);
  EXPECT_NEAR(std::atan2(a.rs.im, a.rs.re), wanted, 1e-14);
  EXPECT_GT(std::fabs(std::atan2(-a.rs.im, a.rs.re) - wanted), 0.1);
}

// |r|^2 + |t|^2 = 1; Stokes: r21 = -r12, t12 t21 - r12 r21 = 1 (power scaling). 1e-14 at all angles. Control: t as a
// ratio of fields.
TEST(optics_interface, energy_and_stokes_relations) {
  double field_ratio = 0;
  for (double n : {1.0001, silica, 2.5835, 4.0})
    for (int i = 0; i <= 1000; ++i) {
      double const cos_i = i / 1000.0, cos_o = std::sqrt(1 - (1 - cos_i * cos_i) / (n * n));
      Amplitudes const a = Fresnel{}.amplitudes(cos_i, 1, n, true), b = Fresnel{}.amplitudes(cos_o, n, 1, false);
      ASSERT_NEAR(norm(a.rs) + norm(a.ts), 1, 1e-14);
      ASSERT_NEAR(norm(a.rp) + norm(a.tp), 1, 1e-14);
      if (i < 20) continue;  // cos_o has lost digits
      ASSERT_LT(distance(b.rs, -a.rs) + distance(b.rp, -a.rp), 1e-11);
      ASSERT_LT(distance(a.ts * b.ts - a.rs * b.rs, {1, 0}), 1e-11);
      ASSERT_LT(distance(a.tp * b.tp - a.rp * b.rp, {1, 0}), 1e-11);
      double const field = a.ts.re * std::sqrt(cos_i / (n * cos_o));
      field_ratio = std::fmax(field_ratio, std::fabs(norm(a.rs) + field * field - 1));
    }
  EXPECT_GT(field_ratio, 0.1);
}

// Section 0.3: at normal incidence the two polarisations are one. The p field is along k x s, which k x s turns over,
// so r_p = -r_s and t_p = t_s, for every kind of interface.
TEST(optics_interface, normal_incidence_signs) {
  Amplitudes const a = bare(0, 1, silica);
  EXPECT_LT(a.rs.re, 0);  // a denser medium turns the field over
  EXPECT_NEAR(a.rp.re, -a.rs.re, 1e-15);
  EXPECT_NEAR(a.tp.re, a.ts.re, 1e-15);
  Optic optic;
  optic.reflect = 0.3;
  optic.transmit = 0.6;
  Amplitudes const fixed = specular_amplitudes({}, optic, 1, 1, 1, true);
  EXPECT_EQ(distance(fixed.rp, -fixed.rs), 0);
  EXPECT_NEAR(fixed.reflectance(), 0.3, 1e-15);
  EXPECT_NEAR(fixed.transmittance(), 0.6, 1e-15);
  Amplitudes const metal = Fresnel{{1.3, 10}}.amplitudes(1, 1, 1, true);
  EXPECT_LT(distance(metal.rp, -metal.rs), 1e-15);
}

// R of a metal at normal incidence ((n-1)^2 + k^2)/((n+1)^2 + k^2), 1e-14; SiC of requirements 8.1: 0.19526. Control: k
// left out.
TEST(optics_interface, opaque_bodies) {
  auto const exact = [](double n, double k) { return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k); };
  Amplitudes const gold = Fresnel{{0.25, 7.0}}.amplitudes(1, 1, 1, true);
  EXPECT_NEAR(gold.reflectance(), exact(0.25, 7), 1e-14);
  EXPECT_GT(std::fabs(gold.reflectance() - exact(0.25, 0)), 0.1);
  EXPECT_EQ(gold.transmittance(), 0);
  EXPECT_NEAR((Fresnel{{2.5835, 0}}.amplitudes(1, 1, 1, false).reflectance()), 0.19526, 5e-6);
  for (double a : {0.0, 0.3, 0.9})  // a transparent body: same r as the boundary between media
    EXPECT_LT(distance((Fresnel{{silica, 0}}.amplitudes(1 - a, 1, 1, true).rp),
                       Fresnel{}.amplitudes(1 - a, 1, silica, true).rp),
              1e-14);
}

// Sum of the port powers of a Michelson with arm phases a and b, of one watt in: both passages through the splitter S.
double michelson(Complex r1, Complex r2, Complex t, double a, double b) {
  Complex const arm_a = exp_turns({a, 0}), arm_b = exp_turns({b, 0});
  Complex const back = r1 * r1 * arm_a + t * t * arm_b, out = t * r1 * arm_a + r2 * t * arm_b;
  return norm(back) + norm(out);
}

// R2.03: any lossless Michelson gives back what it gets, 1e-12, whatever its splitter is made of. Control: pi at each
// reflection and nothing at transmission (C3.1) gives 2 W.
TEST(optics_interface, michelson_conserves_power) {
  Rng rng(7, 0, 0, Stream::lobe);
  for (int i = 0; i < 200; ++i) {
    double const cos_i = 0.05 + 0.95 * rng.uniform(), share = rng.uniform(), a = rng.uniform(), b = rng.uniform();
    Amplitudes const u = unitary_amplitudes(share, share, 1 - share, 1 - share);
    ASSERT_NEAR(michelson(u.rs, u.rs, u.ts, a, b), 1, 1e-12);
    ASSERT_NEAR(michelson(u.rp, u.rp, u.tp, a, b), 1, 1e-12);
    double const n = 1 + 2 * rng.uniform(), cos_o = std::sqrt(1 - (1 - cos_i * cos_i) / (n * n));
    Amplitudes const f = Fresnel{}.amplitudes(cos_i, 1, n, true), g = Fresnel{}.amplitudes(cos_o, n, 1, false);
    ASSERT_NEAR(michelson(f.rs, g.rs, f.ts, a, b), 1, 1e-12);
    ASSERT_NEAR(michelson(f.rp, g.rp, f.tp, a, b), 1, 1e-12);
  }
  double const half = std::sqrt(0.5);
  EXPECT_NEAR(michelson({-half, 0}, {-half, 0}, {half, 0}, 0.1, 0.1), 2, 1e-12);
}

// R3.22 to 1e-15; Snell's law as a vector: in the plane of incidence, n sin conserved, to 1e-14. Control: indices
// swapped.
TEST(optics_interface, directions) {
  Rng rng(8, 0, 0, Stream::lobe);
  double swapped = 0;
  for (int i = 0; i < 1000; ++i) {
    Vec3 const normal = unit({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5});
    Vec3 dir = unit({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5});
    if (dot(dir, normal) > 0) dir = -dir;
    Vec3 const mirrored = reflected(dir, normal);
    ASSERT_NEAR(dot(mirrored, normal), -dot(dir, normal), 1e-15);
    Vec3 out;
    ASSERT_TRUE(refracted(dir, normal, 1, silica, out));
    ASSERT_LT(length(cross(dir, normal) - silica * cross(out, normal)), 1e-14);
    ASSERT_NEAR(length(out), 1, 1e-15);
    ASSERT_LT(dot(out, normal), 0);
    swapped = std::fmax(swapped, length(silica * cross(dir, normal) - cross(out, normal)));
    Vec3 back;  // the way back is the same; near grazing the angle in glass is less precise: 1e-15/cos
    ASSERT_TRUE(refracted(-out, -normal, silica, 1, back));
    ASSERT_LT(length(back + dir) * std::fabs(dot(dir, normal)), 1e-14);
  }
  EXPECT_GT(swapped, 0.1);
  Vec3 const steep{std::sin(43.7 * degree), 0, -std::cos(43.7 * degree)};
  Vec3 out;
  EXPECT_FALSE(refracted(steep, {0, 0, 1}, silica, 1, out));
  EXPECT_TRUE(refracted(steep, {0, 0, 1}, silica, silica, out));
  EXPECT_LT(length(out - steep), 1e-15);
}

// The light that BSDF models scatter is subtracted from a lossless boundary, not from stated powers.
TEST(optics_interface, scatter_is_taken_from_lossless_boundaries) {
  std::vector<Fresnel> list(1);
  SpecularPool pool;
  std::get<0>(pool.arrays) = {list.data(), 1};
  Optic glass;
  glass.has_interface = true;
  SpecularShares const s = specular_shares(pool, glass, 0.7, 1, silica, true, 1e-3);
  EXPECT_NEAR(s.reflect + s.transmit, 1 - 1e-3, 1e-15);
  SpecularShares const clean = specular_shares(pool, glass, 0.7, 1, silica, true);
  EXPECT_NEAR(clean.reflect + clean.transmit, 1, 1e-15);
  Optic coated;
  coated.reflect = 0.9;
  EXPECT_EQ(specular_shares(pool, coated, 0.7, 1, silica, true, 1e-3).reflect, 0.9);
}

}  // namespace
}  // namespace straytrace::optics_interface
