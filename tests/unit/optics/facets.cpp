// SPDX-License-Identifier: BSD-3-Clause
// Totals of microfacet and grooves: the table agrees with the average of samples, up to grazing.
#include "optics/scatter/facets.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/every_module.hpp"

namespace straytrace {
namespace {

constexpr double angles[] = {0, 20, 70, 83, 89, 89.9};

Vec3 incoming(double degrees, double turn) {
  SinCos const t = sincos_turn(degrees / 360), a = sincos_turn(turn);
  return {t.sin * a.cos, t.sin * a.sin, t.cos};
}

// Negative control: linear between cosines (i/128)^4 and between azimuths.
double linear(Facets const& f, double cos_i, double turn) {
  double const x = 128 * std::sqrt(std::sqrt(cos_i)), i = std::min(127.0, std::floor(x));
  auto const at = [&](double node) {
    double const c = std::max(1e-9, std::pow(node / 128, 4)), s = std::sqrt((1 - c) * (1 + c));
    SinCos const a = sincos_turn(turn);
    return facets_total(f, {s * a.cos, s * a.sin, c});
  };
  double const low = std::pow(i / 128, 4), share = (cos_i - low) / (std::pow((i + 1) / 128, 4) - low);
  return at(i) + share * (at(i + 1) - at(i));
}

// Mean of eval cos/pdf by midpoints, dense at the steep normals; good to 5e-7.
template <class Law>
double sampled(Law const& law, Vec3 wi) {
  constexpr int across = 1000, around = 1000;
  double sum = 0;
  for (int j = 0; j < across; ++j) {
    double const x = (j + 0.5) / across, width = 4 * x * x * x / across;
    double ring = 0;
    for (int i = 0; i < around; ++i) {
      BsdfSample const s = law.sample(wi, (i + 0.5) / around, 1 - x * x * x * x);
      if (s.pdf > 0) ring += law.eval(wi, s.wo) * s.wo.z / s.pdf;
    }
    sum += ring / around * width;
  }
  return sum;
}

Grooves grooves(double across, double along, double reflectance) {
  Grooves law;
  law.across = across;
  law.along = along;
  law.reflectance = reflectance;
  law.grazing = 1;
  law.prepare();
  return law;
}

TEST(Facets, GroovesTableIsTheIntegral) {
  double control = 0;
  for (auto const& [across, along] : {std::pair{0.5, 0.01}, {1.0, 1e-4}, {0.1, 0.03}}) {
    Grooves const law = grooves(across, along, 0.04);
    Facets const f{across, along, 0.04, 1};
    for (double const degrees : angles)
      for (double const turn : {0.06, 0.2497, 0.25}) {
        Vec3 const wi = incoming(degrees, turn);
        double const exact = facets_total(f, wi, 0.09);
        EXPECT_NEAR(law.albedo(wi) / exact, 1, 1e-6) << across << ' ' << along << ' ' << degrees << ' ' << turn;
        if (along == 0.01) control = std::max(control, std::fabs(linear(f, wi.z, turn) / exact - 1));
      }
  }
  EXPECT_GT(control, 2e-5);
}

TEST(Facets, MicrofacetTableIsTheIntegral) {
  double control = 0;
  for (double const alpha : {1e-3, 0.03, 1.0})
    for (double const reflectance : {1.0, 0.04}) {
      Microfacet law;
      law.alpha = alpha;
      law.reflectance = reflectance;
      law.grazing = 1;
      law.prepare();
      for (double const degrees : angles) {
        Vec3 const wi = incoming(degrees, 0);
        double const exact = facets_total({alpha, alpha, reflectance, 1}, wi, 0.09);
        EXPECT_NEAR(law.albedo(wi.z) / exact, 1, 1e-6) << alpha << ' ' << degrees;
        if (alpha == 0.03)
          control = std::max(control, std::fabs(linear({alpha, alpha, reflectance, 1}, wi.z, 0) / exact - 1));
      }
    }
  EXPECT_GT(control, 2e-6);
}

// The integral over slopes against the law itself.
TEST(Facets, SamplesAverageToTheTotal) {
  Grooves const law = grooves(0.5, 0.01, 0.95);
  for (auto const& [degrees, turn] : {std::pair{30.0, 0.25}, {80.0, 0.13}}) {
    Vec3 const wi = incoming(degrees, turn);
    EXPECT_NEAR(law.albedo(wi) / sampled(law, wi), 1, 2e-6) << degrees << ' ' << turn;
  }
}

}  // namespace
}  // namespace straytrace
