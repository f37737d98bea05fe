// SPDX-License-Identifier: BSD-3-Clause
// The microfacet law (docs/reference/scatter/microfacet.md) against numbers it must give, each with a variant that must
// not: peak R/(4 pi alpha^2) and total at normal incidence, the normals' share of area, the bound by the reflectance.
#include "contract/optics/quadrature.hpp"

namespace straytrace::testing {
namespace {

// Total at normal incidence per R: 2 alpha^2 t/(alpha^2 + t^2)^2 is the density of t = tan(theta_h); light leaves at
// 2 theta_h, above the horizon for t < 1, and is shadowed by G1 = 2/(1 + sqrt(1 + alpha^2 tan^2 2 theta_h)).
double total_at_normal(double alpha, bool shadowed) {
  constexpr int n = 200000;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    double const x = (i + 0.5) / n, t = x * x;  // dense where the lobe is
    double const tan_out = 2 * t / (1 - t * t), square = alpha * alpha, spread = square + t * t;
    double const g = shadowed ? 2 / (1 + std::sqrt(1 + square * tan_out * tan_out)) : 1;
    sum += 2 * square * t / (spread * spread) * g * 2 * x / n;
  }
  return sum;
}

TEST(Microfacet, PeakAndTotalAtNormalIncidence) {
  Vec3 const up{0, 0, 1};
  for (double const alpha : {0.01, 0.1, 0.3, 0.7, 1.0}) {
    Microfacet const law = microfacet(alpha, 0.8, 0.8);
    EXPECT_NEAR(law.eval(up, up) * 4 * pi * alpha * alpha, 0.8, 1e-12);
    EXPECT_NEAR(law.albedo(1) / 0.8, total_at_normal(alpha, true), 2e-4) << alpha;
    EXPECT_GT(std::fabs(law.albedo(1) / 0.8 - 1.001 * total_at_normal(alpha, true)), 2e-4);  // control: 0.1 % too much
    if (alpha < 0.1) continue;
    EXPECT_GT(std::fabs(law.albedo(1) / 0.8 - total_at_normal(alpha, false)), 2e-4);  // control: G = 1
  }
}

// The small mirrors cover the surface: integral of D cos = 1, and those seen from any direction cover what is seen:
// integral of pdf over h alone, 4 (i.h) pdf dOmega_h = 1.
TEST(Microfacet, NormalsCoverTheSurface) {
  for (double const alpha : {0.05, 0.3, 1.0})
    for (double const degrees : {0.0, 60.0, 85.0}) {
      Microfacet const law = microfacet(alpha, 1, 1);
      Vec3 const wi = incoming(degrees);
      double covered = 0, seen = 0, unweighted = 0;
      constexpr int rings = 4000, turns = 360;
      for (int i = 0; i < rings; ++i) {
        double const x = (i + 0.5) / rings, tilt = pi / 2 * x * x, solid = std::sin(tilt) * pi * x / rings;
        for (int j = 0; j < turns; ++j) {
          SinCos const a = sincos_turn((j + 0.5) / turns);
          Vec3 const h{std::sin(tilt) * a.cos, std::sin(tilt) * a.sin, std::cos(tilt)};
          double const part = solid * 2 * pi / turns * law.normals(h), toward = std::fmax(0, dot(wi, h));
          covered += part * h.z;
          unweighted += part;
          seen += part * toward * 2 / (wi.z + law.slant(wi));
        }
      }
      EXPECT_NEAR(covered, 1, 1e-3);
      EXPECT_NEAR(seen, 1, 1e-3) << alpha << " " << degrees;
      EXPECT_TRUE(alpha < 0.3 || std::fabs(unweighted - 1) > 1e-2);  // control: the cosine forgotten
    }
}

// F of Schlick: `reflectance` at normal incidence, `grazing` at 90 deg, and at 60 deg R0 + (1 - R0)/32.
TEST(Microfacet, SchlickFactor) {
  Microfacet const law = microfacet(0.1, 0.04, 1);
  EXPECT_DOUBLE_EQ(law.factor(1), 0.04);
  EXPECT_DOUBLE_EQ(law.factor(0), 1);
  EXPECT_NEAR(law.factor(0.5), 0.04 + 0.96 / 32, 1e-15);
  EXPECT_GT(std::fabs(law.factor(0.5) - (0.04 + 0.96 / 16)), 1e-3);  // control: the fourth power
}

// Light is never made: no total, at any roughness and angle, exceeds the stated reflectance. Without the shadowing of
// the outgoing side (the Cook-Torrance value with G = G1(wi)) it would at grazing incidence.
TEST(Microfacet, TotalIsBelowTheReflectance) {
  double worst = 0, control = 0;
  for (double const alpha : {1e-4, 1e-3, 0.01, 0.1, 0.3, 0.6, 1.0}) {
    Microfacet const law = microfacet(alpha, 0.5, 0.5), sloped = microfacet(alpha, 0.04, 0.9);
    for (int i = 0; i <= 2000; ++i) {
      worst = std::fmax(worst, law.albedo(i / 2000.0) / 0.5);
      EXPECT_LE(sloped.albedo(i / 2000.0), 0.9);
    }
    for (double const degrees : incidences) {
      Vec3 const wi = incoming(degrees);
      Microfacet open = law;
      double sum = 0;
      constexpr int n = 64;
      for (int i = 0; i < n * n; ++i) {
        BsdfSample const s = open.sample(wi, (i % n + 0.5) / n, (i / n + 0.5) / n);
        if (!(s.pdf > 0)) continue;
        double const visible = (1 + law.slant(s.wo) / s.wo.z) / 2;  // 1/G1(wo)
        sum += law.eval(wi, s.wo) * s.wo.z / s.pdf * visible / (n * n);
      }
      control = std::fmax(control, sum / 0.5);
    }
  }
  EXPECT_LE(worst, 1 + 1e-12);
  EXPECT_GT(worst, 0.99);
  EXPECT_GT(control, 1 + 1e-3);
}

}  // namespace
}  // namespace straytrace::testing
