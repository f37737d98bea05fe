// SPDX-License-Identifier: BSD-3-Clause
// The grooves law (docs/reference/scatter/grooves.md) against numbers it must give, each with a variant that must not:
// equal widths are the microfacet law, peak R/(4 pi a_x a_y), glints, and the dependence of the total on the azimuth.
#include "contract/optics/quadrature.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

TEST(Grooves, EqualWidthsAreTheMicrofacetLaw) {
  for (double const width : {0.05, 0.6}) {
    Grooves const law = grooves(width, width, 0.3, 0.9), control = grooves(width, 0.9 * width, 0.3, 0.9);
    Microfacet const round = microfacet(width, 0.3, 0.9);
    double worst = 0;
    for (double const in : {0.0, 30.0, 75.0})
      for (double const out : {5.0, 40.0, 80.0})
        for (double const turn : {0.0, 0.2, 0.6}) {
          Vec3 const wi = incoming(in, 0.07), wo = incoming(out, turn);
          EXPECT_NEAR(law.eval(wi, wo) / round.eval(wi, wo), 1, 1e-12);
          EXPECT_NEAR(law.pdf(wi, wo) / round.pdf(wi, wo), 1, 1e-12);
          EXPECT_NEAR(law.albedo(wi) / round.albedo(wi.z), 1, 1e-3);
          worst = std::fmax(worst, std::fabs(control.eval(wi, wo) / round.eval(wi, wo) - 1));
        }
    EXPECT_GT(worst, 0.05);
  }
}

TEST(Grooves, PeakAndGlints) {
  Vec3 const up{0, 0, 1};
  Grooves const law = grooves(0.4, 0.05, 0.8, 0.8);
  EXPECT_NEAR(law.eval(up, up) * 4 * pi * 0.4 * 0.05, 0.8, 1e-12);
  for (double const degrees : {10.0, 30.0, 50.0}) {  // straight back: h = wi
    auto const back = [&](double a, double other) {
      double const sine = std::sin(degrees * pi / 180), cosine = std::cos(degrees * pi / 180);
      double const spread = sine * sine / (a * a) + cosine * cosine;
      return 0.8 / (pi * a * other * spread * spread) / (4 * cosine * std::hypot(cosine, a * sine));
    };
    Vec3 const across = incoming(degrees, 0), along = incoming(degrees, 0.25);
    EXPECT_NEAR(law.eval(across, across) / back(0.4, 0.05), 1, 1e-9);
    EXPECT_NEAR(law.eval(along, along) / back(0.05, 0.4), 1, 1e-9);
    EXPECT_GT(law.eval(across, across), 20 * law.eval(along, along));  // the glint; control: grooves turned by 90 deg
  }
}

// The total for light along the grooves, between the rows of the table, and its mean over the azimuth.
TEST(Grooves, TotalDependsOnTheAzimuth) {
  Grooves const law = grooves(0.5, 0.02, 1, 1);
  double worst = 0, control = 0;
  for (double const degrees : {20.0, 60.0, 80.0, 87.0})
    for (double const turn : {0.0, 0.03, 0.11, 0.19, 0.235, 0.249, 0.25, 0.6}) {
      Vec3 const wi = incoming(degrees, turn);
      double sum = 0;
      constexpr int across = 400, around = 128;
      for (int j = 0; j < across; ++j) {
        double const x = (j + 0.5) / across, width = std::pow((j + 1.0) / across, 4) - std::pow(double(j) / across, 4);
        for (int i = 0; i < around; ++i) {
          BsdfSample const s = law.sample(wi, (i + 0.5) / around, 1 - x * x * x * x);
          if (s.pdf > 0) sum += width * law.eval(wi, s.wo) * s.wo.z / s.pdf / around;
        }
      }
      worst = std::fmax(worst, std::fabs(law.albedo(wi) / sum - 1));
      control = std::fmax(control, std::fabs(law.albedo(wi.z) / sum - 1));
    }
  EXPECT_LT(worst, 1e-3);
  EXPECT_GT(control, 0.05);  // the mean over the azimuth
  double mean = 0;
  for (int i = 0; i < 200; ++i) mean += law.albedo(incoming(80, (i + 0.5) / 200)) / 200;
  EXPECT_NEAR(law.albedo(incoming(80).z), mean, 1e-3);
}

TEST(Grooves, TotalIsBelowTheReflectance) {
  for (auto const& [across, along] : {std::pair{1.0, 1e-4}, {0.3, 0.3}, {1e-3, 1e-4}}) {
    Grooves const law = grooves(across, along, 0.5, 0.5);
    double most = 0;
    for (int i = 0; i <= 200; ++i)
      for (double const turn : {0.0, 0.1, 0.2, 0.25}) {
        double const cosine = i / 200.0, sine = std::sqrt(1 - cosine * cosine);
        SinCos const a = sincos_turn(turn);
        most = std::fmax(most, law.albedo({sine * a.cos, sine * a.sin, cosine}) / 0.5);
      }
    EXPECT_LE(most, 1 + 1e-12);
    EXPECT_GT(most, 0.97);
  }
}

}  // namespace
}  // namespace straytrace::testing
