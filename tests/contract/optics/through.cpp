// SPDX-License-Identifier: BSD-3-Clause
// Scatter to the other side (optics/scatter/mixture.hpp) out of any law, and angle-dependent weights: reciprocity
// across the interface (docs/theory/surfaces.md, eq. 3.2), albedo = integral of eval cos over the far side, sample
// follows pdf.
#include <gtest/gtest.h>

#include "contract/optics/quadrature.hpp"
#include "optics/scatter/angle_weight.hpp"
#include "support/chi_square.hpp"
#include "support/statistics.hpp"

namespace straytrace::testing::optics_through {
namespace {

struct Indices {
  double in, out;
};
constexpr Indices pairs[] = {{1, 1}, {1, 1.45}, {1.45, 1}, {1.52, 1.76}};
constexpr int draws = 100000, chi_checks = 4 * 3 * 3;

Vec3 below(double degrees, double azimuth) {
  Vec3 const v = incoming(degrees, azimuth);
  return {v.x, v.y, -v.z};
}
Vec3 turned(Vec3 v) { return {v.x, v.y, -v.z}; }  // seen from the other side, whose normal is -z

// Largest difference of f_12(i, o)/n_2^2 and f_21(o, i)/n_1^2, by `power` of the index.
template <class Law>
double worst_reciprocity(Law const& law, double power) {
  double worst = 0;
  Rng rng(1, 0, 0, Stream::source);
  for (Indices n : pairs)
    for (int i = 0; i < 3000; ++i) {
      Vec3 const wi = incoming(89 * rng.uniform(), rng.uniform()), wo = below(89 * rng.uniform(), rng.uniform());
      double const there = through_eval(law, wi, wo, n.in, n.out) / std::pow(n.out, power),
                   back = through_eval(law, turned(wo), turned(wi), n.out, n.in) / std::pow(n.in, power);
      if (there + back > 0) worst = std::fmax(worst, std::fabs(there - back) / (there + back));
    }
  return worst;
}

TEST(through, is_reciprocal_over_the_square_of_the_index) {
  EXPECT_LT(worst_reciprocity(lambertian(0.5), 2), 1e-12);
  EXPECT_LT(worst_reciprocity(abg(0.0025, 0.001, 1.8), 2), 1e-9);
  EXPECT_LT(worst_reciprocity(instances<Roughness>().back(), 2), 1e-9);
  EXPECT_GT(worst_reciprocity(abg(0.0025, 0.001, 1.8), 1), 1e-2);
}

// Integral over the far hemisphere on a grid of direction cosines, cos dOmega = dA.
template <class F>
double far_integral(F f) {
  constexpr int n = 800;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double const x = (i + 0.5) / n * 2 - 1, y = (j + 0.5) / n * 2 - 1, z2 = 1 - x * x - y * y;
      if (z2 > 0) sum += f(Vec3{x, y, -std::sqrt(z2)});
    }
  return sum * 4 / n / n;
}

// Tolerance 3e-3: the rim of the grid. The control forgets the gain (n_out/m)^2.
TEST(through, albedo_is_the_integral_over_the_far_side) {
  Gaussian const law = gaussian(0.3, 0.3);
  for (Indices n : pairs)
    for (double degrees : {0.0, 30.0}) {
      Vec3 const wi = incoming(degrees);
      double const albedo = through_albedo(law, wi.z, n.in, n.out);
      double const sum = far_integral([&](Vec3 wo) { return through_eval(law, wi, wo, n.in, n.out); });
      EXPECT_NEAR(sum / albedo, 1, 3e-3) << n.in << " " << n.out << " " << degrees;
      double const gain = Through::between(n.in, n.out).gain();
      if (gain > 1.01) {
        EXPECT_GT(std::fabs(sum / gain / albedo - 1), 3e-3);
      }
    }
}

TEST(through, the_lobe_is_centred_on_the_refracted_direction) {
  Gaussian const law = gaussian(1, 0.01);
  Vec3 const wi = incoming(50);
  double const s = std::sin(50 * pi / 180) / 1.45;
  Vec3 const along{-wi.x / std::hypot(wi.x, wi.y) * s, -wi.y / std::hypot(wi.x, wi.y) * s, -std::sqrt(1 - s * s)};
  EXPECT_NEAR(through_eval(law, wi, along, 1, 1.45), 1.45 * 1.45, 1e-9);
  EXPECT_EQ(through_albedo(law, std::cos(60 * pi / 180), 1.45, 1), 0);  // beyond the critical angle, 43.6 deg
  EXPECT_EQ(through_sample(law, incoming(60), 0.3, 0.4, 1.45, 1).pdf, 0);
  EXPECT_GT(through_albedo(law, std::cos(40 * pi / 180), 1.45, 1), 0);
}

// A side that reflects by one law and scatters another through, the second with a weight.
struct Window {
  std::vector<Lambertian> matt{lambertian(0.1)};
  std::vector<Gaussian> haze{gaussian(0.3, 0.3)};
  std::vector<AngleWeight> weights;
  LawPool pool;
  Optic optic;

  Window() {
    std::get<0>(pool.arrays) = {matt.data(), 1};
    std::get<4>(pool.arrays) = {haze.data(), 1};
    optic.laws = 2;
    optic.law[0] = {0, 0};
    optic.law[1] = {4, 0};
    optic.through[1] = true;
    weights.push_back(weight_of(pool, optic.law[1], [](double cosine) { return 2 - cosine; }));
    optic.weight[1] = {weights.data(), 1};
  }
  Window(Window const&) = delete;
};

template <bool loses_half>
ChiSquare sample_against_pdf(Window const& w, Indices n, Vec3 wi) {
  constexpr int cells = 10;
  std::vector<double> observed(2 * cells * cells + 1), expected = observed;
  auto const cell = [](Vec3 wo) {
    int const i = int((wo.x + 1) / 2 * cells), j = int((wo.y + 1) / 2 * cells);
    return std::size_t((wo.z < 0) * cells * cells + std::min(i, cells - 1) * cells + std::min(j, cells - 1));
  };
  constexpr int fine = 400;
  double left = draws;
  for (int i = 0; i < fine; ++i)
    for (int j = 0; j < fine; ++j) {
      double const x = (i + 0.5) / fine * 2 - 1, y = (j + 0.5) / fine * 2 - 1, z2 = 1 - x * x - y * y;
      for (int side : {1, -1}) {
        if (!(z2 > 0)) continue;
        Vec3 const wo{x, y, side * std::sqrt(z2)};
        double const p = scatter_pdf(w.pool, w.optic, wi, wo, n.in, n.out) / std::fabs(wo.z) * 4 / fine / fine * draws;
        expected[cell(wo)] += p;
        left -= p;
      }
    }
  expected.back() = std::fmax(left, 1e-6);
  for (int i = 0; i < draws; ++i) {
    Rng rng(2, std::uint64_t(i), 0, Stream::direction);
    double const choice = rng.uniform(), u = rng.uniform(), v = rng.uniform();
    BsdfSample const s = scatter_sample(w.pool, w.optic, wi, choice, u, loses_half ? v / 2 : v, n.in, n.out);
    s.pdf > 0 ? ++observed[cell(s.wo)] : ++observed.back();
  }
  return chi_square(observed, expected, 10);
}

TEST(through, samples_of_a_sum_follow_the_pdf) {
  Window const window;
  for (Indices n : {Indices{1, 1.45}, {1.45, 1}})
    for (double degrees : {0.0, 35.0}) {
      EXPECT_TRUE(passes(sample_against_pdf<false>(window, n, incoming(degrees)), chi_checks))
          << n.in << " " << degrees;
      EXPECT_FALSE(passes(sample_against_pdf<true>(window, n, incoming(degrees)), chi_checks));
    }
}

// Mean of eval cos/pdf is the albedo of the sum, both sides counted; the pdf returned is that of the sum. Control:
// without the indices.
TEST(through, mean_weight_is_the_albedo) {
  Window const w;
  for (Indices n : {Indices{1, 1.45}, {1.45, 1}}) {
    Vec3 const wi = incoming(35);
    Sampler sampler, control;
    for (int i = 0; i < draws; ++i) {
      Rng rng(3, std::uint64_t(i), 0, Stream::direction);
      double const choice = rng.uniform(), u = rng.uniform(), v = rng.uniform();
      BsdfSample const s = scatter_sample(w.pool, w.optic, wi, choice, u, v, n.in, n.out);
      bool const good = s.pdf > 0;
      if (good) {
        ASSERT_NEAR(scatter_pdf(w.pool, w.optic, wi, s.wo, n.in, n.out) / s.pdf, 1, 1e-7);
      }
      sampler.add(good ? scatter_eval(w.pool, w.optic, wi, s.wo, n.in, n.out) * std::fabs(s.wo.z) / s.pdf : 0);
      control.add(good ? scatter_eval(w.pool, w.optic, wi, s.wo) * std::fabs(s.wo.z) / s.pdf : 0);
    }
    double const albedo = scatter_albedo(w.pool, w.optic, wi.z, n.in, n.out);
    EXPECT_NEAR(sampler.mean().mean / albedo, 1, 2e-3);  // the albedo is tabulated
    EXPECT_GT(std::fabs(control.mean().mean / albedo - 1), 2e-3);
  }
}

TEST(weights, multiply_and_stay_reciprocal) {
  Window const w;
  Vec3 const wi = incoming(20), wo = below(70, 0.4);
  Gaussian const plain = gaussian(0.3, 0.3);
  double const factor = std::sqrt((2 - wi.z) * (2 + wo.z));
  EXPECT_NEAR(scatter_eval(w.pool, w.optic, wi, wo) / through_eval(plain, wi, wo, 1, 1), factor, 1e-3);
  EXPECT_NEAR(scatter_eval(w.pool, w.optic, wi, wo), scatter_eval(w.pool, w.optic, turned(wo), turned(wi)), 1e-15);
  Weighted<Gaussian> const law{w.haze[0], w.weights.data()};
  EXPECT_NEAR(law.albedo(wi.z) / albedo_by_rays(law, wi, 0.03), 1, 3e-3);
  EXPECT_GT(std::fabs(plain.albedo(wi.z) / albedo_by_rays(law, wi, 0.03) - 1), 1e-2);
}

}  // namespace
}  // namespace straytrace::testing::optics_through
