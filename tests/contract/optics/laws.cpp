// SPDX-License-Identifier: BSD-3-Clause
// Contract of every BSDF model (docs/develop/testing.md; docs/theory/surfaces.md): sample() follows pdf(), albedo()
// is the integral of eval cos (eq. 3.4), reciprocity (eq. 3.2), energy (eq. 3.1). Each with broken variants.
#include <gtest/gtest.h>

#include "contract/optics/quadrature.hpp"
#include "support/chi_square.hpp"
#include "support/statistics.hpp"

namespace straytrace::testing::optics_laws {
namespace {

constexpr int draws = 100000,
              chi_checks = int(std::tuple_size_v<LawTypes>) * 3 * 5;  // laws, instances, incidences at most

template <class T>
class ScatterLaw : public ::testing::Test {};
TYPED_TEST_SUITE(ScatterLaw, AllLaws);

// Samples and stated properties of a variant of a model. The model itself is Law; controls override a member.
template <class Law>
struct SamplesTooNarrow : Law {  // a lobe 1 % too narrow
  BsdfSample sample(Vec3 wi, double u, double v) const {
    BsdfSample s = Law::sample(wi, u, v);
    if (!(s.pdf > 0)) return s;
    Polar p = about_specular(wi, s.wo);
    p.theta *= 0.99;
    s.wo = direction_at(Frame::around(specular(wi)), p);
    return s;
  }
};
template <class Law>
struct PdfWithoutCosine : Law {
  double pdf(Vec3 wi, Vec3 wo) const { return Law::pdf(wi, wo) > 0 ? Law::pdf(wi, wo) / std::fmax(wo.z, 1e-3) : 0; }
};
template <class Law>
struct LosesDirections : Law {
  BsdfSample sample(Vec3 wi, double u, double v) const { return u < 0.99 ? Law::sample(wi, u, v) : BsdfSample{}; }
};

// Rings about the specular direction, split by azimuth, and one cell for the draws that find no direction.
template <class Law>
ChiSquare sample_against_pdf(Law const& law, Vec3 wi, int n, int sectors) {
  // rings in direction cosines have no pdf at the horizon; elsewhere it cuts a bright one: finer cells
  constexpr bool bright_horizon = !offset_rings<Law> && !std::is_base_of_v<Lambertian, Law>;
  constexpr int sub = bright_horizon ? 24 : 10, around = bright_horizon ? 160 : 40;
  std::vector<double> const edges = cell_edges(law);
  int const rings = int(edges.size()) - 2;
  std::vector<double> observed(std::size_t((rings + 1) * sectors + 1)), expected = observed;
  double left = 1;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      double const p = cell_integral(
          wi, [&](Vec3 wo) { return law.pdf(wi, wo); }, edges[std::size_t(i)], edges[std::size_t(i) + 1],
          double(j) / sectors, double(j + 1) / sectors, sub, around);
      expected[std::size_t(i * sectors + j)] = n * p;
      left -= p;
    }
  expected.back() = n * left;
  for (double& e : expected) e = std::fmax(e, 1e-6);  // slivers at the horizon that the quadrature misses are pooled
  for (int i = 0; i < n; ++i) {
    Rng rng(1, std::uint64_t(i), 0, Stream::direction);
    double const u = rng.uniform(), v = rng.uniform();
    BsdfSample const s = law.sample(wi, u, v);
    if (!(s.pdf > 0)) {
      ++observed.back();
      continue;
    }
    if (!(law.pdf(wi, s.wo) > 0)) return {};  // a sample where nothing is expected
    Polar const p = about_specular(wi, s.wo);
    auto const ring = std::upper_bound(edges.begin(), edges.end(), p.theta) - edges.begin() - 1;
    ++observed[std::size_t(std::min<long>(ring, rings) * sectors + std::min(int(p.turn * sectors), sectors - 1))];
  }
  return chi_square(observed, expected, 10);
}

template <class Variant, class Law>
bool samples_follow_pdf() {
  for (Law const& law : instances<Law>()) {
    Variant variant;
    static_cast<Law&>(variant) = law;
    for (double degrees : {0.0, 30.0, 60.0, 85.0})
      if (!passes(sample_against_pdf(variant, incoming(degrees), draws, 4), chi_checks)) return false;
  }
  return true;
}

TYPED_TEST(ScatterLaw, samples_follow_the_pdf) {
  EXPECT_TRUE((samples_follow_pdf<TypeParam, TypeParam>()));
  EXPECT_FALSE((samples_follow_pdf<PdfWithoutCosine<TypeParam>, TypeParam>()));
  EXPECT_FALSE((samples_follow_pdf<LosesDirections<TypeParam>, TypeParam>()));
}

// At normal incidence, rings only and ten times the draws: enough to detect a lobe that is 1 % too narrow.
TYPED_TEST(ScatterLaw, a_lobe_one_percent_too_narrow_is_rejected) {
  SamplesTooNarrow<TypeParam> narrow;
  static_cast<TypeParam&>(narrow) = instances<TypeParam>().back();
  EXPECT_TRUE(passes(sample_against_pdf(instances<TypeParam>().back(), incoming(0), 10 * draws, 1), chi_checks));
  EXPECT_FALSE(passes(sample_against_pdf(narrow, incoming(0), 10 * draws, 1), chi_checks));
}

// The pdf that sample() returns is the one pdf() gives for the direction returned.
template <class Variant, class Law>
double worst_pdf_mismatch() {
  double worst = 0;
  for (Law const& law : instances<Law>())
    for (double degrees : incidences) {
      Variant variant;
      static_cast<Law&>(variant) = law;
      Vec3 const wi = incoming(degrees);
      for (int i = 0; i < 5000; ++i) {
        Rng rng(2, std::uint64_t(i), 0, Stream::direction);
        double const u = rng.uniform(), v = rng.uniform();
        BsdfSample const s = variant.sample(wi, u, v);
        if (!(s.pdf > 0)) continue;
        worst = std::fmax(worst, std::fabs(variant.pdf(wi, s.wo) / s.pdf - 1));
      }
    }
  return worst;
}

TYPED_TEST(ScatterLaw, returns_its_own_pdf) {
  EXPECT_LT((worst_pdf_mismatch<TypeParam, TypeParam>()), 1e-7);
  EXPECT_GT((worst_pdf_mismatch<PdfWithoutCosine<TypeParam>, TypeParam>()), 1e-2);
}

// Value and density found together are those found apart, to rounding. The control exchanges the directions, which
// changes the density.
template <class Law>
double worst_of_both(Law const& law, bool exchanged) {
  double worst = 0;
  for (double degrees : incidences)
    for (int i = 0; i < 200; ++i) {
      Vec3 const wi = incoming(degrees);
      Rng rng(5, std::uint64_t(i), 0, Stream::direction);
      double const u = rng.uniform(), v = rng.uniform();
      Vec3 const wo = law.sample(wi, u, v).wo;
      ValueAndPdf const found = exchanged ? both_of(law, wo, wi) : both_of(law, wi, wo);
      double const value = law.eval(wi, wo), pdf = law.pdf(wi, wo);
      worst = std::fmax(worst, std::fabs(found.value - value) / std::fmax(value, 1e-300));
      worst = std::fmax(worst, std::fabs(found.pdf - pdf) / std::fmax(pdf, 1e-300));
    }
  return worst;
}
TYPED_TEST(ScatterLaw, value_and_density_together_are_those_apart) {
  for (TypeParam const& law : instances<TypeParam>()) {
    EXPECT_LT(worst_of_both(law, false), 1e-12);
    EXPECT_GT(worst_of_both(law, true), 1e-3);
  }
}

template <class Law>
double worst_albedo(Law const& law, double factor) {
  double worst = 0;
  for (double degrees : incidences) {
    Vec3 const wi = incoming(degrees);
    worst = std::fmax(worst, std::fabs(factor * albedo_from(law, wi) / albedo_by_quadrature(law, wi) - 1));
  }
  return worst;
}

// Where rounding decides on which side of an edge of the tables a direction at the horizon lies.
TYPED_TEST(ScatterLaw, is_finite_at_the_horizon) {
  for (TypeParam const& law : instances<TypeParam>())
    for (Vec3 const wi : {Vec3{0, 0, 1}, Vec3{0, 0, 1 + 0x1p-52}, Vec3{1e-9, 0, 1}, Vec3{1, 0, 1e-9}})
      for (double height = 1e-18; height < 1e-5; height *= 1.3)
        for (Vec3 const along : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0.6, 0.8, 0}}) {
          auto const [value, pdf] = both_of(law, wi, along + Vec3{0, 0, height});
          EXPECT_TRUE(std::isfinite(value) && value >= 0) << height;
          EXPECT_TRUE(std::isfinite(pdf) && pdf >= 0) << height;
        }
}

TYPED_TEST(ScatterLaw, albedo_is_the_integral_of_eval_cos) {
  for (TypeParam const& law : instances<TypeParam>()) {
    EXPECT_LT(worst_albedo(law, 1), 2e-3);
    EXPECT_GT(worst_albedo(law, 1.005), 2e-3);
  }
}

// Largest eval cos/pdf over the mean, for incidences up to 80 deg: how far importance sampling is from perfect.
template <class Law>
double worst_weight(Law const& law, double degrees) {
  Vec3 const wi = incoming(degrees);
  double most = 0, sum = 0;
  for (int i = 0; i < draws; ++i) {
    Rng rng(5, std::uint64_t(i), 0, Stream::direction);
    double const u = rng.uniform(), v = rng.uniform();
    BsdfSample const s = law.sample(wi, u, v);
    double const w = s.pdf > 0 ? law.eval(wi, s.wo) * s.wo.z / s.pdf : 0;
    most = std::fmax(most, w);
    sum += w;
  }
  return most / (sum / draws);
}
TYPED_TEST(ScatterLaw, weights_stay_near_their_mean) {
  for (TypeParam const& law : instances<TypeParam>())
    for (double degrees : {0.0, 30.0, 60.0, 80.0}) EXPECT_LT(worst_weight(law, degrees), weight_limit<TypeParam>);
}

TYPED_TEST(ScatterLaw, albedo_is_at_most_one) {
  for (TypeParam const& law : instances<TypeParam>())
    for (int i = 0; i <= 1000; ++i) {
      double const albedo = law.albedo(i / 1000.0);
      EXPECT_GE(albedo, 0) << i;
      EXPECT_LE(albedo, 1) << i;
    }
}

// Mean of eval cos/pdf over the samples: the albedo again, this time by the estimator of the trace.
template <class Law>
SampleMean mean_weight(Law const& law, Vec3 wi, double power_of_cosine) {
  double sum = 0, squares = 0;
  for (int i = 0; i < draws; ++i) {
    Rng rng(3, std::uint64_t(i), 0, Stream::direction);
    double const u = rng.uniform(), v = rng.uniform();
    BsdfSample const s = law.sample(wi, u, v);
    double const w = s.pdf > 0 ? law.eval(wi, s.wo) * std::pow(s.wo.z, power_of_cosine) / s.pdf : 0;
    sum += w;
    squares += w * w;
  }
  double const mean = sum / draws;
  return {mean, std::sqrt(std::fmax(0, squares / draws - mean * mean) / draws), draws};
}

TYPED_TEST(ScatterLaw, mean_weight_is_the_albedo) {
  for (TypeParam const& law : instances<TypeParam>())
    for (double degrees : {0.0, 30.0, 60.0, 85.0}) {
      Vec3 const wi = incoming(degrees);
      double const exact = albedo_by_quadrature(law, wi);
      SampleMean const m = mean_weight(law, wi, 1);
      if (m.std_error < 1e-7 * exact)  // perfect importance sampling leaves no spread
        EXPECT_NEAR(m.mean / exact, 1, 2e-4);
      else
        expect_mean("weight", m, exact, 0.05 * exact);
      if (degrees == 60) {
        SampleMean const control = mean_weight(law, wi, 0);  // forgets the cosine
        EXPECT_GT(std::fabs(control.mean - exact), 5 * control.std_error + 0.05 * exact);
      }
    }
}

// Largest relative difference of f(wi, wo) and f(wo, wi), for pairs all over and close to specular.
template <class F>
double worst_reciprocity(F f) {
  double worst = 0;
  Rng rng(4, 0, 0, Stream::source);
  for (int i = 0; i < 20000; ++i) {
    Vec3 const wi = incoming(89 * rng.uniform(), rng.uniform());
    Vec3 const near =
        unit(specular(wi) + std::pow(10, -5 * rng.uniform()) * incoming(90 * rng.uniform(), rng.uniform()));
    Vec3 const wo = i % 2 ? near : incoming(89 * rng.uniform(), rng.uniform());
    double const there = f(wi, wo), back = f(wo, wi);
    if (there < 0 || back < 0) return infinity;
    if (there + back > 0) worst = std::fmax(worst, std::fabs(there - back) / (there + back));
  }
  return worst;
}

TYPED_TEST(ScatterLaw, is_reciprocal_and_not_negative) {
  for (TypeParam const& law : instances<TypeParam>()) {
    EXPECT_LT(worst_reciprocity([&](Vec3 wi, Vec3 wo) { return law.eval(wi, wo); }), 1e-9);
    EXPECT_GT(worst_reciprocity([&](Vec3 wi, Vec3 wo) { return law.eval(wi, wo) * wi.z; }), 1e-2);
  }
}

TYPED_TEST(ScatterLaw, is_dark_below_the_surface) {
  Vec3 const up = incoming(30), down{up.x, up.y, -up.z};
  for (TypeParam const& law : instances<TypeParam>())
    for (auto [wi, wo] : {std::pair{up, down}, {down, up}, {down, down}}) {
      EXPECT_EQ(law.eval(wi, wo), 0);
      EXPECT_EQ(law.pdf(wi, wo), 0);
      EXPECT_EQ(law.sample(down, 0.3, 0.4).pdf, 0);
    }
}

}  // namespace
}  // namespace straytrace::testing::optics_laws
