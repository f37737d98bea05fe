// SPDX-License-Identifier: BSD-3-Clause
// BSDF models against their closed forms: validation case A16 (docs/theory/surfaces.md, eq. 3.15, 3.17), power between
// two angles of eq. 3.18, the statistical 1/theta^2 law of eq. 3.19 and 3.20 (requirements R5.06), mean cosine of
// eq. 3.3.
#include <gtest/gtest.h>

#include <functional>

#include "base/math/rng.hpp"
#include "support/laws.hpp"
#include "support/statistics.hpp"

namespace straytrace {
namespace {

using testing::deviation, testing::abg, testing::power_law;

// Integral of f over [a, b] by Simpson's rule with 20,000 steps.
double simpson(std::function<double(double)> const& f, double a, double b) {
  constexpr int steps = 20000;
  double sum = f(a) + f(b);
  for (int i = 1; i < steps; ++i) sum += (i % 2 ? 4 : 2) * f(a + (b - a) * i / steps);
  return sum * (b - a) / steps / 3;
}

// A16: A = 0.0025, B = 0.001, TIS(0) = 0.0413437 for g = 1.8 and pi A ln(1 + 1/B) = 0.0542612 for g = 2. Rounding
// of the printed digits: 2e-6; the closed form: 1e-6. The control takes B^2 for B.
TEST(optics_closed_forms, abg_total_scatter_a16) {
  EXPECT_LT(deviation(abg(0.0025, 0.001, 1.8).albedo(1), 0.0413437), 2e-6);
  EXPECT_LT(deviation(abg(0.0025, 0.001, 2).albedo(1), 0.0542612), 2e-6);
  EXPECT_LT(deviation(abg(0.0025, 0.001, 2).albedo(1), pi * 0.0025 * std::log(1 + 1 / 0.001)), 1e-6);
  EXPECT_GT(deviation(abg(0.0025, 0.001 * 0.001, 2).albedo(1), 0.0542612), 2e-6);
}

// A16: b_0 = 0.1, l = 0.01: TIS(0) = 1.131005e-3 for s = -1.5 and 2.893545e-4 for s = -2 (eq. 3.15), by the closed form
// and by quadrature of eval(), to 1e-6; and the mean weight of sampled light (its distribution: ScatterLaw.samples_*).
// Controls: s + 0.01 %, and the law without its cosine.
double hemisphere(Harvey const& law, bool cosine) {
  return simpson(
      [&](double x) {  // substitution x = ln(alpha^2 + l^2): the knee is smooth in it
        double const alpha2 = std::exp(x) - 1e-4, rho = std::sqrt(std::fmax(alpha2, 0));
        double const z = std::sqrt(std::fmax(1 - alpha2, 1e-18));
        return pi * (alpha2 + 1e-4) * law.eval({0, 0, 1}, {rho, 0, z}) / (cosine ? 1 : std::fmax(z, 1e-2));
      },
      std::log(1e-4), std::log(1 + 1e-4));
}

TEST(optics_closed_forms, harvey_total_scatter_a16) {
  struct Row {
    double s, tis;
  };
  for (Row const row : {Row{-1.5, 1.131005e-3}, {-2, 2.893545e-4}}) {
    Harvey const law = testing::harvey(0.1, 0.01, row.s);
    EXPECT_LT(deviation(law.tis(), row.tis), 1e-6);
    EXPECT_LT(deviation(hemisphere(law, true), row.tis), 1e-6);
    EXPECT_GT(deviation(hemisphere(testing::harvey(0.1, 0.01, 0.9999 * row.s), true), row.tis), 1e-6)
        << "negative control";
    EXPECT_GT(deviation(hemisphere(law, false), row.tis), 1e-3) << "negative control";
    testing::Sampler weight;
    for (std::uint64_t i = 0; i < 400000; ++i) {
      Rng rng(3, i, 0, Stream::direction);
      double const u = rng.uniform(), v = rng.uniform();
      BsdfSample const sample = law.sample({0, 0, 1}, u, v);
      weight.add(sample.pdf > 0 ? law.eval({0, 0, 1}, sample.wo) * sample.wo.z / sample.pdf : 0);
    }
    testing::expect_mean("sampled", weight.mean(), row.tis, 5e-3 * row.tis);
    testing::expect_rejected("sampled, 1 % more", weight.mean(), 1.01 * row.tis);
  }
}

// Last row of eq. 3.17: B = 0, g < 2: 2 pi A/(2 - g).
TEST(optics_closed_forms, abg_without_a_knee) {
  for (double g : {0.5, 1.0, 1.5}) {
    EXPECT_LT(deviation(abg(0.01, 0, g).albedo(1), 2 * pi * 0.01 / (2 - g)), 1e-3) << g;
    EXPECT_GT(deviation(abg(0.01, 0, g).albedo(1), 2 * pi * 0.01 / (2.01 - g)), 1e-3) << g;
  }
}

// eq. 3.18: 2 pi kappa [theta^(2-n)/(2-n)], small angles (sin theta = theta to 2e-5 below 1e-2 rad), against quadrature
// of eval() and against the share of sample(). Tolerance 1e-4 for the quadrature.
double power_between(PowerLaw const& law, double low, double high) {
  return simpson(
      [&](double x) {
        double const theta = std::exp(x);
        return 2 * pi * theta * std::sin(theta) * law.eval({0, 0, 1}, {std::sin(theta), 0, std::cos(theta)});
      },
      std::log(low), std::log(high));
}
double closed_power(double kappa, double n, double low, double high) {
  if (n == 2) return 2 * pi * kappa * std::log(high / low);
  return 2 * pi * kappa * (std::pow(high, 2 - n) - std::pow(low, 2 - n)) / (2 - n);
}

TEST(optics_closed_forms, power_between_two_angles_eq_3_18) {
  for (double n : {2.0, 2.3986})
    for (double high : {1e-3, 1e-2}) {
      PowerLaw const law = power_law(1e-6, n, 5e-5);
      EXPECT_LT(deviation(power_between(law, 1e-4, high), closed_power(1e-6, n, 1e-4, high)), 1e-4) << n << " " << high;
      EXPECT_GT(deviation(power_between(law, 1e-4, high), closed_power(1e-6, 1.01 * n, 1e-4, high)), 1e-4);
    }
}

// Weight eval cos/pdf that sample() puts between two angles.
testing::SampleMean sampled_between(PowerLaw const& law, double low, double high) {
  constexpr int n = 400000;
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    Rng rng(1, std::uint64_t(i), 0, Stream::direction);
    double const u = rng.uniform(), v = rng.uniform();
    BsdfSample const s = law.sample({0, 0, 1}, u, v);
    double const theta = angle_between({0, 0, 1}, s.wo);
    double const w = s.pdf > 0 && theta >= low && theta < high ? law.eval({0, 0, 1}, s.wo) * s.wo.z / s.pdf : 0;
    sum += w;
    squares += w * w;
  }
  return {sum / n, std::sqrt((squares / n - sum * sum / n / n) / n), n};
}

TEST(optics_closed_forms, sampled_power_between_two_angles_eq_3_18) {
  for (double n : {2.0, 2.3986}) {
    PowerLaw const law = power_law(1e-6, n, 5e-5);
    double const exact = closed_power(1e-6, n, 1e-4, 1e-2);
    testing::expect_mean("power", sampled_between(law, 1e-4, 1e-2), exact, 0.02 * exact);
    testing::SampleMean const control = sampled_between(law, 1.3e-4, 1e-2);  // a border 30 % off
    EXPECT_GT(std::fabs(control.mean - exact), 5 * control.std_error);
  }
}

// Table below eq. 3.20: kappa_s 0.0993409 and 0.2056198. The control integrates over theta instead of sin(theta).
TEST(optics_closed_forms, statistical_kappa_eq_3_19) {
  EXPECT_LT(deviation(statistical_kappa(55e-6), 0.0993409), 1e-6);
  EXPECT_LT(deviation(statistical_kappa(1e-2), 0.2056198), 1e-6);
  EXPECT_GT(deviation(1 / std::log(pi / 2 / 55e-6), 0.0993409), 1e-3);
}

TEST(optics_closed_forms, statistical_integral_eq_3_20) {
  for (double a : {55e-6, 1e-2, 0.3})
    for (double b : {0.5, pi / 2, pi}) {
      double const sum =
          simpson([](double x) { return std::sin(std::exp(x)) / std::exp(x); }, std::log(a), std::log(b));
      EXPECT_LT(deviation(statistical_integral(a, b), sum), 1e-12) << a << " " << b;
    }
}

// R5.06: quantiles of the statistical law above 55e-6 rad, four printed digits.
TEST(optics_closed_forms, quantiles_of_the_statistical_law_r5_06) {
  double const above = 55e-6, all = statistical_integral(above, pi / 2);
  auto const share = [&](double theta) { return statistical_integral(above, theta) / all; };
  double const table[5][2] = {{0.10, 1.505e-4}, {0.25, 6.812e-4}, {0.50, 8.438e-3}, {0.75, 0.10461}, {0.90, 0.48230}};
  for (auto [q, theta] : table) {
    EXPECT_NEAR(share(theta), q, 1e-4) << theta;
    EXPECT_GT(std::fabs(share(1.01 * theta) - q), 5e-4) << "a quantile 1 % off";
  }
}

// The law as the trace uses it: kappa = tis kappa_s/(2 pi), n = 2, scatters `tis` into the hemisphere, with the cosine
// of eq. 0.4 counted: tis (1 - loss), loss = kappa_s integral of (1 - cos) sin/theta^2 = 0.0993409 * 0.3948. Tolerance
// 1e-4.
TEST(optics_closed_forms, statistical_law_scatters_the_fraction_it_states) {
  double const above = 55e-6, tis = 1e-5, kappa_s = statistical_kappa(above);
  PowerLaw const law = power_law(tis * kappa_s / (2 * pi), 2, above);
  double const loss =
      kappa_s * simpson([](double t) { return (1 - std::cos(t)) * std::sin(t) / (t * t); }, 1e-9, pi / 2);
  EXPECT_LT(deviation(law.albedo(1), tis * (1 - loss)), 1e-4);
  EXPECT_GT(deviation(law.albedo(1), tis * 2 * pi), 0.1);  // trap 14.1: a factor 2 pi
}

// eq. 3.3: mean cosine of Lambertian scatter 2/3; the control is uniform in solid angle and has 1/2.
template <class Draw>
testing::SampleMean mean_cosine(Draw draw) {
  constexpr int n = 400000;
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    Rng rng(2, std::uint64_t(i), 0, Stream::direction);
    double const u = rng.uniform(), v = rng.uniform(), z = draw(u, v);
    sum += z;
    squares += z * z;
  }
  return {sum / n, std::sqrt((squares / n - sum * sum / n / n) / n), n};
}

TEST(optics_closed_forms, lambert_mean_cosine_eq_3_3) {
  Lambertian const law{0.7};
  auto const lambert = [&](double u, double v) { return law.sample({0.6, 0, 0.8}, u, v).wo.z; };
  testing::expect_mean("mean cosine", mean_cosine(lambert), 2.0 / 3, 0.005);
  testing::SampleMean const uniform = mean_cosine([](double u, double) { return u; });
  EXPECT_GT(std::fabs(uniform.mean - 2.0 / 3), 5 * uniform.std_error);
  EXPECT_DOUBLE_EQ(law.eval({0, 0, 1}, {0.6, 0, 0.8}), 0.7 / pi);
}

}  // namespace
}  // namespace straytrace
