// SPDX-License-Identifier: BSD-3-Clause
// BSDF models against closed forms and published numbers: docs/theory/sampling.md, requirements R2.29, R2.30,
// R2.32, docs/theory/surfaces.md, eq. 3.5 to 3.24. Next to each check a variant that must fail it.
#include <gtest/gtest.h>

#include "contract/optics/quadrature.hpp"
#include "optics/scatter/mie.hpp"
#include "optics/scatter/roughness.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

// R2.29: two-sided profile spectrum 1e-25 m^3, flat from 1e3 to 1e6 1/m: sigma = 0.447 nm (three digits). The control
// counts one side only.
TEST(height_spectrum, rms_of_a_flat_profile_r2_29) {
  HeightSpectrum const flat{{1e3, 1e-25}, {1e6, 1e-25}};
  EXPECT_NEAR(std::sqrt(variance_1d(flat, 1e3, 1e6)), 0.447e-9, 0.0005e-9);
  EXPECT_GT(std::fabs(std::sqrt(variance_1d(flat, 1e3, 1e6) / 2) - 0.447e-9), 0.0005e-9);
}

// eq. 3.6 for S2 = A f^-3: 2 pi A (1/f1 - 1/f2). Tolerance: quadrature, 1e-6. The control forgets the factor f.
TEST(height_spectrum, rms_of_a_surface_eq_3_6) {
  HeightSpectrum const s{{1e3, 1e-30 * 1e-9}, {1e6, 1e-30 * 1e-18}};
  double const exact = 2 * pi * 1e-30 * (1e-3 - 1e-6);
  EXPECT_LT(deviation(variance_2d(s, 1e3, 1e6), exact), 1e-6);
  EXPECT_GT(deviation(pi * variance_1d(s, 1e3, 1e6), exact), 0.1);
}

// eq. 3.7: S2 = A f^-m has the two-sided profile A sqrt(pi) Gamma((m-1)/2)/Gamma(m/2) f^(1-m); back again within 2e-3
// (quadrature). The control takes the one-sided profile for the two-sided one: a factor 2.
TEST(height_spectrum, surface_of_a_profile_eq_3_7) {
  for (double m : {2.2, 3.0, 3.6}) {
    double const amplitude = 1e-30, factor = std::sqrt(pi) * std::tgamma((m - 1) / 2) / std::tgamma(m / 2);
    HeightSpectrum profile;
    for (double f : {1e3, 1e4, 1e5, 1e6}) profile.push_back({f, amplitude * factor * std::pow(f, 1 - m)});
    for (SpectrumPoint const& p : surface_of_profile(profile)) {
      double const exact = amplitude * std::pow(p.f, -m);
      EXPECT_LT(deviation(p.value, exact), 2e-3) << m << " " << p.f;
      EXPECT_GT(deviation(2 * p.value, exact), 2e-3);
    }
  }
}

// eq. 3.10, docs/theory/sampling.md and R2.30, to the printed digits. The control has 2 pi for 4 pi.
TEST(total_scatter, of_a_smooth_surface_row_6) {
  struct Case {
    double rms, wavelength, tis, tolerance;
  };
  for (Case const& c : {Case{5e-9, 500e-9, 0.015791, 4e-5}, Case{0.1e-9, 1064e-9, 1.3949e-6, 4e-5},
                        Case{0.1e-9, 1550e-9, 6.573e-7, 1e-4}, Case{0.5e-9, 1064e-9, 34.9e-6, 2e-3}}) {
    EXPECT_LT(deviation(tis_smooth(c.rms, 1, c.wavelength), c.tis), c.tolerance);
    EXPECT_GT(deviation(tis_smooth(c.rms / 2, 1, c.wavelength), c.tis), c.tolerance);
  }
  EXPECT_LT(deviation(tis_moderate(80e-9, 1, 1e-6), 1 - std::exp(-std::pow(4 * pi * 0.08, 2))), 1e-12);
}

// The total scatter follows from the roughness when the lobe is narrow: knee 1/b = 1e-3, slope 4.5, so that all of it
// stays within the hemisphere. Rayleigh-Rice: (4 pi sigma cos/lambda)^2 within 1 % (the lobe is not infinitely narrow);
// Harvey-Shack of a moderately rough surface: the exponential form. Each theory is the other's control at this
// roughness.
TEST(roughness, total_scatter_eq_3_10) {
  double const rms = 0.06;
  Roughness const smooth = k_correlation(Theory::rayleigh_rice, rms, 1000, 3.5),
                  rough = k_correlation(Theory::harvey_shack, rms, 1000, 3.5);
  for (double degrees : {0.0, 45.0}) {
    double const cosine = std::cos(degrees * pi / 180);
    EXPECT_LT(deviation(smooth.albedo(cosine), tis_smooth(rms, cosine, 1)), 0.01) << degrees;
    EXPECT_LT(deviation(rough.albedo(cosine), tis_moderate(rms, cosine, 1)), 0.01) << degrees;
    EXPECT_GT(deviation(smooth.albedo(cosine), tis_moderate(rms, cosine, 1)), 0.05) << degrees;
    EXPECT_GT(deviation(rough.albedo(cosine), tis_smooth(rms, cosine, 1)), 0.05) << degrees;
  }
}

// eq. 3.8 and 3.12: Harvey-Shack over Rayleigh-Rice is (cos_i + cos_s)^2/(4 cos_i cos_s): 1.125 at (0, 60 deg), 1 at
// equal angles. Smooth surface, so that exp(-g) = 1 within 1e-6.
TEST(roughness, harvey_shack_over_rayleigh_rice) {
  Roughness const rr = k_correlation(Theory::rayleigh_rice, 1e-5, 50, 2.2),
                  hs = k_correlation(Theory::harvey_shack, 1e-5, 50, 2.2);
  Vec3 const up{0, 0, 1}, out = incoming(60, 0.3), in = incoming(60, 0.9);
  EXPECT_NEAR(hs.eval(up, out) / rr.eval(up, out), 1.125, 1e-5);
  EXPECT_NEAR(hs.eval(in, out) / rr.eval(in, out), 1, 1e-5);
  EXPECT_GT(std::fabs(hs.eval(up, incoming(61)) / rr.eval(up, incoming(61)) - 1.125), 1e-3);
}

// eq. 3.13 last line, and eq. 3.8 for a small angle: beta = 16 pi^2/lambda^4 S2(theta/lambda).
TEST(roughness, k_correlation_at_normal_incidence_eq_3_13) {
  Roughness const law = k_correlation(Theory::rayleigh_rice, 1e-3, 50, 2.2);
  for (double degrees : {0.1, 1.0, 10.0, 70.0}) {
    double const s = std::sin(degrees * pi / 180), c = std::cos(degrees * pi / 180);
    double const exact = 16 * pi * pi * c * law.a / std::pow(1 + std::pow(50 * s, 2), 1.6);
    EXPECT_LT(deviation(law.eval({0, 0, 1}, incoming(degrees)), exact), 1e-9);
    EXPECT_GT(deviation(law.eval({0, 0, 1}, incoming(1.01 * degrees)), exact), 1e-6);
  }
}

// eq. 3.9 in the specular direction: Q_ss = R_s, Q_pp = R_p (eq. 3.25), no cross terms; the mean is reciprocal. The
// control is off by 1 deg.
TEST(roughness, polarisation_factors_eq_3_9) {
  PolarisationFactor const glass{2.25, 0, 1};
  for (double degrees : {20.0, 56.0, 80.0}) {
    Vec3 const in = incoming(degrees), out = specular(in);
    double const c1 = in.z, c2 = std::sqrt(1 - (1 - c1 * c1) / 2.25), rs = (c1 - 1.5 * c2) / (c1 + 1.5 * c2),
                 rp = (1.5 * c1 - c2) / (1.5 * c1 + c2);
    auto const q = glass.each(in, out);
    EXPECT_NEAR(q.ss, rs * rs, 1e-12);
    EXPECT_NEAR(q.pp, rp * rp, 1e-12);
    EXPECT_NEAR(q.sp + q.ps, 0, 1e-12);
    EXPECT_GT(std::fabs(glass.each(in, specular(incoming(degrees + 1))).ss - rs * rs), 1e-4);
  }
  PolarisationFactor const metal{-50, 3, 1};
  EXPECT_NEAR(metal.mean(incoming(20, 0.1), incoming(70, 0.4)), metal.mean(incoming(70, 0.4), incoming(20, 0.1)),
              1e-12);
}

// eq. 3.15 and row 6: b0 = 1, l = 0.01, s = -1.5: 0.011310048; s = -2 has its own form. Tolerance of the quadrature:
// 3e-4.
TEST(harvey, total_scatter_eq_3_15) {
  Harvey const law = harvey(1, 0.01, -1.5);
  EXPECT_LT(deviation(law.tis(), 0.011310048), 1e-7);
  EXPECT_LT(deviation(law.albedo(1), 0.011310048), 3e-4);
  EXPECT_LT(deviation(harvey(1, 0.01, -2).albedo(1), pi * 1e-4 * std::log(1 + 1e4)), 3e-4);
  EXPECT_LT(deviation(harvey(1, 0.01, -2 + 1e-7).tis(), harvey(1, 0.01, -2).tis()), 1e-6);
  EXPECT_GT(deviation(harvey(1, 0.01, -1.51).albedo(1), 0.011310048), 3e-4);
}

// eq. 3.17, row 6. The control has g = 1.99 and 1.51.
TEST(abg, total_scatter_row_6) {
  EXPECT_LT(deviation(abg(1e-7, 1e-6, 2).albedo(1), 4.340271e-6), 3e-4);
  EXPECT_LT(deviation(abg(1e-6, 1e-5, 1.5).albedo(1), 1.223906e-5), 3e-4);
  EXPECT_GT(deviation(abg(1e-7, 1e-6, 1.99).albedo(1), 4.340271e-6), 3e-4);
  EXPECT_GT(deviation(abg(1e-6, 1e-5, 1.51).albedo(1), 1.223906e-5), 3e-4);
}

// Gaussian lobe at normal incidence: 2 pi w^2 peak (1 - exp(-1/(2 w^2))).
TEST(gaussian, total_scatter) {
  for (double w : {0.01, 0.3, 2.0}) {
    double const exact = 2 * pi * w * w * 0.1 * -std::expm1(-1 / (2 * w * w));
    EXPECT_LT(deviation(gaussian(0.1, w).albedo(1), exact), 5e-4) << w;
    EXPECT_GT(deviation(gaussian(0.1, 1.01 * w).albedo(1), exact), w < 1 ? 5e-3 : 5e-4) << w;
  }
}

// Row 8: Mie efficiencies and asymmetry, to the printed digits; the integral of the intensity is pi x^2 Q_sca. The
// control has m = 1.501.
TEST(mie, published_numbers_row_8) {
  MieSphere const small = mie(10, 1.5, {}), large = mie(100, 1.5, {});
  EXPECT_NEAR(small.q_ext, 2.881999, 1e-6);
  EXPECT_NEAR(small.asymmetry, 0.742913, 1e-6);
  EXPECT_NEAR(large.q_ext, 2.094388, 1e-6);
  EXPECT_NEAR(large.asymmetry, 0.818245, 1e-6);
  EXPECT_GT(std::fabs(mie(10, 1.501, {}).q_ext - 2.881999), 1e-4);
  std::vector<double> cosines;
  for (int i = 0; i < 20000; ++i) cosines.push_back(1 - (i + 0.5) / 10000);
  for (std::complex<double> m : {std::complex<double>(1.5, 0), {1.7, 0.1}, {0.2, 7.0}}) {
    MieSphere const s = mie(10, m, cosines);
    double sum = 0;
    for (double v : s.intensity) sum += v * 2 * pi / 10000;
    EXPECT_LT(deviation(sum, pi * 100 * s.q_sca), 1e-4);
    EXPECT_GT(deviation(1.001 * sum, pi * 100 * s.q_sca), 1e-4);
    EXPECT_LE(s.q_sca, s.q_ext * (1 + 1e-12));
  }
  // Rayleigh: Q_sca = (8/3) x^4 |(m^2-1)/(m^2+2)|^2
  EXPECT_LT(deviation(mie(0.01, 1.5, {}).q_sca, 8.0 / 3 * 1e-8 * std::pow(1.25 / 4.25, 2)), 1e-3);
}

// docs/theory/surfaces.md: coverage by the fit 0.106 % and 0.80 %, by integration 0.0982 % and 0.741 %, levels 400 and
// 600.
TEST(cleanliness, coverage) {
  Cleanliness c;
  c.level = 400;
  EXPECT_NEAR(100 * c.covered_by_fit(), 0.106, 0.0005);
  EXPECT_NEAR(100 * c.covered(), 0.0982, 0.00005);
  Cleanliness above_level = c;
  above_level.smallest = 400e-6;
  above_level.largest = 4e-3;
  double larger = 0;
  for (Grain const& g : grains(above_level)) larger += g.per_area;
  EXPECT_NEAR(larger, 10, 1e-4);  // larger than the level: one per 0.1 m^2
  c.level = 600;
  EXPECT_NEAR(100 * c.covered_by_fit(), 0.80, 0.005);
  EXPECT_NEAR(100 * c.covered(), 0.741, 0.0005);
  c.slope = 0.9;
  EXPECT_GT(std::fabs(100 * c.covered() - 0.741), 0.01);
}

}  // namespace
}  // namespace straytrace::testing
