// SPDX-License-Identifier: BSD-3-Clause
// Contract of the sum of laws that a side of a surface carries: scatter_sample draws with scatter_pdf, and both
// describe scatter_eval. Broken variants: the pdf of the chosen law alone, laws chosen evenly but weighed by albedo.
#include <gtest/gtest.h>

#include "contract/optics/quadrature.hpp"
#include "support/chi_square.hpp"
#include "support/statistics.hpp"

namespace straytrace::testing::optics_mixture {
namespace {

constexpr int draws = 100000, chi_checks = 4;

// A sum of three laws of three kinds, with albedos of 0.3, 0.05 and 0.04 at normal incidence.
struct Sum {
  std::vector<Lambertian> matt{lambertian(0.3)};
  std::vector<PowerLaw> narrow{power_law(1e-3, 2, 1e-3)};
  std::vector<Abg> broad{abg(0.0025, 0.001, 1.8)};
  LawPool pool;
  Optic optic;

  Sum() {
    std::get<0>(pool.arrays) = {matt.data(), 1};
    std::get<1>(pool.arrays) = {narrow.data(), 1};
    std::get<2>(pool.arrays) = {broad.data(), 1};
    optic.laws = 3;
    for (std::uint32_t i = 0; i < 3; ++i) optic.law[i] = {i, 0};
  }
  Sum(Sum const&) = delete;

  double eval(Vec3 wi, Vec3 wo) const { return scatter_eval(pool, optic, wi, wo); }
  double pdf(Vec3 wi, Vec3 wo) const { return scatter_pdf(pool, optic, wi, wo); }
  BsdfSample sample(Vec3 wi, double choice, double u, double v) const {
    return scatter_sample(pool, optic, wi, choice, u, v);
  }
};

struct ChosenEvenly : Sum {
  BsdfSample sample(Vec3 wi, double choice, double u, double v) const {
    PoolRef const law = optic.law[int(3 * choice)];
    BsdfSample s = pool.visit(law, [&](auto const& l) { return l.sample(wi, u, v); });
    if (s.pdf > 0) s.pdf = pdf(wi, s.wo);
    return s;
  }
};
struct PdfOfTheChosenLaw : Sum {
  BsdfSample sample(Vec3 wi, double choice, double u, double v) const {
    double left = choice * scatter_albedo(pool, optic, wi.z);
    int i = -1;
    while (left > 0 && i < 2) left -= pool.visit(optic.law[++i], [&](auto const& l) { return l.albedo(wi.z); });
    return pool.visit(optic.law[i], [&](auto const& l) { return l.sample(wi, u, v); });
  }
};

template <class S>
BsdfSample draw(S const& sum, Vec3 wi, int i) {
  Rng rng(1, std::uint64_t(i), 0, Stream::direction);
  double const choice = rng.uniform(), u = rng.uniform(), v = rng.uniform();
  return sum.sample(wi, choice, u, v);
}

template <class S>
ChiSquare sample_against_pdf(S const& sum, Vec3 wi) {
  constexpr int rings = 30;
  std::vector<double> edges{0}, observed(rings + 2), expected(rings + 2);
  for (int i = 0; i <= rings; ++i) edges.push_back(1e-3 * std::pow(pi / 1e-3, double(i) / rings));
  double left = 1;
  for (std::size_t i = 0; i <= rings; ++i) {
    double const p = cell_integral(
        wi, [&](Vec3 wo) { return sum.pdf(wi, wo); }, edges[i], edges[i + 1], 0, 1, 60);
    expected[i] = std::fmax(draws * p, 1e-6);
    left -= p;
  }
  expected.back() = draws * left;
  for (int i = 0; i < draws; ++i) {
    BsdfSample const s = draw(sum, wi, i);
    if (!(s.pdf > 0)) {
      ++observed.back();
      continue;
    }
    double const theta = about_specular(wi, s.wo).theta;
    auto const ring = std::upper_bound(edges.begin(), edges.end(), theta) - edges.begin() - 1;
    ++observed[std::size_t(std::min<long>(ring, rings))];
  }
  return chi_square(observed, expected, 10);
}

TEST(mixture, samples_follow_the_pdf_of_the_sum) {
  Sum const right;
  ChosenEvenly const even;
  for (double degrees : {0.0, 30.0, 60.0, 85.0}) {
    EXPECT_TRUE(passes(sample_against_pdf(right, incoming(degrees)), chi_checks)) << degrees;
    EXPECT_FALSE(passes(sample_against_pdf(even, incoming(degrees)), chi_checks)) << degrees;
  }
}

// Largest deviation of the pdf returned from scatter_pdf.
template <class S>
double worst_pdf_mismatch(S const& sum) {
  double worst = 0;
  for (double degrees : incidences)
    for (int i = 0; i < 5000; ++i) {
      Vec3 const wi = incoming(degrees);
      BsdfSample const s = draw(sum, wi, i);
      if (s.pdf > 0) worst = std::fmax(worst, std::fabs(sum.pdf(wi, s.wo) / s.pdf - 1));
    }
  return worst;
}

TEST(mixture, returns_the_pdf_of_the_sum) {
  EXPECT_LT(worst_pdf_mismatch(Sum()), 1e-12);
  EXPECT_GT(worst_pdf_mismatch(PdfOfTheChosenLaw()), 0.1);
}

template <class S>
SampleMean mean_weight(S const& sum, Vec3 wi, double power_of_cosine = 1) {
  double total = 0, squares = 0;
  for (int i = 0; i < draws; ++i) {
    BsdfSample const s = draw(sum, wi, i);
    double const w = s.pdf > 0 ? sum.eval(wi, s.wo) * std::pow(s.wo.z, power_of_cosine) / s.pdf : 0;
    total += w;
    squares += w * w;
  }
  double const mean = total / draws;
  return {mean, std::sqrt((squares / draws - mean * mean) / draws), draws};
}

TEST(mixture, mean_weight_is_the_sum_of_the_albedos) {
  Sum const sum;
  for (double degrees : {0.0, 30.0, 60.0, 85.0}) {
    Vec3 const wi = incoming(degrees);
    double const exact = albedo_by_quadrature(sum.matt[0], wi) + albedo_by_quadrature(sum.narrow[0], wi) +
                         albedo_by_quadrature(sum.broad[0], wi);
    EXPECT_NEAR(scatter_albedo(sum.pool, sum.optic, wi.z) / exact, 1, 1e-3);
    expect_mean("weight", mean_weight(sum, wi), exact, 0.02 * exact);
    SampleMean const control = mean_weight(sum, wi, 0.9);  // a wrong cosine
    EXPECT_GT(std::fabs(control.mean - exact), 5 * control.std_error);
  }
}

TEST(mixture, nothing_to_scatter) {
  Optic const black;
  Sum const sum;
  EXPECT_EQ(scatter_albedo(sum.pool, black, 1), 0);
  EXPECT_EQ(scatter_eval(sum.pool, black, incoming(0), incoming(30)), 0);
  EXPECT_EQ(scatter_pdf(sum.pool, black, incoming(0), incoming(30)), 0);
  EXPECT_EQ(scatter_sample(sum.pool, black, incoming(0), 0.5, 0.5, 0.5).pdf, 0);
}

}  // namespace
}  // namespace straytrace::testing::optics_mixture
